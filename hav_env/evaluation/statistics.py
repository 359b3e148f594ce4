"""This module computes confidence intervals of proportions and of paired differences.

Paired differences are those between policies on the same episodes.
"""

import math
from typing import NamedTuple

import numpy as np

_Z = 1.959963984540054  # 95 %, two-sided


class Interval(NamedTuple):
    """A value with its 95 % interval; ``size`` is the number of observations."""

    value: float
    low: float
    high: float
    size: int

    def show(self, percent: bool) -> str:
        """Write the interval as text, for instance ``86.7 % [85.7, 87.7]``."""
        if self.size == 0:
            return "-"
        if percent:
            return f"{100 * self.value:.2f} % [{100 * self.low:.2f}, {100 * self.high:.2f}]"
        return f"{self.value:.3g} [{self.low:.3g}, {self.high:.3g}]"


def wilson(successes: int, size: int) -> Interval:
    """Return a proportion with its Wilson score interval (Wilson 1927)."""
    if size == 0:
        return Interval(math.nan, math.nan, math.nan, 0)
    share, spread = successes / size, _Z * _Z / size
    centre = (share + spread / 2) / (1 + spread)
    half = _Z * math.sqrt(share * (1 - share) / size + spread / size / 4) / (1 + spread)
    return Interval(share, max(centre - half, 0.0), min(centre + half, 1.0), size)


def proportions_agree(one: Interval, other: Interval) -> bool:
    """Tell whether two independent proportions may be equal, at 95 %.

    The interval of their difference is Newcombe's (1998, method 10), from both Wilson intervals.
    """
    difference = one.value - other.value
    below = math.hypot(one.value - one.low, other.high - other.value)
    above = math.hypot(one.high - one.value, other.value - other.low)
    return difference - below <= 0 <= difference + above


def mean(values: np.ndarray) -> Interval:
    """Return a mean with its normal 95 % interval; what is not finite is left out."""
    values = values[np.isfinite(values)]
    if values.size == 0:
        return Interval(math.nan, math.nan, math.nan, 0)
    centre = float(values.mean())
    half = _Z * float(values.std(ddof=1)) / math.sqrt(values.size) if values.size > 1 else math.inf
    return Interval(centre, centre - half, centre + half, values.size)


def paired_difference(episodes: np.ndarray, ours: np.ndarray, theirs: np.ndarray) -> Interval:
    """Return the mean of ``ours - theirs`` with its 95 % interval.

    The HAVs of one episode depend on each other, so an episode counts as one observation: the mean
    over those of its HAVs for which both values exist.

    Args:
        episodes: (R,) the episode of each row.
        ours: (R,) values; nan where there is none.
        theirs: (R,) values of the same HAVs in the same episodes.
    """
    difference = ours.astype(float) - theirs.astype(float)
    known = np.isfinite(difference)
    _, group = np.unique(episodes[known], return_inverse=True)
    count = np.bincount(group)
    return mean(np.bincount(group, weights=difference[known]) / np.maximum(count, 1))
