"""Coverage's tracer: it stays out of Numba's compiler, and goes on behind it."""

import sys

import numba
import pytest

from tests.support.budgets import COMPILED
from tests.support.tracing import untraced


def traced_files(function):
    """Return the last parts of the paths of all files whose functions a tracer is called for."""
    before, seen = sys.gettrace(), set()

    def tracer(frame, event, argument):
        seen.add(frame.f_code.co_filename.rpartition("/")[2])

    sys.settrace(tracer)
    try:
        function()
        assert sys.gettrace() is tracer
    finally:
        sys.settrace(before)
    return seen


def fill(numbers):
    for k in range(len(numbers)):
        numbers[k] = 3.0 * k


@pytest.mark.skipif(not COMPILED, reason="nothing is compiled")
def test_a_tracer_is_told_of_the_call_that_compiles_and_not_of_the_compiler():
    seen = traced_files(lambda: numba.njit(fill).compile("void(float64[:])"))
    assert "dispatcher.py" in seen
    assert not {"compiler_machinery.py", "typeinfer.py", "lowering.py"} & seen


def test_the_tracer_goes_on_behind_an_error():
    def fail():
        assert sys.gettrace() is None
        raise ValueError

    def call():
        with pytest.raises(ValueError):  # noqa: PT011  # of this test alone
            untraced(fail)()

    traced_files(call)
