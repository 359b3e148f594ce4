"""Harm weighs more and more, nothing else changes, and only later rewards depend on it."""

import numpy as np
import pytest

from hav_env import Reward
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.mdp.info import REPORT
from tests.support.budgets import budget
from tests.support.policies import Watched
from train.curriculum import Curriculum, check_curriculum, harm_share, reward_at

HARM = ("jackknife", "actual_collision", "potential_collision", "proximity", "articulation")
CURRICULA = [
    Curriculum(),
    Curriculum(share=0.0, begin=0.0, end=1.0),
    Curriculum(share=0.5, begin=0.3, end=0.3),  # at once
    Curriculum(share=0.0, begin=1.0, end=1.0),
    Curriculum(share=0.7, begin=0.0, end=0.0),
    Curriculum(share=1.0),
]
PROGRESS = np.linspace(0.0, 1.2, 241)  # a training ends with its last rollout, which may be longer


@pytest.mark.parametrize("curriculum", CURRICULA)
def test_the_share_of_harm_grows_from_the_first_to_all_of_it(curriculum):
    shares = np.array([harm_share(curriculum, progress) for progress in PROGRESS])
    assert (np.diff(shares) >= 0.0).all()
    early, late = curriculum.begin > PROGRESS, curriculum.end <= PROGRESS
    assert shares[early] == pytest.approx(curriculum.share)
    assert (shares[late] == 1.0).all()
    assert harm_share(curriculum, 1.0) == 1.0
    assert shares.min() >= curriculum.share


@pytest.mark.parametrize("curriculum", CURRICULA[:2])
def test_in_between_it_grows_along_a_straight_line(curriculum):
    share, begin, end = curriculum
    for part in (0.0, 0.25, 0.5, 1.0):
        found = harm_share(curriculum, begin + part * (end - begin))
        assert found == pytest.approx(share + part * (1.0 - share))


@pytest.mark.parametrize("progress", [0.0, 0.1, 0.2, 0.35, 0.5, 1.0])
def test_harm_weighs_its_share_and_all_else_what_it_did(progress):
    reward = Reward(*np.random.default_rng(0).normal(size=len(Reward._fields)))
    found, share = reward_at(Curriculum(), reward, progress), harm_share(Curriculum(), progress)
    for term, weight in reward._asdict().items():
        expected = share * weight if term in HARM else weight
        assert getattr(found, term) == pytest.approx(expected, abs=0.0), term
    assert {"goal", "progress", "steering", "time"} == set(Reward._fields) - set(HARM)
    assert reward_at(Curriculum(), reward, 1.0) == reward


@pytest.mark.parametrize(
    ("curriculum", "message"),
    [
        (Curriculum(share=-0.1), "curriculum share is -0.1, but must be from 0 to 1"),
        (Curriculum(share=1.1), "curriculum share is 1.1"),
        (Curriculum(share=np.nan), "curriculum share is nan"),
        (Curriculum(begin=-1.0), "curriculum begin is -1.0"),
        (Curriculum(end=np.inf), "curriculum end is inf"),
        (Curriculum(begin=0.6), "curriculum end is 0.5, but must be at least its begin, 0.6"),
    ],
)
def test_a_curriculum_that_cannot_be_is_named(curriculum, message):
    with pytest.raises(ValueError, match=message):
        check_curriculum(curriculum)


@pytest.mark.parametrize("curriculum", CURRICULA)
def test_a_curriculum_that_can_be_is_let_pass(curriculum):
    check_curriculum(curriculum)


# another reward in the middle of an episode

LATER = Reward(progress=3.0, goal=1.0, time=-2.0, steering=0.0)
STEPS = budget(20, 6)


def run(changed, num_worlds=3):
    """Return the results of a process after each action; its reward changes at ``changed``."""
    process = DecisionProcess(num_worlds, scenario="paper-pair", frame_skip=2)
    seeds, rng = np.arange(num_worlds), np.random.default_rng(0)
    everywhere = np.ones(num_worlds, bool)
    process.begin(seeds, np.zeros(num_worlds, int), everywhere, process.outcome())
    told = []
    for step in range(STEPS):
        if step == changed:
            process.set_reward(LATER)
        outcome = process.step(rng.uniform(-1, 1, (num_worlds, 2, 2)))
        told.append([values.copy() for values in outcome])
    return [np.array(values) for values in zip(*told, strict=True)]


def test_another_reward_changes_what_comes_and_nothing_that_was():
    seen, numbers, rewards, *ends = run(None)
    seen_then, numbers_then, rewards_then, *ends_then = run(STEPS // 2)
    assert np.array_equal(seen, seen_then)
    assert np.array_equal(ends, ends_then)
    before, after = slice(0, STEPS // 2), slice(STEPS // 2, None)
    assert np.array_equal(numbers[before], numbers_then[before])
    assert np.array_equal(rewards[before], rewards_then[before])
    report = slice(0, len(REPORT))
    assert np.array_equal(numbers[:, report], numbers_then[:, report])
    returns, returns_then = numbers[:, len(REPORT) :], numbers_then[:, len(REPORT) :]
    gained, gained_then = np.diff(returns, axis=0), np.diff(returns_then, axis=0)
    of_later = slice(STEPS // 2 - 1, None)
    for k, term in enumerate(Reward._fields):
        if getattr(Reward(), term) == 0.0:
            continue
        ratio = getattr(LATER, term) / getattr(Reward(), term)
        expected = ratio * gained[of_later, k]
        assert gained_then[of_later, k] == pytest.approx(expected, abs=1e-9), term
    assert rewards_then[1:] == pytest.approx(gained_then.sum(axis=1), abs=1e-9)
    assert not np.allclose(rewards[after], rewards_then[after])


def test_whole_weights_are_numbers_too():
    process = DecisionProcess(1, scenario="paper-single", reward=Reward(time=0.0))
    process.begin(np.zeros(1, int), np.zeros(1, int), np.ones(1, bool), process.outcome())
    process.set_reward(Reward(*[0] * 8, -1))
    assert process.step(np.zeros((1, 1, 2))).reward[0, 0] == pytest.approx(-0.2)


@pytest.mark.parametrize(
    ("reward", "error", "message"),
    [
        (Reward(goal=np.nan), ValueError, "reward goal is nan"),
        (Reward(time=-np.inf), ValueError, "reward time is -inf"),
        (Reward(goal="much"), (TypeError, ValueError), "reward goal is much"),
        (Watched(), TypeError, "reward is Watched.*, but must be a Reward"),
        ("much", TypeError, "'much' is not a reward"),
        (None, TypeError, "None is not a reward"),
    ],
)
def test_another_reward_that_cannot_be_is_refused_and_the_old_one_stays(reward, error, message):
    process = DecisionProcess(1, scenario="paper-single", reward=Reward(*[0] * 8, -1))
    process.begin(np.zeros(1, int), np.zeros(1, int), np.ones(1, bool), process.outcome())
    with pytest.raises(error, match=message):
        process.set_reward(reward)
    assert process.step(np.zeros((1, 1, 2))).reward[0, 0] == pytest.approx(-0.2)
