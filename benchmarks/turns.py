"""This module measures in turns.

Machines are shared, so it measures the entries of a table close in time.
"""

import statistics
from collections.abc import Callable, Mapping
from typing import TypeVar

Key = TypeVar("Key")


def medians_in_turns(runs: Mapping[Key, Callable[[], float]], repetitions: int) -> dict[Key, float]:
    """Do all runs in turn, several times, and return the median of each run's results."""
    samples: dict[Key, list[float]] = {key: [] for key in runs}
    for _ in range(repetitions):
        for key, run in runs.items():
            samples[key].append(run())
    return {key: statistics.median(sample) for key, sample in samples.items()}
