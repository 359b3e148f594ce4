"""This module computes confidence intervals of shares and means, clustered by episode.

The HAVs of one episode are not independent: two HAVs of a pair always share a collision. Intervals
therefore sample episodes as clusters of HAVs. Paired differences compare policies on the same
episodes.
"""

import math
from typing import NamedTuple

import numpy as np

_Z = 1.959963984540054  # 95 %, two-sided
_COLLIDING = 2.0  # number of HAVs that share a collision


class Interval(NamedTuple):
    """A value with its 95 % interval."""

    value: float
    low: float
    high: float
    size: int
    """Number of observations: HAVs, or episodes in paired differences and ratios."""
    design_effect: float = 1.0
    """Ratio of the value's variance to that of independent observations of the same number, at
    least 1.
    """

    @property
    def effective_size(self) -> float:
        """Return the number of independent observations with the same information."""
        return self.size / self.design_effect

    def show(self, percent: bool) -> str:
        """Return the interval as text, for instance ``86.7 % [85.7, 87.7]``.

        Args:
            percent: Whether the value is a share, to write in percent.
        """
        if self.size == 0:
            return "-"
        if percent:
            return f"{100 * self.value:.2f} % [{100 * self.low:.2f}, {100 * self.high:.2f}]"
        return f"{self.value:.3g} [{self.low:.3g}, {self.high:.3g}]"


def design_effect(values: np.ndarray, episodes: np.ndarray) -> float:
    """Return the ratio of the variance of the mean to that of independent HAVs.

    A mean over HAVs is a ratio of two totals over episodes: of the values and of the HAVs. Its
    variance is ``sum_k (sum_i (v_ki - mean))^2 / size^2`` (Kish 1965; for shares Rao & Scott 1992).
    The variance for independent HAVs is ``sum_ki (v_ki - mean)^2 / size^2``. The design effect is
    the ratio of the two. Both omit the factor n / (n - 1), as Wilson's interval does.

    - With one HAV in every episode it is exactly 1.
    - Values below 1 are clipped to 1. For independent HAVs the estimate scatters around 1, and an
      interval must not be narrower by chance. HAVs that exclude each other's success are rare;
      their interval is then somewhat too wide.
    - If all values are equal, the data do not determine the design effect. It is then 2, the number
      of HAVs that share a collision, or less if episodes have fewer HAVs. It does not cover causes
      that stop a whole swarm.
    - A single episode is one observation.

    Args:
        values: (R,) values of HAVs, all finite; 0 or 1 for shares.
        episodes: (R,) episode of each value.
    """
    _, group, sizes = np.unique(episodes, return_inverse=True, return_counts=True)
    if sizes.max(initial=1) == 1:
        return 1.0
    if sizes.size == 1:
        return float(values.size)
    if values.min() == values.max():
        return min(float(np.sum(sizes * sizes) / values.size), _COLLIDING)
    deviation = values - values.mean()
    totals = np.bincount(group, weights=deviation)
    effect = np.sum(totals * totals) / np.sum(deviation * deviation)
    # the upper bound holds by Cauchy-Schwarz, so it removes rounding errors only
    return float(np.clip(effect, 1.0, sizes.max()))


def wilson(successes: int, size: int, design_effect: float = 1.0) -> Interval:
    """Return a proportion with its Wilson score interval (Wilson 1927).

    Args:
        successes: Number of observations that are successes.
        size: Number of observations.
        design_effect: Design effect of the observations, at least 1. The interval is that of ``size
            / design_effect`` independent observations (Rao & Scott 1992). A published count without
            episodes has an unknown design effect; the one of the same figure measured here is its
            best estimate.

    Raises:
        ValueError: If the design effect is below 1 or not finite.
    """
    if not 1.0 <= design_effect < math.inf:
        raise ValueError(f"design_effect is {design_effect}, but must be at least 1 and finite")
    if size == 0:
        return Interval(math.nan, math.nan, math.nan, 0)
    effective = size / design_effect
    share, spread = successes / size, _Z * _Z / effective
    centre = (share + spread / 2) / (1 + spread)
    half = _Z * math.sqrt(share * (1 - share) / effective + spread / effective / 4) / (1 + spread)
    low = 0.0 if successes == 0 else centre - half  # exact, where rounding errors would remain
    high = 1.0 if successes == size else centre + half
    return Interval(share, low, high, size, design_effect)


