"""Environments with Reserve behind the commands: the same as a policy in front of it, and safe."""

import numpy as np
import pytest

from baselines.policies.reserve import Reserve
from baselines.policies.reserve.memory import rows as m
from hav_env import Batch, Filtered, find_scenario, parallel_env
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.policies.driver import PolicyDriver
from hav_env.safety import make_safety
from hav_env.world.arrays import INTERVENTIONS
from tests.baselines.reserve.test_proposals import Told
from tests.support.audit import Audit
from tests.support.budgets import COMPILED, budget

SEED, WORLDS, HELD = 31, 2, 3


def begin(process, chosen):
    """Begin the first episodes of the seed in the chosen worlds."""
    seeds = np.full(WORLDS, SEED)
    process.begin(seeds, np.arange(WORLDS), np.array(chosen), process.outcome())


def commands(actions, worlds):
    """Return the commands of actions (W, N, 2): speed and steering, (N, W) each."""
    limit = worlds.fleet.limit
    share, turned = np.moveaxis(actions, -1, 0).swapaxes(1, 2)
    return 0.5 * (share + 1.0) * limit[:, 0], turned * limit[:, 1]


@pytest.mark.parametrize("safety", [None, pytest.param("both", marks=pytest.mark.exhaustive)])
def test_the_same_as_a_policy_that_proposes_the_actions(safety):
    scenario = find_scenario("dense-10")
    process = DecisionProcess(
        WORLDS, scenario=scenario, safety=safety, backup="reserve", frame_skip=HELD
    )
    begin(process, [True, True])
    batch = Batch(scenario, WORLDS)
    batch.reset(SEED)
    driver = PolicyDriver(Filtered(Told(), make_safety(safety), backup=Reserve()), batch)
    rng = np.random.default_rng(SEED)
    told = driver.memory[:, m.ROWS :, :WORLDS]
    for _ in range(budget(120, 4)):
        actions = rng.uniform(-1.0, 1.0, (WORLDS, 10, 2))
        actions[..., 0] = rng.choice([-1.0, 1.0, 1.0], (WORLDS, 10))
        outcome = process.step(actions)
        for _ in range(HELD):
            told[:, 0], told[:, 1] = commands(actions, batch.worlds)
            batch.step(*driver.decide())
        for name in ("x", "y", "heading"):
            theirs = getattr(batch.worlds.state, name)
            assert np.array_equal(getattr(process.batch.worlds.state, name), theirs), name
        counted = outcome.info[process.info.index("interventions")]
        assert np.array_equal(counted, batch.worlds.record.total[:, INTERVENTIONS])
    assert counted.sum() > 0.0 or not COMPILED


def test_an_episode_that_begins_anew_has_no_memory_of_the_last_one():
    process = DecisionProcess(WORLDS, scenario="paper-pair", backup="reserve")
    begin(process, [True, True])
    ahead = np.tile([1.0, 0.0], (WORLDS, 2, 1))
    seen = [process.step(ahead).observation[1].copy() for _ in range(budget(40, 5))]
    begin(process, [False, True])
    again = [process.step(ahead).observation[1].copy() for _ in seen]
    assert np.array_equal(seen, again)


def test_random_actions_do_no_harm():
    process = DecisionProcess(WORLDS, scenario="swarm-10", backup="reserve")
    begin(process, [True, True])
    rng, audit = np.random.default_rng(SEED), Audit(process.batch.worlds)
    for _ in range(budget(300, 3)):
        actions = rng.uniform(-1.0, 1.0, (WORLDS, 10, 2))
        for _ in range(5):
            process.step(actions)
            audit.look()
    audit.approve()


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"backup": "reserv"}, "reserve"),
        (
            {"backup": "avoid_jack"},
            r"backup is AvoidJack\(.*must be a policy that registers back_up",
        ),
        ({"backup": Reserve(dt=0.1)}, "backup dt is 0.1, but must be the task's, 0.2"),
        ({"backup": "reserve", "dt": 0.1}, "backup dt is 0.2, but must be the task's, 0.1"),
        ({"backup": "reserve", "scenario": "docks-6"}, "backup"),
    ],
)
def test_what_cannot_be_a_backup_is_refused_in_a_line(settings, said):
    with pytest.raises(ValueError, match=said):
        parallel_env(**settings)


def test_a_backup_that_judges_only_some_havs_is_refused():
    with pytest.raises(ValueError, match="learners control 1 of 2 HAVs"):
        DecisionProcess(1, 1, "avoid_jack", scenario="paper-pair", backup="reserve")
