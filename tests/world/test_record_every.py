"""With record_every, events are those of every k-th state; no HAV moves otherwise."""

import functools

import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.dubins_pursuit import DubinsPursuit
from baselines.replay.trajectory import record_trajectory
from hav_env import Batch, RandomFleet, RandomPoses, Task
from hav_env.evaluation.rollout import rollout
from hav_env.world.task import set_rules
from tests.support.brute_force import (
    NEVER,
    chains_touch,
    circles_touch,
    close_misses,
    first_jackknifes,
    first_partners,
)
from tests.support.budgets import COMPILED, budget

# HAVs that bend little and are quick, so that much happens in few steps
FLEET = RandomFleet(max_trailers=3, articulation_max=0.6, speed_max=3.0)
DENSE = RandomPoses(num_havs=4, fleet=FLEET, area_factor=2.5)
TASK = Task(max_steps=budget(500, 80), distance_tolerance=6.0, heading_tolerance=0.4)
POLICIES = [DubinsPursuit(), AvoidJack(beta=0.3)]
EVERY = [2, 5, 7, 40]
EPISODES = np.arange(budget(12, 3))
EVENTS = ("jackknife", "potential_collision", "actual_collision")
NOT_OF_MOTION = (*EVENTS, "joint_", "_miss_")


def named(policy):
    return type(policy).__name__


def run(policy, scenario=DENSE, every=1, episodes=EPISODES, **rules):
    return rollout(policy, scenario, 7, episodes, TASK._replace(record_every=every, **rules))


def trajectories(policy, scenario=DENSE, episodes=EPISODES, **rules):
    task = TASK._replace(**rules)
    return [record_trajectory(policy, scenario, 7, int(k), task) for k in episodes]


@functools.cache
def table_of(policy, every):
    """Return the table of all episodes; several tests read it."""
    return run(policy, every=every)


@functools.cache
def drives_of(policy):
    """Return all episodes, recorded; several tests read them."""
    return trajectories(policy)


def first_of(row, event, place):
    """Return step and place of an event as the table has them."""
    step, where = row[f"{event}_step"], row[f"{event}_{place}"]
    assert row[event if event != "jackknife" else "jackknifed"] == (step is not None)
    return (NEVER, NEVER) if step is None else (step, where)


@pytest.mark.parametrize("policy", POLICIES, ids=named)
def test_first_jackknifes_and_collisions_are_those_of_every_kth_state(policy):
    drives, later = drives_of(policy), dict.fromkeys(EVENTS, 0)
    for every in (1, *EVERY):
        rows = iter(table_of(policy, every).to_pylist())
        for drive in drives:
            jackknifes = first_jackknifes(drive, every)
            potential = first_partners(circles_touch(drive), every)
            actual = first_partners(chains_touch(drive), every)
            for hav, own in enumerate(zip(jackknifes, potential, actual, strict=True)):
                row, (bent, *touches) = next(rows), own
                assert (row["episode"], row["hav"]) == (drive.episode, hav)
                assert first_of(row, "jackknife", "joint") == bent
                later["jackknife"] += bent[0] not in (NEVER, first_jackknifes(drive)[hav][0])
                for event, (step, partners) in zip(EVENTS[1:], touches, strict=True):
                    when, partner = first_of(row, event, "partner")
                    assert when == step
                    assert partner in (partners or {NEVER})
                    later[event] += step > 0
    if COMPILED:
        assert later["jackknife"] > 0
        assert later["potential_collision"] > 0
        assert (later["actual_collision"] > 0) == (policy == DubinsPursuit())  # it does not evade


