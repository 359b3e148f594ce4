"""In turn, each HAV decides on the results of those before it, as if they step in sequence."""

import sys
from unittest import mock

import gymnasium
import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.dubins_pursuit import DubinsPursuit
from baselines.policies.reserve import Reserve
from hav_env import Batch, PolicyDriver, RandomPoses, Task, env, parallel_env
from hav_env.evaluation.rollout import rollout
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.policies.interface import allocate_memory, decide
from hav_env.world.arrays import HIT_DISTANCE, HIT_STEP, LARGEST, NEVER, PATH
from tests.support.budgets import COMPILED, budget
from tests.support.policies import Weaving

IN_TURN = Task(order="in_turn")
PAIR = RandomPoses(num_havs=2)
EARLY = {2: [14, 15, 85, 89], 3: [83, 117, 185]}  # HAVs: episodes in which they meet within 6 s
# The oracle's HAVs get goals in the middle of a step in turn. That matters only if others wait for
# them: so no HAV hits a goal, or each gets its next goal alone.
NO_GOALS = {"distance_tolerance": 1e-6, "heading_tolerance": 1e-6}
ALONE = {"distance_tolerance": 8.0, "heading_tolerance": 0.8, "next_goal": "alone"}
POLICIES = [AvoidJack(), AvoidJack(evasion_release=1.3, keep_first=False), Weaving()]


def named(policy):
    return type(policy).__name__


def text(table) -> str:
    return repr(table.to_pydict())


def end_of(policy, scenario, seed, episodes, task):
    """Return the worlds at the end of a rollout."""
    module = sys.modules[rollout.__module__]
    with mock.patch.object(module, "tabulate", lambda worlds, *rest: worlds):
        return rollout(policy, scenario, seed, episodes, task, threads=1)


def one_by_one(policy, scenario, seed, episodes, task):
    """Run episodes of HAVs that decide at once, but step as often as there are HAVs.

    In each of these steps one HAV moves, and only that HAV remembers what it decided.

    Returns:
        The worlds, and how many decisions to evade there were.
    """
    batch = Batch(scenario, len(episodes), task._replace(order="at_once", max_steps=10**8))
    batch.reset(seed, episodes)
    memory, evasions = allocate_memory(policy, scenario.num_havs, len(episodes)), 0
    for _ in range(task.max_steps):
        for agent in range(scenario.num_havs):
            others = np.arange(scenario.num_havs) != agent
            kept = memory[others].copy()
            speed, steering = decide(policy, memory, batch)
            memory[others] = kept
            speed[others] = 0.0
            evasions += np.count_nonzero(memory[agent, 0] > 0.0)
            batch.step(speed, steering)
    return batch.worlds, evasions


def moved(worlds) -> dict[str, np.ndarray]:
    """Return the positions and records of all HAVs."""
    record = worlds.record
    return {
        "x": worlds.state.x,
        "y": worlds.state.y,
        "heading": worlds.state.heading,
        "path": record.total[:, PATH],
        "largest articulation": record.total[:, LARGEST],
        "goals": record.goal[:, :, HIT_DISTANCE:],
    }


@pytest.mark.parametrize("rules", [NO_GOALS, ALONE], ids=["no goals", "alone"])
@pytest.mark.parametrize("policy", POLICIES, ids=named)
@pytest.mark.parametrize("num_havs", [2, 3])
def test_in_turn_is_to_let_one_hav_move_at_a_time(policy, num_havs, rules):
    scenario = RandomPoses(num_havs=num_havs)
    episodes = np.r_[EARLY[num_havs], np.arange(budget(40, 0))]
    for max_steps in budget((1, 2, 90, 400), (1, 40)):
        task = IN_TURN._replace(max_steps=max_steps, **rules)
        expected, evasions = one_by_one(policy, scenario, 11, episodes, task)
        end = end_of(policy, scenario, 11, episodes, task)
        found = moved(end)
        substeps = expected.record.goal[:, :, HIT_STEP]  # one for each HAV of a step
        steps = np.where(substeps == NEVER, NEVER, np.ceil(substeps / num_havs))
        np.testing.assert_array_equal(end.record.goal[:, :, HIT_STEP], steps)
        for name, values in moved(expected).items():
            np.testing.assert_array_equal(found[name], values, name)
    at_once = end_of(policy, scenario, 11, episodes, task._replace(order="at_once"))
    differs = (at_once.state.x != expected.state.x).any(axis=0)
    if isinstance(policy, AvoidJack):
        assert evasions > 100
        assert differs.sum() >= budget(7, 3)
    else:
        assert not differs.any()  # it observes no other HAV
    if rules is NO_GOALS:
        assert (steps == NEVER).all()
    elif COMPILED or (isinstance(policy, AvoidJack) and num_havs == 2):
        assert (steps != NEVER).any()


