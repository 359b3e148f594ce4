"""Interquartile means, bootstrap intervals and profiles: against SciPy and plain loops."""

import math

import numpy as np
import pytest
from scipy.stats import bootstrap as scipys_bootstrap
from scipy.stats import trim_mean

from hav_env.evaluation.bootstrap import (
    bootstrap,
    counted_mean,
    interquartile_mean,
    performance_profile,
)
from hav_env.evaluation.statistics import mean, ratio


def crossed(rng, seeds, worlds):
    """Draw values that depend on the seed, on the world, and on both."""
    parts = rng.normal(0.0, 0.5, (seeds, 1)), rng.gamma(2.0, 0.5, (1, worlds))
    return 1.0 + parts[0] + parts[1] + rng.normal(0.0, 0.3, (seeds, worlds))


@pytest.mark.parametrize("size", [1, 2, 3, 4, 5, 7, 8, 100, 1_001])
def test_the_interquartile_mean_is_scipys_trimmed_mean(size):
    rng = np.random.default_rng(size)
    values, counts = np.sort(rng.gamma(2.0, size=size)), rng.integers(0, 4, size)
    counts[rng.integers(size)] += 1
    once = interquartile_mean(values, np.ones(size, int))
    assert once == pytest.approx(trim_mean(values, 0.25), rel=1e-12)
    expected = trim_mean(values.repeat(counts), 0.25)
    assert interquartile_mean(values, counts) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("statistic", "scipys"),
    [(interquartile_mean, lambda x, axis: trim_mean(x, 0.25, axis)), (counted_mean, np.mean)],
)
@pytest.mark.parametrize("shape", [(1, 120), (120, 1)], ids=["worlds", "seeds"])
def test_of_seeds_or_worlds_alone_the_interval_is_scipys(shape, statistic, scipys):
    values = np.random.default_rng(0).gamma(2.0, size=shape)
    theirs = scipys_bootstrap(
        (values.ravel(),), scipys, n_resamples=4_000, method="percentile", rng=1
    ).confidence_interval
    ours = bootstrap([values], statistic, 4_000)
    assert ours.value == pytest.approx(scipys(values.ravel(), axis=0))
    width = theirs.high - theirs.low
    assert (ours.low, ours.high) == pytest.approx((theirs.low, theirs.high), abs=0.06 * width)
    assert ours.size == 120


def test_seeds_and_worlds_of_every_stratum_are_resampled():
    """Compare with loops that copy the rows and columns of what is drawn."""
    rng = np.random.default_rng(2)
    strata = [crossed(rng, 4, 30), 1.0 + crossed(rng, 6, 20)]
    found = []
    for _ in range(2_000):
        drawn = []
        for values in strata:
            seeds, worlds = (rng.integers(size, size=size) for size in values.shape)
            drawn.append(values[np.ix_(seeds, worlds)].ravel())
        found.append(trim_mean(np.concatenate(drawn), 0.25))
    low, high = np.quantile(found, [0.025, 0.975])
    ours = bootstrap(strata, interquartile_mean, 2_000)
    assert ours.value == pytest.approx(trim_mean(np.concatenate([s.ravel() for s in strata]), 0.25))
    assert (ours.low, ours.high) == pytest.approx((low, high), abs=0.06 * (high - low))


def test_intervals_cover_the_truth_as_often_as_they_say_and_those_of_worlds_alone_do_not():
    rng = np.random.default_rng(3)
    truth, both, alone = 2.0, [], []
    for _ in range(120):
        values = crossed(rng, 12, 40)
        for strata, covered in ([[values], both], [[values.mean(0)[None]], alone]):
            ours = bootstrap(strata, counted_mean, 200)
            covered.append(ours.low <= truth <= ours.high)
    assert 0.87 <= np.mean(both) <= 0.99  # seeds are few: 95 % in the limit of many
    assert np.mean(alone) < 0.8


def test_few_seeds_never_exceed_their_range():
    rng = np.random.default_rng(4)
    values = rng.normal(size=(3, 1))
    ours = bootstrap([values], counted_mean)
    assert values.min() <= ours.low < ours.value < ours.high <= values.max()


def test_what_there_is_not_is_left_out():
    values = np.array([[1.0, np.nan, 3.0], [np.nan, np.nan, 5.0]])
    ours = bootstrap([values], counted_mean)
    assert (ours.value, ours.size) == (3.0, 3)
    assert 1.0 <= ours.low <= ours.high <= 5.0
    assert bootstrap([np.full((2, 3), np.nan)], counted_mean).size == 0


def test_the_same_values_have_the_same_interval():
    values = crossed(np.random.default_rng(5), 3, 10)
    assert bootstrap([values], interquartile_mean) == bootstrap([values], interquartile_mean)


def test_a_profile_is_the_share_of_values_up_to_each_limit():
    rng = np.random.default_rng(6)
    values, limits = crossed(rng, 5, 40), np.linspace(0.0, 5.0, 11)
    ours = performance_profile([values], limits, 500)
    for limit, share, low, high in zip(*ours, strict=True):
        counted = (values <= limit).astype(float)
        assert share == pytest.approx(counted.mean())
        expected = bootstrap([counted], counted_mean, 500)
        assert (low, high) == pytest.approx((expected.low, expected.high), abs=0.02)
    assert (np.diff(ours.share) >= 0.0).all()
    assert ours.share[0] < 0.1
    assert ours.share[-1] > 0.9


def test_the_ratio_of_totals_has_the_interval_of_a_bootstrap_of_worlds():
    rng = np.random.default_rng(7)
    shortest = rng.gamma(4.0, 100.0, 400)
    driven = shortest * rng.gamma(9.0, 0.2, 400)
    ours = ratio(driven, shortest)
    theirs = scipys_bootstrap(
        (driven, shortest),
        lambda a, b, axis: a.sum(axis) / b.sum(axis),
        paired=True,
        n_resamples=4_000,
        method="percentile",
        rng=8,
    ).confidence_interval
    width = theirs.high - theirs.low
    assert (ours.low, ours.high) == pytest.approx((theirs.low, theirs.high), abs=0.08 * width)
    assert ours.value == driven.sum() / shortest.sum()


def test_the_ratio_to_ones_is_the_mean_and_that_of_one_world_has_no_interval():
    values = np.random.default_rng(8).normal(5.0, 1.0, 50)
    assert ratio(values, np.ones(50))[:4] == pytest.approx(mean(values)[:4], rel=1e-12)
    assert ratio(np.array([6.0]), np.array([4.0]))[:3] == (1.5, -math.inf, math.inf)
    assert ratio(np.zeros(0), np.zeros(0)).size == 0
