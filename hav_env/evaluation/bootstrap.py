"""This module computes interquartile means and performance profiles with bootstrap intervals.

The values of a policy are an array (S, W): one for each training seed and world. A stratum is such
an array; each stratum, such as a scenario, has its own seeds and worlds. The bootstrap resamples
both the seeds and the worlds of every stratum (Owen 2007). The worlds are the same for all seeds.
Agarwal et al. (2021) motivate the statistics; their package rliable resamples the seeds only, which
is the case W = 1 of every stratum here.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from hav_env.evaluation.statistics import Interval

RESAMPLES = 2_000
_TRIMMED = 0.25  # share cut at each end
_OUTSIDE = (2.5, 97.5)  # percentiles of an interval at 95 %
_RESAMPLING_SEED = 0  # seed of the resampling: equal values give equal intervals

Statistic = Callable[[np.ndarray, np.ndarray], float]
"""Maps values (K,) in ascending order, and the number of times that each counts (K,), to a number.
"""


class Profile(NamedTuple):
    """The share of values that are at most a limit, for each limit, with its 95 % interval."""

    limits: np.ndarray
    """(L,)"""
    share: np.ndarray
    """(L,)"""
    low: np.ndarray
    """(L,)"""
    high: np.ndarray
    """(L,)"""


def interquartile_mean(values: np.ndarray, counts: np.ndarray) -> float:
    """Return the mean of the values between the quartiles.

    A quarter of the values, rounded down, is left out at each end, as in ``scipy.stats.trim_mean``.
    One value that counts several times is several values.

    Args:
        values: (K,) values in ascending order.
        counts: (K,) the number of times that each value counts, at least 0 and not all 0.
    """
    below = np.cumsum(counts)
    cut = int(_TRIMMED * below[-1])
    # number of copies of each value between both cuts
    kept = np.diff(np.clip(below, cut, below[-1] - cut), prepend=cut)
    return float(kept @ values / kept.sum())


def counted_mean(values: np.ndarray, counts: np.ndarray) -> float:
    """Return the mean of values (K,), weighted by their counts (K,)."""
    return float(counts @ values / counts.sum())


def bootstrap(
    strata: Sequence[np.ndarray], statistic: Statistic, resamples: int = RESAMPLES
) -> Interval:
    """Return a statistic of all values with its 95 % percentile interval.

    Few seeds make the interval too narrow: with three seeds it is at most their range.

    Args:
        strata: Arrays (S, W) of values, nan for missing values.
        statistic: Function such as ``interquartile_mean``.
        resamples: Number of resamples.
    """
    values, counts = _sorted(strata)
    if values.size == 0:
        return Interval(np.nan, np.nan, np.nan, 0)
    found = [statistic(values, drawn) for drawn in _resamples(strata, resamples) if drawn.any()]
    low, high = np.percentile(found, _OUTSIDE)
    return Interval(statistic(values, counts), float(low), float(high), values.size)


def performance_profile(
    strata: Sequence[np.ndarray], limits: np.ndarray, resamples: int = RESAMPLES
) -> Profile:
    """Return the share of the values that are at most a limit (Dolan & More 2002), with a band.

    Args:
        strata: See ``bootstrap``.
        limits: (L,) limits in ascending order.
        resamples: Number of resamples.
    """
    values, counts = _sorted(strata)
    places = np.searchsorted(values, limits, "right")

    def shares(counts: np.ndarray) -> np.ndarray:
        return np.concatenate([[0], np.cumsum(counts)])[places] / counts.sum()

    found = [shares(drawn) for drawn in _resamples(strata, resamples) if drawn.any()]
    return Profile(limits, shares(counts), *np.percentile(found, _OUTSIDE, axis=0))


def _sorted(strata: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return all finite values in ascending order, with a count of one each."""
    values = np.concatenate([stratum.ravel() for stratum in strata])
    values = np.sort(values[np.isfinite(values)])
    return values, np.ones(values.size, np.int64)


def _resamples(strata: Sequence[np.ndarray], resamples: int) -> Iterator[np.ndarray]:
    """Yield the count of each value in a resample, in ascending order of the values."""
    values = np.concatenate([stratum.ravel() for stratum in strata])
    order = np.argsort(values, kind="stable")[: np.isfinite(values).sum()]  # sorting puts nan last
    rng = np.random.default_rng(_RESAMPLING_SEED)
    for _ in range(resamples):
        counts = [np.outer(*(_drawn(rng, size) for size in stratum.shape)) for stratum in strata]
        yield np.concatenate([part.ravel() for part in counts])[order]


def _drawn(rng: np.random.Generator, size: int) -> np.ndarray:
    """Draw ``size`` indices with replacement; return the number of draws of each, (size,)."""
    return np.bincount(rng.integers(size, size=size), minlength=size)
