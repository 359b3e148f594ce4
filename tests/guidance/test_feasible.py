"""Feasible routes can be driven by the HAV's own chain, and lead to within the tolerance."""

import math
import re

import numpy as np
import pytest

from hav_env import Batch, OnAxle, Task, find_scenario
from hav_env.evaluation.rollout import rollout
from hav_env.guidance import Dubins, Feasible
from hav_env.maths.dubins import path_length
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.policies.driver import PolicyDriver
from hav_env.vehicles import Limited, OffAxle, Rectangles
from hav_env.world.arrays import HIT_STEP, PATH
from hav_env.world.place.guidance import (
    FROM_X,
    LEFT,
    PLAN_CURVATURES,
    PLAN_HELD_CURVATURE,
    PLAN_LENGTHS,
    ROUTE_DIRECT,
    follow_route,
)
from hav_env.world.sensing import drivable_radius, goal_pose
from tests.support.budgets import COMPARED, COMPILED

WORLDS, TASK, GUIDE = 300, Task(), Feasible()
MOST_ROUNDED = 1e-9


def begun(num_worlds=WORLDS, scenario="paper-single", guidance=GUIDE, seed=3):
    batch = Batch(find_scenario(scenario), num_worlds, guidance=guidance, threads=1)
    batch.reset(seed)
    return batch


def drive_chain(batch, agent, w):
    """Drive a plan with Euler steps; return the least gap of joints to their limit, and misses."""
    worlds = batch.worlds
    plan, fleet = worlds.guidance.plan[agent, :, w], worlds.fleet
    units = int(fleet.num_trailers[agent, w]) + 1
    length = fleet.length[agent, :units, w]
    speed_max, steering_max, bend_max = batch.worlds.fleet.limit[agent, :3, w]
    bends = plan[PLAN_CURVATURES : PLAN_CURVATURES + 3]
    ends = np.concatenate([[0.0], np.cumsum(plan[PLAN_LENGTHS : PLAN_LENGTHS + 3])])
    turns = np.concatenate([[0.0], np.cumsum(bends * np.diff(ends))])
    heading = worlds.state.heading[agent, :units, w].copy()
    x, y = worlds.state.x[agent, w], worlds.state.y[agent, w]
    step, first = speed_max * TASK.dt, heading[0]
    goal_x, goal_y, goal_heading = worlds.state.goal[agent, :3, w]
    gap, misses = math.inf, []
    for k in range(math.ceil(ends[-1] / step) + 1):
        wanted = first + np.interp((k + 0.5) * step, ends, turns)
        most = step * math.tan(steering_max) / length[0]
        heading[0] += np.clip(wanted - heading[0], -most, most)
        x, y = x + step * math.cos(heading[0]), y + step * math.sin(heading[0])
        pull = step
        for j in range(1, units):
            heading[j] -= pull * math.sin(heading[j] - heading[j - 1]) / length[j]
            pull *= math.cos(heading[j] - heading[j - 1])
        gap = min(gap, bend_max - np.abs(np.diff(heading)).max(initial=0.0))
        off = (heading[0] - goal_heading + math.pi) % (2 * math.pi) - math.pi
        misses.append((math.hypot(x - goal_x, y - goal_y), abs(off)))
        if misses[-1][0] < TASK.distance_tolerance and misses[-1][1] < TASK.heading_tolerance:
            break
    return gap, misses[-1]


@pytest.fixture(scope="module")
def batch():
    return begun()


@pytest.mark.exhaustive
def test_an_independent_chain_drives_each_route_within_its_limits_to_the_goal(batch):
    found = batch.worlds.guidance.route[0, ROUTE_DIRECT] == 0.0
    assert found.mean() > 0.9  # the others have the Dubins path that they can drive for good
    for w in np.flatnonzero(found):
        gap, (distance, off) = drive_chain(batch, 0, w)
        assert gap > GUIDE.margin - MOST_ROUNDED
        assert distance < TASK.distance_tolerance
        assert off < TASK.heading_tolerance