@pytest.mark.parametrize("policy", [AvoidJack(), DubinsPursuit(), Weaving()], ids=named)
def test_a_single_hav_does_the_same_in_both_orders(policy):
    for rules in ({}, {"on_goal": "remove"}, {"next_goal": "alone", "record_every": 3}):
        task = IN_TURN._replace(max_steps=budget(3_000, 60), **rules)
        in_turn, at_once = (
            rollout(policy, RandomPoses(), 3, np.arange(budget(20, 3)), task._replace(order=order))
            for order in ("in_turn", "at_once")
        )
        assert text(in_turn) == text(at_once)


@pytest.mark.parametrize("rules", [{}, {"next_goal": "alone"}, {"on_goal": "remove"}])
def test_who_never_meets_anybody_does_the_same_in_both_orders(rules):
    """AVOID-JACK evades others in potential collision only; goals are hit, and others wait."""
    apart = RandomPoses(num_havs=2, area_factor=60.0)
    task = Task(max_steps=budget(8_000, 60), **rules)
    episodes = np.arange(budget(60, 5))
    tables = [
        rollout("avoid_jack", apart, 3, episodes, task._replace(order=order)).to_pylist()
        for order in ("in_turn", "at_once")
    ]
    met = [[row["potential_collision"] for row in table] for table in tables]
    alone = ~np.any(met, axis=0)
    assert alone.sum() > len(alone) / 4
    for row, other in zip(*(np.array(table)[alone] for table in tables), strict=True):
        assert repr(row) == repr(other)
    hits = sum(row["goal_1_hit"] for row in np.array(tables[0])[alone])
    assert hits > 0 or not COMPILED


@pytest.mark.parametrize("num_havs", [2, 5, 20])
def test_in_turn_an_episode_is_the_same_whatever_runs_beside_it(num_havs):
    scenario, policy = RandomPoses(num_havs=num_havs), AvoidJack()
    task = IN_TURN._replace(max_steps=budget(300, 6), next_goal="alone", distance_tolerance=4.0)
    episodes = np.arange(budget(50, 12 if num_havs == 2 else 3))
    alone = rollout(policy, scenario, 11, episodes, task, threads=1)
    assert text(rollout(policy, scenario, 11, episodes, task, threads=2)) == text(alone)
    for group in ([2, 0], [1], episodes[::-1]):
        table = rollout(policy, scenario, 11, np.array(group), task)
        for position, episode in enumerate(group):
            rows = table.slice(position * num_havs, num_havs)
            assert text(rows) == text(alone.slice(episode * num_havs, num_havs))


def in_turn_batch():
    batch = Batch(PAIR, 1, IN_TURN)
    batch.reset(0)
    return batch


def decide_in_turn():
    decide(AvoidJack(), allocate_memory(AvoidJack(), 2, 1), in_turn_batch())


def vector_environment(name):
    return gymnasium.make_vec(name, 2, vectorization_mode="vector_entry_point", order="in_turn")


@pytest.mark.parametrize(
    "call",
    [
        lambda: rollout(Reserve(), PAIR, 0, np.arange(1), IN_TURN),
        lambda: rollout("reserve", PAIR, 0, np.arange(1), IN_TURN),
        lambda: PolicyDriver(AvoidJack(), in_turn_batch()),
        lambda: PolicyDriver("avoid_jack", in_turn_batch(), first=1),
        decide_in_turn,
        lambda: in_turn_batch().step(np.zeros((2, 1)), np.zeros((2, 1))),
        lambda: DecisionProcess(task=IN_TURN),
        lambda: DecisionProcess(order="in_turn"),
        lambda: parallel_env(order="in_turn"),
        lambda: parallel_env(task=IN_TURN),
        lambda: env(order="in_turn"),
        lambda: gymnasium.make("HAVSwarm-v0", order="in_turn"),
        lambda: gymnasium.make("HAVSingle-v0", task=IN_TURN),
        lambda: vector_environment("HAVSwarm-v0"),
        lambda: vector_environment("HAVSingle-v0"),
    ],
)
def test_whoever_takes_all_actions_together_refuses_havs_that_decide_in_turn(call):
    with pytest.raises(ValueError, match="order is 'in_turn', but must be 'at_once'") as error:
        call()
    assert "\n" not in str(error.value)


def test_an_order_that_is_none_is_named():
    with pytest.raises(ValueError, match="order is 'backwards'"):
        Batch(PAIR, 1, Task(order="backwards"))