def proportion(values: np.ndarray, episodes: np.ndarray) -> Interval:
    """Return the share of HAVs with its 95 % Wilson interval, clustered by episode.

    Args:
        values: (R,) 1 or True for HAVs that count, 0 or False for others.
        episodes: (R,) episode of each HAV.
    """
    effect = design_effect(values, episodes)
    return wilson(int(values.sum()), values.size, effect)


def proportions_agree(one: Interval, other: Interval) -> bool:
    """Return whether two independent proportions may be equal, at 95 %.

    The interval of their difference is Newcombe's (1998, method 10), from both Wilson intervals.

    Args:
        one: A proportion from ``wilson`` or ``proportion``.
        other: Another proportion, from other episodes.
    """
    difference = one.value - other.value
    below = math.hypot(one.value - one.low, other.high - other.value)
    above = math.hypot(one.high - one.value, other.value - other.low)
    return difference - below <= 0 <= difference + above


def standardized_difference(one: Interval, other: Interval) -> float:
    """Return ``one - other`` in standard errors, for two independent proportions.

    The standard error is that of equal shares: pooled, with effective sizes as weights. It is above
    0 when one share is 0. If the two are equal, the square is chi-square distributed with one
    degree of freedom, for large effective sizes. It is the score test, not Newcombe's interval, so
    the two may differ when the evidence is marginal.

    Args:
        one: A proportion from ``wilson`` or ``proportion``.
        other: Another one, of other episodes.

    Returns:
        The difference; 0 when both shares are 0 or both are 1, nan when one has no observations.
    """
    if one.size == 0 or other.size == 0:
        return math.nan
    if one.value == other.value:
        return 0.0
    sizes = one.effective_size, other.effective_size
    pooled = (sizes[0] * one.value + sizes[1] * other.value) / (sizes[0] + sizes[1])
    variance = pooled * (1 - pooled) * (1 / sizes[0] + 1 / sizes[1])
    return (one.value - other.value) / math.sqrt(variance)


def mean(values: np.ndarray, episodes: np.ndarray | None = None) -> Interval:
    """Return the mean of the finite values with its normal 95 % interval.

    Args:
        values: (R,) values; nan for missing values.
        episodes: (R,) episode of each value, which clusters the interval; None if the values are
            independent.
    """
    known = np.isfinite(values)
    values = values[known]
    if values.size == 0:
        return Interval(math.nan, math.nan, math.nan, 0)
    count, effect = values.size, 1.0
    if episodes is not None:
        count, effect = np.unique(episodes[known]).size, design_effect(values, episodes[known])
    centre, half = float(values.mean()), math.inf
    if count > 1:
        # the variance over all values, times count / (count - 1) for the number of episodes
        deviation = float(values.std(ddof=values.size / count))
        half = _Z * deviation / math.sqrt(values.size) * math.sqrt(effect)
    return Interval(centre, centre - half, centre + half, values.size, effect)


def ratio(parts: np.ndarray, wholes: np.ndarray) -> Interval:
    """Return the ratio of two totals over worlds with its normal 95 % interval.

    It is a ratio estimator (Cochran 1977, section 6.4) with worlds as the sampled units. With few
    worlds the interval is too narrow; with one world there is none.

    Args:
        parts: (W,) part of each world, for instance the time of its HAVs.
        wholes: (W,) whole of each world, above 0 in total, for instance the shortest time.
    """
    if parts.size == 0:
        return Interval(math.nan, math.nan, math.nan, 0)
    value, half = float(parts.sum() / wholes.sum()), math.inf
    if parts.size > 1:
        residual = parts - value * wholes
        scale = parts.size / (parts.size - 1)
        half = _Z * math.sqrt(scale * float(np.sum(residual * residual))) / float(wholes.sum())
    return Interval(value, value - half, value + half, parts.size)


def paired_difference(episodes: np.ndarray, ours: np.ndarray, theirs: np.ndarray) -> Interval:
    """Return the mean of ``ours - theirs`` with its 95 % interval.

    The HAVs of one episode depend on each other, so an episode counts as one observation. It is the
    mean over those of its HAVs that have both values.

    Args:
        episodes: (R,) episode of each row.
        ours: (R,) values; nan for missing values.
        theirs: (R,) values of the same HAVs in the same episodes.
    """
    difference = ours.astype(float) - theirs.astype(float)
    known = np.isfinite(difference)
    _, group = np.unique(episodes[known], return_inverse=True)
    count = np.bincount(group)
    return mean(np.bincount(group, weights=difference[known]) / np.maximum(count, 1))