@pytest.mark.exhaustive
def test_routes_are_shorter_than_dubins_paths_that_a_chain_drives_for_good(batch):
    worlds = batch.worlds
    dubins = [
        path_length(*goal_pose(worlds, 0, w), drivable_radius(worlds, 0, w)) for w in range(WORLDS)
    ]
    left = worlds.guidance.route[0, LEFT]
    assert left.sum() < 0.95 * np.sum(dubins)
    plans = worlds.guidance.plan[0, PLAN_LENGTHS : PLAN_LENGTHS + 3].sum(axis=0)
    np.testing.assert_allclose(left, plans, atol=1e-9)


@pytest.mark.exhaustive
def test_a_hav_that_strays_plans_anew_from_where_it_stands_and_one_near_its_route_does_not(batch):
    worlds = begun(4).worlds
    state, route = worlds.state, worlds.guidance.route
    before = route[0, FROM_X].copy()
    for w, aside in enumerate((0.0, 0.5, 1.5, 3.0)):  # [m]
        heading = state.heading[0, 0, w]
        state.x[0, w] -= aside * math.sin(heading)
        state.y[0, w] += aside * math.cos(heading)
    follow_route(worlds.guidance, worlds, 0)
    np.testing.assert_array_equal(route[0, FROM_X, :2], before[:2])
    np.testing.assert_array_equal(route[0, FROM_X, 2:], state.x[0, 2:])


@pytest.mark.exhaustive
def test_the_column_of_steering_keeps_to_the_route_over_the_next_metre():
    process = DecisionProcess(8, scenario="paper-single", guidance=GUIDE)
    told = process.outcome()
    process.begin(np.arange(8), np.zeros(8, np.int64), np.ones(8, np.bool_), told)
    worlds, columns = process.batch.worlds, process.columns
    curvature = worlds.guidance.plan[0, PLAN_HELD_CURVATURE]
    steering = np.arctan(curvature * worlds.fleet.length[0, 0]) / worlds.fleet.limit[0, 1]
    for name in ("goal_path_steering", "approach_path_steering"):
        seen = told.observation[:, 0, columns.index(name)]
        np.testing.assert_allclose(seen, np.clip(steering, -1.0, 1.0), atol=1e-5)


@pytest.mark.skipif(not COMPILED, reason=COMPARED)
@pytest.mark.exhaustive
def test_rollouts_are_the_same_over_threads_and_step_by_step():
    episodes, task = 16, Task(max_steps=1_500)

    def run(threads):
        numbers = np.arange(episodes)
        return rollout(
            "avoid_jack", "paper-pair", 0, numbers, task, threads=threads, guidance=GUIDE
        )

    one = run(1)
    assert run(3).equals(one)
    batch = Batch(find_scenario("paper-pair"), episodes, task, guidance=GUIDE)
    batch.reset(0)
    driver = PolicyDriver("avoid_jack", batch)
    hits, paths = np.zeros((2, episodes)), np.zeros((2, episodes))
    running = np.ones(episodes, bool)
    for _ in range(task.max_steps):
        if not running.any():
            break
        batch.step(*driver.decide())
        record = batch.worlds.record
        paths[:, running] = record.total[:, PATH, running]
        hits[:, running] = record.goal[:, 0, HIT_STEP, running]
        running &= ~batch.ended
    np.testing.assert_array_equal(paths.T.ravel(), one["path_length"].to_numpy())
    told = one["goal_1_step"].fill_null(-1).to_numpy()
    np.testing.assert_array_equal(hits.T.ravel()[told >= 0], told[told >= 0])


@pytest.mark.parametrize(
    "vehicle",
    [OffAxle(), OnAxle(substeps=2), OnAxle(simultaneous=True), OnAxle(actuators=Limited())],
)
def test_vehicles_that_are_not_predicted_are_refused_in_one_line(vehicle):
    with pytest.raises(ValueError, match=re.escape("but Feasible predicts")) as caught:
        Batch(find_scenario("paper-single"), 1, vehicle=vehicle, guidance="feasible")
    assert "\n" not in str(caught.value)


def test_bodies_do_not_matter_and_unguided_worlds_hold_nothing():
    wide = OnAxle(bodies=Rectangles())
    Batch(find_scenario("paper-single"), 1, vehicle=wide, guidance="feasible")
    assert begun(2, guidance=Dubins()).worlds.guidance == Dubins()
