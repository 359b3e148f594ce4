"""The policies that are shipped do what their files say, and better than AVOID-JACK."""

import functools

import numpy as np
import pytest
from conftest import COMPILED

from baselines.avoid_jack import AvoidJack
from baselines.evaluate import figures_of, measure
from baselines.policy_files import load_trained
from baselines.registry import TRAINED, find_policy
from baselines.rollout import rollout
from hav_env import find_scenario

EPISODES = 1_500  # in which a policy is compared with AVOID-JACK
compiled_only = pytest.mark.skipif(not COMPILED, reason="whole episodes of large networks")
# the paper's figures, and whether more is better
COLUMNS = {
    "goal_1_hit": 1,
    "goal_2_hit": 1,
    "jackknifed": -1,
    "potential_collision": -1,
    "actual_collision": -1,
}


def scored(name):
    """Return a shipped policy, its scenario, and what its file says of its evaluation."""
    policy, about = load_trained(TRAINED[name])
    return policy, find_scenario(about["arguments"]["scenario"]), about["evaluation"]


@functools.cache
def rolled(name):
    """Return the table of the episodes that the file of a policy tells of."""
    policy, scenario, told = scored(name)
    return rollout(policy, scenario, told["seed"], np.arange(told["episodes"]))


@compiled_only
@pytest.mark.parametrize("name", TRAINED)
def test_the_first_episodes_are_those_in_the_file(name):
    *_, told = scored(name)
    rows = rolled(name).slice(0, len(told["first"])).to_pylist()
    for row, kept in zip(rows, told["first"], strict=True):
        assert {key: row[key] for key in kept} == pytest.approx(kept, rel=1e-9)


@compiled_only
@pytest.mark.parametrize("name", TRAINED)
def test_the_figures_are_those_in_the_file(name):
    table, told = rolled(name), scored(name)[-1]
    figures = {figure.name: measure(table, figure).value for figure in figures_of(table)}
    assert {name: figures[name] for name in told["figures"]} == pytest.approx(told["figures"])


@compiled_only
@pytest.mark.parametrize("name", ["ppo_single", "ppo_pair"])
def test_no_column_is_worse_than_avoid_jacks(name):
    _, scenario, told = scored(name)
    theirs = rollout(AvoidJack(), scenario, told["seed"], np.arange(EPISODES))
    ours = rolled(name).slice(0, len(theirs))
    assert ours["episode"].equals(theirs["episode"])
    for column, sign in COLUMNS.items():
        better, worse = (np.mean(table[column].to_numpy()) for table in (ours, theirs))
        assert sign * better >= sign * worse, column


def test_a_name_is_a_policy():
    for name in TRAINED:
        assert find_policy(name)() is not None
