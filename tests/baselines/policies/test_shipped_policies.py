"""The policies that are shipped do what their files say, and better than AVOID-JACK."""

import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.files import load_trained
from baselines.policies.shipped import TRAINED
from hav_env import find_scenario
from hav_env.evaluation.comparison import figures_of, measure
from hav_env.evaluation.rollout import rollout
from hav_env.policies.names import make_policy
from tests.support.budgets import COMPILED

BETTER = ("ppo_single", "ppo_pair")
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


@compiled_only
@pytest.mark.parametrize("name", TRAINED)
def test_episodes_and_figures_are_those_in_the_file_and_no_column_is_worse_than_avoid_jacks(name):
    """One test, for the episodes take a minute and tests may run in different processes."""
    policy, scenario, told = scored(name)
    table = rollout(policy, scenario, told["seed"], np.arange(told["episodes"]))
    rows = table.slice(0, len(told["first"])).to_pylist()
    for row, kept in zip(rows, told["first"], strict=True):
        assert {key: row[key] for key in kept} == pytest.approx(kept, rel=1e-9)
    figures = {figure.name: measure(table, figure).value for figure in figures_of(table)}
    assert {name: figures[name] for name in told["figures"]} == pytest.approx(told["figures"])
    if name in BETTER:
        theirs = rollout(AvoidJack(), scenario, told["seed"], np.arange(EPISODES))
        ours = table.slice(0, len(theirs))
        assert ours["episode"].equals(theirs["episode"])
        for column, sign in COLUMNS.items():
            better, worse = (np.mean(both[column].to_numpy()) for both in (ours, theirs))
            assert sign * better >= sign * worse, column


def test_a_name_is_a_policy():
    for name in TRAINED:
        assert make_policy(name) is not None
