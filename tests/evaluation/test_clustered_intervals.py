"""Intervals clustered by episode: against Wilson, plain loops, a bootstrap and simulated pairs."""

import math

import numpy as np
import pyarrow as pa
import pytest
from scipy.stats import chi2_contingency

from hav_env.evaluation.figures import Figure, measure
from hav_env.evaluation.statistics import (
    design_effect,
    mean,
    proportion,
    proportions_agree,
    standardized_difference,
    wilson,
)

Z = 1.959963984540054


def pairs(rng, episodes, share, correlation):
    """Draw the HAVs of pairs: the second is the first's copy as often as the correlation says."""
    first, second = rng.random((2, episodes)) < share
    alike = rng.random(episodes) < correlation
    drawn = np.stack([first, np.where(alike, first, second)], 1)
    return drawn.ravel().astype(float), np.repeat(np.arange(episodes), 2)


def uneven(rng, episodes=60):
    """Draw values of episodes with one to seven HAVs, which share a part of their fate."""
    sizes = rng.integers(1, 8, episodes)
    numbers = np.repeat(np.arange(episodes), sizes)
    fate = rng.random(episodes)[numbers]
    order = rng.permutation(numbers.size)  # the rows of an episode need not be neighbours
    return (rng.random(numbers.size) < fate).astype(float)[order], numbers[order]


@pytest.mark.parametrize(("successes", "size"), [(0, 7), (1, 1), (7, 4500), (3904, 4500), (9, 9)])
def test_one_hav_an_episode_gives_wilsons_interval_to_the_bit(successes, size):
    values = np.random.default_rng(0).permutation(np.arange(size) < successes).astype(float)
    share = successes / size
    centre = (share + Z * Z / size / 2) / (1 + Z * Z / size)
    half = Z * math.sqrt(share * (1 - share) / size + Z * Z / size / size / 4) / (1 + Z * Z / size)
    ours = proportion(values, np.arange(size) + 5)
    assert ours.low == (0.0 if successes == 0 else centre - half)
    assert ours.high == (1.0 if successes == size else centre + half)
    assert ours == wilson(successes, size)
    assert ours.design_effect == 1.0


def test_one_hav_an_episode_gives_the_mean_of_independent_values_to_the_bit():
    values = np.random.default_rng(1).gamma(2.0, size=301)
    half = Z * float(values.std(ddof=1)) / math.sqrt(301)
    ours = mean(values, np.arange(301))
    assert (ours.low, ours.high) == (values.mean() - half, values.mean() + half)
    assert ours == mean(values)


@pytest.mark.parametrize("copies", [2, 5])
def test_copies_of_havs_tell_nothing(copies):
    rng = np.random.default_rng(2)
    values, episodes = (rng.random(200) < 0.1).astype(float), np.arange(200)
    one, many = (
        wilson(int(values.sum()), 200),
        proportion(values.repeat(copies), episodes.repeat(copies)),
    )
    assert many.design_effect == pytest.approx(copies, abs=1e-12)
    assert many[:3] == pytest.approx(one[:3], abs=1e-12)
    assert many.size == 200 * copies
    assert many.effective_size == pytest.approx(200)
    steps = rng.normal(100.0, 20.0, 200)
    one, many = mean(steps), mean(steps.repeat(copies), episodes.repeat(copies))
    assert many[:3] == pytest.approx(one[:3], rel=1e-12)


def test_unequal_episodes_follow_the_ratio_estimator_written_out():
    values, episodes = uneven(np.random.default_rng(3))
    ratio = sum(values) / len(values)
    between = within = 0.0
    for episode in set(episodes.tolist()):
        havs = [v for v, e in zip(values, episodes, strict=True) if e == episode]
        between += (sum(havs) - ratio * len(havs)) ** 2
        within += sum((v - ratio) ** 2 for v in havs)
    effect = design_effect(values, episodes)
    assert effect == pytest.approx(between / within)
    assert effect > 1.2
    n = len(values) * within / between
    ours = proportion(values, episodes)
    for limit in (ours.low, ours.high):  # Wilson's limits are where the score test is at its bound
        assert abs(ratio - limit) == pytest.approx(Z * math.sqrt(limit * (1 - limit) / n))
    count = len(set(episodes.tolist()))
    error = math.sqrt(count / (count - 1) * between) / len(values)
    clustered = mean(values, episodes)
    assert clustered.high - clustered.value == pytest.approx(Z * error)


