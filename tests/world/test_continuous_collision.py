"""Collisions between steps: all that Shapely finds on the way are found, and no others."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import distance as distances
from shapely import linestrings

from baselines.policies.dubins_pursuit import DubinsPursuit
from hav_env import Batch, RandomFleet, RandomPoses, Task, explicit
from hav_env.evaluation.rollout import rollout
from hav_env.world.arrays import ACTUAL, WHEN
from hav_env.world.continuous_collision import moving_segments_meet
from tests.support.budgets import budget

MOMENTS = np.linspace(0.0, 1.0, 2001)[:, None]
place = st.integers(-40, 40).map(lambda number: number / 8)
point = st.tuples(place, place)


def way(before, after):
    """Return the positions of a point at all moments (T, 2)."""
    return np.array(before) + MOMENTS * (np.array(after) - np.array(before))


@settings(max_examples=budget(300, 30))
@given(st.lists(point, min_size=8, max_size=8))
def test_moving_segments_meet_where_shapely_finds_them_together(points):
    a, b, c, d = (way(*points[k : k + 2]) for k in range(0, 8, 2))
    gaps = distances(linestrings(np.stack([a, b], axis=1)), linestrings(np.stack([c, d], axis=1)))
    found = moving_segments_meet(*points[::2], *points[1::2])
    nearer = 30.0 / 2000  # than any two points come from one moment to the next
    if gaps.min() == 0.0 and gaps[0] > 0.0:
        assert found
    elif gaps.min() > nearer:
        assert not found


def test_it_matters_when_each_of_two_passes():
    """Both cross the same place, one after the other: segments, not the areas that they sweep."""
    before = (0.0, 0.0), (0.0, 1.0), (-4.0, 0.5), (-3.0, 0.5)
    after = (0.0, 9.0), (0.0, 10.0), (4.0, 0.5), (5.0, 0.5)
    assert not moving_segments_meet(*before, *after)
    still = before[0], before[1], after[2], after[3]
    assert moving_segments_meet(*before, *still)


THROUGH = explicit(
    [[0.4, 0.4], [2.0, 2.0]],
    [[-3.1, 0.0, 0.0], [0.0, 1.0, np.pi / 2]],
    [[[40.0, 0.0, 0.0]], [[0.0, 60.0, np.pi / 2]]],
    speed_max=10.0,
)


def first_collision(**rules):
    """Drive one HAV through the chain of another one, from -1.1 m to 0.9 m of it in one step."""
    batch = Batch(THROUGH, 1, Task(**rules))
    batch.reset(0)
    for _ in range(3):
        batch.step(np.array([[10.0], [0.0]]), np.zeros((2, 1)))
    return batch.worlds.record.first[:, ACTUAL, WHEN, 0].tolist()


def test_a_hav_that_jumps_over_a_chain_collides_if_the_task_looks_between_steps():
    assert first_collision() == [-1, -1]
    assert first_collision(continuous_collisions=True) == [2, 2]


@pytest.mark.parametrize("num_havs", [4, 18])
def test_looking_between_steps_adds_collisions_and_changes_nothing_else(num_havs):
    scenario = RandomPoses(num_havs=num_havs, fleet=RandomFleet(max_trailers=2, speed_max=8.0))
    tables = [
        rollout(
            *(DubinsPursuit(), scenario, 6, np.arange(budget(40, 1))),
            Task(max_steps=budget(800, 3), continuous_collisions=continuous),
        ).to_pydict()
        for continuous in (False, True)
    ]
    at_steps, between = (np.array(table.pop("actual_collision")) for table in tables)
    assert not (at_steps & ~between).any()
    assert budget(between.sum() > at_steps.sum(), True)
    for table in tables:
        del table["actual_collision_step"], table["actual_collision_partner"]
    assert str(tables[0]) == str(tables[1])


def test_whoever_leaves_the_world_sweeps_nothing_on_the_way_out():
    """A HAV that has arrived is put far away: the space between is not on its way."""
    batch = Batch(THROUGH, 1, Task(continuous_collisions=True, on_goal="remove"))
    batch.reset(0)
    batch.worlds.goals[0, 0, :, 0] = batch.worlds.state.goal[0, :3, 0] = -3.0, 0.0, 0.0
    for _ in range(3):
        batch.step(np.array([[0.5], [0.0]]), np.zeros((2, 1)))
    assert batch.worlds.state.waiting[0, 0]
    assert (batch.worlds.record.first[:, ACTUAL, WHEN, 0] == -1).all()
