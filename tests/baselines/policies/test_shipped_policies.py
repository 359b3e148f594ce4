"""The shipped policies match the figures in their files, and score better than AVOID-JACK."""

import numpy as np
import pytest

from baselines.policies import shipped
from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.files import load_policy, load_trained
from baselines.policies.reserve import Reserve
from baselines.policies.shipped import TRAINED
from hav_env import find_scenario
from hav_env.evaluation.comparison import figures_of, measure
from hav_env.evaluation.rollout import rollout
from hav_env.policies.checks import check_policy
from hav_env.policies.demands import guidance_of
from hav_env.policies.names import make_policy
from tests.support.budgets import COMPILED

BETTER = ("ppo_single", "ppo_guided", "ppo_pair")
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
    """Return a shipped policy with its filter, its scenario, and what its evaluation was."""
    about = load_trained(TRAINED[name]).about
    return (
        load_policy(TRAINED[name]),
        find_scenario(about["arguments"]["scenario"]),
        about["evaluation"],
    )


@compiled_only
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[] if name == "ppo_single" else [pytest.mark.exhaustive])
        for name in TRAINED
    ],
)
def test_episodes_and_figures_are_those_in_the_file_and_no_column_is_worse_than_avoid_jacks(name):
    """One test, because the episodes take a minute and tests may run in different processes."""
    policy, scenario, told = scored(name)
    table = rollout(policy, scenario, told["seed"], np.arange(told["episodes"]))
    rows = table.slice(0, len(told["first"])).to_pylist()
    for row, kept in zip(rows, told["first"], strict=True):
        assert {key: row[key] for key in kept} == pytest.approx(kept, rel=1e-9)
    figures = {figure.name: measure(table, figure).value for figure in figures_of(table)}
    assert {name: figures[name] for name in told["figures"]} == pytest.approx(told["figures"])
    if name in BETTER:
        episodes = np.arange(min(EPISODES, told["episodes"]))
        theirs = rollout(AvoidJack(), scenario, told["seed"], episodes)
        ours = table.slice(0, len(theirs))
        assert ours["episode"].equals(theirs["episode"])
        for column, sign in COLUMNS.items():
            better, worse = (np.mean(both[column].to_numpy()) for both in (ours, theirs))
            assert sign * better >= sign * worse, column


def test_a_name_is_a_policy():
    for name in TRAINED:
        assert make_policy(name) is not None


def test_ppo_reserve_is_ppo_guided_with_a_backup():
    guided, backed = shipped.ppo_guided, shipped.ppo_reserve
    assert type(backed.backup) is Reserve
    assert backed.safety == guided.safety
    assert np.array_equal(backed.policy.weights, guided.policy.weights)
    assert guidance_of(backed) == "feasible"
    check_policy(backed, find_scenario("swarm-10"))