@pytest.mark.parametrize("correlation", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("share", [0.003, 0.06, 0.6, 0.95])
def test_intervals_of_pairs_cover_the_truth_as_often_as_they_say(share, correlation):
    rng = np.random.default_rng(4)
    runs = [proportion(*pairs(rng, 2000, share, correlation)) for _ in range(300)]
    inside = np.mean([run.low <= share <= run.high for run in runs])
    assert 0.915 <= inside <= 0.985  # 95 %, with 2.7 standard errors of 300 runs
    effects = [run.design_effect for run in runs]
    assert np.mean(effects) == pytest.approx(1.0 + correlation, abs=0.1)


def test_intervals_without_episodes_would_cover_the_truth_too_seldom():
    rng = np.random.default_rng(5)
    drawn = [pairs(rng, 500, 0.6, 1.0)[0] for _ in range(300)]
    runs = [wilson(int(values.sum()), values.size) for values in drawn]
    assert np.mean([run.low <= 0.6 <= run.high for run in runs]) < 0.9


def test_a_bootstrap_of_whole_episodes_has_the_same_half_width():
    rng = np.random.default_rng(6)
    values, episodes = uneven(rng, 800)
    totals = np.bincount(episodes, weights=values)
    sizes = np.bincount(episodes)
    chosen = rng.integers(0, 800, (4000, 800))
    ratios = totals[chosen].sum(1) / sizes[chosen].sum(1)
    low, high = np.quantile(ratios, [0.025, 0.975])
    for ours in (proportion(values, episodes), mean(values, episodes)):
        assert ours.high - ours.low == pytest.approx(high - low, rel=0.05)


def test_havs_that_exclude_each_other_do_not_narrow_the_interval():
    values, episodes = np.tile([0.0, 1.0], 50), np.repeat(np.arange(50), 2)
    assert design_effect(values, episodes) == 1.0
    assert proportion(values, episodes) == wilson(50, 100)


@pytest.mark.parametrize("value", [0.0, 1.0])
def test_shares_of_none_and_of_all_count_two_havs_as_one(value):
    even = proportion(np.full(60, value), np.repeat(np.arange(30), 2))
    assert even[:3] == pytest.approx(wilson(30 * int(value), 30)[:3])
    assert even.size == 60
    sizes = np.array([1, 1, 2])
    odd = proportion(np.full(4, value), np.repeat(np.arange(3), sizes))
    assert odd.design_effect == pytest.approx((1 + 1 + 4) / 4)
    swarms = proportion(np.full(400, value), np.repeat(np.arange(2), 200))
    assert swarms[:3] == pytest.approx(wilson(200 * int(value), 200)[:3])


def test_one_episode_is_one_observation_and_none_is_none():
    one = proportion(np.array([1.0, 0.0]), np.array([7, 7]))
    assert (one.value, one.size, one.effective_size) == (0.5, 2, 1.0)
    assert mean(np.array([3.0, 5.0]), np.array([7, 7]))[:3] == (4.0, -math.inf, math.inf)
    nothing = np.zeros(0)
    for empty in (proportion(nothing, nothing), mean(nothing, nothing), wilson(0, 0)):
        assert empty.size == 0
        assert math.isnan(empty.value)
        assert empty.show(percent=True) == "-"


def test_means_leave_out_havs_without_a_value_and_keep_the_episodes_of_the_others():
    values = np.array([1.0, np.nan, 3.0, 4.0, np.nan, np.nan])
    ours = mean(values, np.array([0, 0, 1, 1, 2, 2]))
    assert ours == mean(np.array([1.0, 3.0, 4.0]), np.array([0, 1, 1]))
    assert ours.size == 3


def test_what_is_measured_of_a_table_is_clustered_by_its_episodes():
    values, episodes = pairs(np.random.default_rng(7), 100, 0.3, 1.0)
    table = pa.table({"episode": episodes, "met": values > 0, "step": values * 3.0})
    share = measure(table, Figure("met", "met", True, False))
    assert share[:3] == pytest.approx(wilson(int(values.sum()) // 2, 100)[:3])
    step = measure(table, Figure("step", "step", False, False))
    assert step[:3] == pytest.approx(mean(values[::2] * 3.0)[:3])


def test_the_difference_of_two_shares_is_normal_if_they_are_equal():
    rng = np.random.default_rng(8)
    drawn = [[proportion(*pairs(rng, 400, 0.2, c)) for c in (1.0, 0.5)] for _ in range(400)]
    scores = np.array([standardized_difference(*both) for both in drawn])
    assert np.mean(scores) == pytest.approx(0.0, abs=0.15)
    assert np.std(scores) == pytest.approx(1.0, abs=0.1)
    agree = [proportions_agree(*both) for both in drawn]
    assert np.mean(agree == (np.abs(scores) < Z)) > 0.98


def test_the_difference_of_two_shares_is_the_pooled_score():
    """The square is the chi-square of the table of counts, as SciPy has it."""
    one, other = wilson(95, 9000), wilson(0, 4500)
    score = standardized_difference(one, other)
    table = [[95, 9000 - 95], [0, 4500]]
    assert score**2 == pytest.approx(chi2_contingency(table, correction=False).statistic)
    assert standardized_difference(other, one) == -score
    doubled = [wilson(95, 9000, 2.0), wilson(0, 4500, 2.0)]
    assert standardized_difference(*doubled) == pytest.approx(score / math.sqrt(2.0))
    for share in (0, 50):
        assert standardized_difference(wilson(share, 50), wilson(2 * share, 100)) == 0.0
    assert math.isnan(standardized_difference(one, wilson(0, 0)))


@pytest.mark.parametrize("effect", [0.9, math.nan, math.inf])
def test_a_design_effect_below_one_is_refused(effect):
    with pytest.raises(ValueError, match=r"^design_effect is .*, but must be at least 1"):
        wilson(3, 10, effect)