@pytest.mark.parametrize("policy", POLICIES, ids=named)
def test_close_misses_are_counted_in_every_kth_state(policy):
    rules = {"distance_tolerance": budget(6.0, 30.0)}  # m, so that there are some
    drives, seen = trajectories(policy, **rules), 0
    for every in (1, *EVERY):
        rows = iter(run(policy, every=every, **rules).to_pylist())
        for drive in drives:
            for hav in range(DENSE.num_havs):
                row = next(rows)
                for goal in range(DENSE.num_goals):
                    misses = close_misses(drive, TASK._replace(**rules), hav, goal, every)
                    for kind, measure in (("heading", 1), ("euclidean", 0)):
                        name, looks = f"goal_{goal + 1}_{kind}_miss", misses[kind]
                        assert row[f"{name}_steps"] == len(looks)
                        narrowest = row[f"{name}_distance"], row[f"{name}_heading_difference"]
                        if looks:
                            seen += 1
                            least = min(looks, key=lambda look: look[measure])
                            assert narrowest == pytest.approx(least)
                        else:
                            assert narrowest == (None, None)
    assert seen > budget(100, 5)


@pytest.mark.parametrize("policy", POLICIES, ids=named)
@pytest.mark.parametrize("every", EVERY)
def test_goals_and_motion_stay_the_same(policy, every):
    tables = [table_of(policy, k) for k in (1, every)]
    names = [n for n in tables[0].column_names if not any(part in n for part in NOT_OF_MOTION)]
    assert {"goal_1_step", "goal_2_hit", "path_length", "largest_articulation"} <= set(names)
    assert tables[0].select(names).to_pydict() == tables[1].select(names).to_pydict()
    assert any(tables[0]["goal_1_hit"].to_pylist()) or not COMPILED


def test_large_swarms_keep_to_it_too():
    """The simulator compares neighbours there, not all pairs."""
    num_havs, policy = 20, DubinsPursuit()
    scenario = DENSE._replace(num_havs=num_havs)
    episodes = EPISODES[: budget(4, 1)]
    drives = trajectories(policy, scenario, episodes)
    for every in (1, 5):
        rows = iter(run(policy, scenario, every, episodes).to_pylist())
        for drive in drives:
            found = [next(rows) for _ in range(num_havs)]
            touching = {EVENTS[1]: circles_touch(drive), EVENTS[2]: chains_touch(drive)}
            for event, matrix in touching.items():
                expected = first_partners(matrix, every)
                assert [first_of(row, event, "partner")[0] for row in found] == [
                    step for step, _ in expected
                ]
                assert max(step for step, _ in expected) > 0


@pytest.mark.parametrize("policy", POLICIES, ids=named)
@pytest.mark.parametrize("every", [1, 5, 7])
def test_what_ends_an_episode_ends_it_after_a_kth_step(policy, every):
    ended = {"on_jackknife": 0, "on_collision": 0}
    for drive in drives_of(policy):
        last = int(drive.step[-1])
        bent = [step for step, _ in first_jackknifes(drive, every)]
        hit = [step for step, _ in first_partners(chains_touch(drive), every)]
        for rule, steps in (("on_jackknife", bent), ("on_collision", hit)):
            first = min([step for step in steps if step > 0], default=last)
            table = run(policy, every=every, episodes=[drive.episode], **{rule: "end"})
            assert set(table["steps"].to_pylist()) == {first}
            ended[rule] += first < last
    if COMPILED:
        assert ended["on_jackknife"] > 0
        assert (ended["on_collision"] > 0) == (policy == DubinsPursuit())  # it does not evade


@pytest.mark.parametrize("rules", [{"record_every": 2}, {"record_every": 100}])
def test_collisions_between_steps_need_every_step(rules):
    told = "record_every is .*, but must be 1 where continuous_collisions is on"
    task = Task(continuous_collisions=True, **rules)
    with pytest.raises(ValueError, match=told):
        Batch(DENSE, 1, task)
    with pytest.raises(ValueError, match=told):
        rollout("avoid_jack", "paper-pair", 0, np.arange(1), task)
    with pytest.raises(ValueError, match=told):
        set_rules(Task(continuous_collisions=True), **rules)
    Batch(DENSE, 1, task._replace(record_every=1))


@pytest.mark.parametrize("value", [0, -1, 10**9])
def test_a_number_of_steps_that_is_none_is_named(value):
    with pytest.raises(ValueError, match=f"record_every is {value}"):
        Batch(DENSE, 1, Task(record_every=value))
