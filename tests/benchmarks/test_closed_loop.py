"""The benchmark of the simulator runs today's workloads, and those of an earlier revision."""

import pytest

from benchmarks.closed_loop import WORKLOADS, Version
from benchmarks.throughput import earlier_version

SINGLE = "single HAV (paper)"


def test_a_process_that_fails_says_why(tmp_path):
    (tmp_path / "benchmarks").mkdir()
    (tmp_path / "benchmarks" / "closed_loop.py").write_text("raise ImportError('no such policy')")
    version = Version(str(tmp_path))
    with pytest.raises(RuntimeError, match="ImportError: no such policy"):
        version.rate(SINGLE, 1, 0.0)
    version.close()


@pytest.mark.exhaustive
def test_the_earlier_revision_runs_the_workloads_of_the_table():
    with earlier_version() as earlier:
        if earlier is None:
            pytest.skip("the clone has no history")
        assert SINGLE in WORKLOADS
        assert earlier.rate(SINGLE, 1, 0.0) > 0.0
