"""AVOID-JACK on routes of guidance reaches goals behind walls, in every interface the same way."""

import numpy as np
import pytest

from baselines.policies.dubins_pursuit import DubinsPursuit
from hav_env import Batch, Task, sensing
from hav_env.evaluation.rollout import rollout
from hav_env.guidance import Lattice
from hav_env.policies.driver import PolicyDriver
from hav_env.policies.interface import allocate_memory, decide
from hav_env.simulator import guiding
from hav_env.vehicles import OffAxle
from hav_env.world.arrays import HIT_STEP, PATH
from tests.guidance.yards import yard
from tests.support.budgets import COMPARED, COMPILED

EPISODES, STEPS = 24, 1_500
LATTICE = Lattice(headings=24, clearance=4.0)  # so trailers cut no corners
TASK, VEHICLE = Task(max_steps=STEPS, on_obstacle="end"), OffAxle()

pytestmark = pytest.mark.skipif(not COMPILED, reason=COMPARED)


def run(threads=1):
    episodes = np.arange(EPISODES)
    return rollout("avoid_jack", yard(), 0, episodes, TASK, VEHICLE, threads, LATTICE)


@pytest.mark.exhaustive
def test_more_goals_are_hit_on_routes_than_without(monkeypatch):
    guided = run()
    assert guided["goal_1_hit"].to_numpy().all()
    assert not guided["jackknifed"].to_numpy().any()
    assert not guided["obstacle_collision"].to_numpy().any()
    # lattices of other goals guide no HAV
    known = guiding.poses_of
    monkeypatch.setattr(
        guiding, "poses_of", lambda scenario: (known(scenario)[0] + 0.25, known(scenario)[1])
    )
    alone = run()
    assert alone["goal_1_hit"].to_numpy().mean() < 0.2
    # both record the Dubins path, through the wall
    assert guided["goal_1_dubins_length"].equals(alone["goal_1_dubins_length"])


@pytest.mark.exhaustive
def test_dubins_pursuit_steers_along_the_route_and_else_as_without_guidance():
    """The steering angle turns the truck's path by the curvature of the route, within its limit."""
    batch = Batch(yard(), EPISODES, TASK, VEHICLE, guidance=LATTICE)
    batch.reset(0)
    worlds, bare = batch.worlds, Batch(yard(), EPISODES, TASK, VEHICLE)
    bare.reset(0)
    decisions = [
        decide(DubinsPursuit(), allocate_memory(DubinsPursuit(), 1, EPISODES), one)
        for one in (batch, bare)
    ]
    (speed, steering), (_, alone) = decisions
    guided = 0
    for lane in range(EPISODES):
        known, _, _, curvature, _ = sensing.route_ahead(worlds, 0, lane)
        expected = np.arctan(curvature * worlds.fleet.length[0, 0, lane])
        fastest, most, _ = sensing.limits(worlds, 0, lane)
        expected = np.clip(expected, -most, most) if known else alone[0, lane]
        assert speed[0, lane] == fastest
        assert steering[0, lane] == pytest.approx(expected, abs=1e-12)
        guided += known
    assert guided > EPISODES // 2


@pytest.mark.exhaustive
def test_rollouts_are_the_same_over_threads_and_step_by_step():
    one = run(1)
    assert run(3).equals(one)
    batch = Batch(yard(), EPISODES, TASK, VEHICLE, guidance=LATTICE)
    batch.reset(0)
    driver = PolicyDriver("avoid_jack", batch)
    last = np.zeros(EPISODES, int)
    paths = np.zeros(EPISODES)
    for step in range(STEPS):
        if batch.ended.all():
            break
        batch.step(*driver.decide())
        newly = batch.ended & (last == 0)
        last[newly] = step + 1
        paths[newly] = batch.worlds.record.total[0, PATH, newly]
    assert (last > 0).all()
    np.testing.assert_array_equal(paths, one["path_length"].to_numpy())
    np.testing.assert_array_equal(
        batch.worlds.record.goal[0, 0, HIT_STEP], one["goal_1_step"].to_numpy()
    )
