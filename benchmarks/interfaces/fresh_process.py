"""This module measures a fresh process: seconds to its first experiment, imports, and memory.

As a script it is that process: ``python -m benchmarks.interfaces.fresh_process 500`` prints the
peak memory [MiB] of 500 of the paper's experiments. They run in slices, as in ``python -m baselines
reproduce``.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time

_SLICE = 500  # episodes of one rollout; their records are dropped before the next
_MODULE = "benchmarks.interfaces.fresh_process"
_IMPORT = """
import sys, time
start = time.perf_counter()
import hav_env
print(time.perf_counter() - start, *(name for name in sys.argv[1:] if name in sys.modules))
"""
# packages that hav_env must not load before it needs them
HEAVY = ("torch", "pygame", "matplotlib")


def start_seconds() -> tuple[float, float]:
    """Return the time [s] to a finished experiment on an empty cache, and of the process after it.

    Both count from the start of Python, imports included.
    """
    seconds = []
    with tempfile.TemporaryDirectory() as cache:
        for _ in range(2):
            start = time.perf_counter()
            _run(1, NUMBA_CACHE_DIR=cache)
            seconds.append(time.perf_counter() - start)
    return seconds[0], seconds[1]


def import_hav_env() -> tuple[float, list[str]]:
    """Return a fresh process's import time [s] of hav_env, and the loaded packages of ``HEAVY``."""
    command = [sys.executable, "-c", _IMPORT, *HEAVY]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    seconds, *loaded = done.stdout.split()
    return float(seconds), loaded


def import_seconds(repetitions: int = 5) -> tuple[float, list[str]]:
    """Return the median of several imports, and the packages of ``HEAVY`` that they loaded."""
    seconds, loaded = zip(*(import_hav_env() for _ in range(repetitions)), strict=True)
    return statistics.median(seconds), sorted(set().union(*loaded))


def peak_memory(num_experiments: int) -> float:
    """Return the peak memory [MiB] of a process that runs so many experiments."""
    return float(_run(num_experiments))


def _run(num_experiments: int, **environment: str) -> str:
    command = [sys.executable, "-m", _MODULE, str(num_experiments)]
    environment = os.environ | environment
    done = subprocess.run(command, check=True, env=environment, capture_output=True, text=True)
    return done.stdout


def _main(num_experiments: int) -> None:
    import resource  # noqa: PLC0415  (not on Windows, where it is never called)

    import numpy as np  # noqa: PLC0415  (here, so that the parent's import stays free of it)

    from baselines.policies.avoid_jack import AvoidJack  # noqa: PLC0415
    from hav_env import RandomPoses  # noqa: PLC0415
    from hav_env.evaluation.rollout import rollout  # noqa: PLC0415

    for first in range(0, num_experiments, _SLICE):
        episodes = np.arange(first, min(first + _SLICE, num_experiments))
        rollout(AvoidJack(), RandomPoses(), 0, episodes)
    per_mebibyte = 2**20 if sys.platform == "darwin" else 2**10
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / per_mebibyte)


if __name__ == "__main__":
    _main(int(sys.argv[1]))
