"""The same step, written also in plain Python and in NumPy, ends at the simulator's state."""

from benchmarks.yardsticks.driving import check


def test_plain_python_and_numpy_end_within_a_nanometre():
    check()
