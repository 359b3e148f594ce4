"""The same step written twice more, in plain Python and in NumPy, ends where the simulator does."""

from benchmarks.yardsticks.driving import check


def test_plain_python_and_numpy_end_within_a_nanometre():
    check()
