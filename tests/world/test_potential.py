"""The circles of potential collisions may lie and be sized otherwise; nothing else changes."""

import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.dubins_pursuit import DubinsPursuit
from baselines.replay.trajectory import record_trajectory
from hav_env import Batch, RandomPoses, Task
from hav_env.evaluation.rollout import rollout
from tests.support.brute_force import NEVER, circles_touch, first_partners
from tests.support.budgets import COMPILED, budget

CIRCLES = [(0.0, 0.0), (0.5, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.5), (0.3, 0.8), (1.0, 1.0)]
POLICIES = [DubinsPursuit(), AvoidJack()]
SCENARIOS = {  # HAVs: scenario, episodes and steps, compiled and not
    2: (RandomPoses(num_havs=2), (12, 12), (600, 8)),
    4: (RandomPoses(num_havs=4, area_factor=2.5), (8, 2), (300, 20)),
    20: (RandomPoses(num_havs=20), (2, 1), (200, 6)),  # the simulator compares neighbours
}


def named(policy):
    return type(policy).__name__


def of(num_havs):
    """Return scenario, episodes and task."""
    scenario, episodes, steps = SCENARIOS[num_havs]
    return (
        scenario,
        np.arange(budget(*episodes)),
        Task(max_steps=budget(*steps), sensing_range=100.0),
    )


def circles(task, center, truck_share):
    return task._replace(potential_center=center, potential_truck_share=truck_share)


@pytest.mark.parametrize("policy", POLICIES, ids=named)
@pytest.mark.parametrize("num_havs", SCENARIOS)
def test_the_first_potential_collision_is_that_of_these_circles(policy, num_havs):
    compare_with_brute_force(policy, *of(num_havs))


def test_wide_circles_need_no_sensing_range_in_large_swarms():
    scenario, episodes, task = of(20)
    compare_with_brute_force(DubinsPursuit(), scenario, episodes, task._replace(sensing_range=0.0))


@pytest.mark.parametrize("num_havs", [2, 4])
def test_wide_circles_need_no_sensing_range_in_small_swarms(num_havs):
    scenario, episodes, task = of(num_havs)
    compare_with_brute_force(DubinsPursuit(), scenario, episodes, task._replace(sensing_range=0.0))


def compare_with_brute_force(policy, scenario, episodes, task):
    """Compare the first potential collisions of rollouts with those in all recorded states."""
    drives = [record_trajectory(policy, scenario, 2, int(k), task) for k in episodes]
    whens = set()
    for center, truck_share in CIRCLES:
        rows = rollout(policy, scenario, 2, episodes, circles(task, center, truck_share))
        rows, steps = iter(rows.to_pylist()), []
        for drive in drives:
            for step, partners in first_partners(circles_touch(drive, center, truck_share)):
                row = next(rows)
                found = row["potential_collision_step"]
                assert (NEVER if found is None else found) == step
                assert row["potential_collision_partner"] in (partners or {None})
                assert row["potential_collision"] == (found is not None)
                steps.append(step)
        whens.add(tuple(steps))
    assert len(whens) > budget(4, 1)  # the circles make a difference


@pytest.mark.parametrize("policy", POLICIES, ids=named)
@pytest.mark.parametrize("num_havs", [2, 4])
def test_everything_else_stays_the_same(policy, num_havs):
    scenario, episodes, task = of(num_havs)
    kept, changes = None, set()
    for center, truck_share in CIRCLES:
        table = rollout(policy, scenario, 2, episodes, circles(task, center, truck_share))
        names = [name for name in table.column_names if not name.startswith("potential_")]
        assert {"start_x", "goal_2_heading", "actual_collision_step", "path_length"} <= set(names)
        kept = kept or repr(table.select(names).to_pydict())
        assert repr(table.select(names).to_pydict()) == kept
        changes.add(repr(table["potential_collision_step"].to_pylist()))
    assert len(changes) > 1 or not COMPILED


@pytest.mark.parametrize("field", ["potential_center", "potential_truck_share"])
@pytest.mark.parametrize("value", [-0.1, 1.1, float("nan")])
def test_a_share_that_is_none_is_named(field, value):
    with pytest.raises(ValueError, match=f"{field} is {value}"):
        Batch(RandomPoses(), 1, Task(**{field: value}))
