"""Intervals against scipy and against their own definition."""

import numpy as np
import pytest
from scipy.stats import binomtest

from hav_env.evaluation.statistics import mean, paired_difference, proportions_agree, wilson


@pytest.mark.parametrize(("successes", "size"), [(0, 10), (7, 4500), (3904, 4500), (10, 10)])
def test_wilson_interval_is_scipys(successes, size):
    ours = wilson(successes, size)
    theirs = binomtest(successes, size).proportion_ci(0.95, "wilson")
    assert (ours.low, ours.high) == pytest.approx((theirs.low, theirs.high), abs=1e-12)


@pytest.mark.parametrize("size", [1, 7, 1000, 4096])
def test_an_interval_of_none_begins_at_0_and_of_all_ends_at_1(size):
    assert wilson(0, size).low == 0.0 < wilson(0, size).high < 1.0
    assert wilson(size, size, 2.5).high == 1.0 > wilson(size, size, 2.5).low > 0.0


def test_proportions_agree_is_reflexive_symmetric_and_tells_far_ones_apart():
    near, same, far = wilson(500, 1000), wilson(505, 1000), wilson(600, 1000)
    assert proportions_agree(near, near)
    assert proportions_agree(near, same)
    assert proportions_agree(same, near)
    assert not proportions_agree(near, far)


def test_intervals_of_the_mean_cover_the_truth_as_often_as_they_say():
    rng = np.random.default_rng(0)
    covered = [abs(mean(rng.normal(3.0, 2.0, 100))[0] - 3.0) for _ in range(400)]
    inside = [m.low <= 3.0 <= m.high for m in (mean(rng.normal(3.0, 2.0, 100)) for _ in range(400))]
    assert max(covered) < 1.0
    assert 0.91 <= np.mean(inside) <= 0.98


def test_means_leave_out_what_is_not_there():
    assert mean(np.array([1.0, np.nan, 3.0])).value == 2.0
    assert mean(np.array([np.nan])).size == 0


def test_an_episode_counts_once_in_a_paired_difference():
    episodes = np.array([0, 0, 1, 1, 2])
    ours = np.array([1.0, 3.0, 2.0, np.nan, 5.0])
    theirs = np.array([0.0, 0.0, 0.0, 0.0, np.nan])
    difference = paired_difference(episodes, ours, theirs)
    assert difference.size == 2  # the third episode has no common value
    assert difference.value == pytest.approx((2.0 + 2.0) / 2)
