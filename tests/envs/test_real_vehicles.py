"""Environments of real vehicles: actions in physical units, resets that write poses, own models."""

from typing import NamedTuple

import gymnasium as gym
import numpy as np
import pytest

from hav_env import (
    Batch,
    Limited,
    OffAxle,
    OnAxle,
    RandomPoses,
    catalogue_fleet,
    explicit,
    load_explicit,
    move,
    parallel_env,
)
from hav_env.envs.wrappers import PhysicalActions, PhysicalParallelActions
from hav_env.vehicles import needs_hitches
from hav_env.world.arrays import CLOSEST, HIT_DISTANCE
from tests.support.paths import ROOT

DEPOT = ROOT / "examples/depot.json"
MIXED = RandomPoses(num_havs=6, fleet=catalogue_fleet(["tugger-train", "eu-semi-trailer"]))


def worlds_of(env):
    return env.unwrapped._world.process.batch.worlds


@pytest.mark.exhaustive
@pytest.mark.parametrize("flatten", [False, True])
def test_physical_actions_are_those_of_each_hav(flatten):
    env = gym.make("hav_env:HAVSwarm-v0", scenario=MIXED, vehicle="off_axle", flatten=flatten)
    wrapped = PhysicalActions(env)
    wrapped.reset(seed=1)
    wrapped.step(np.tile([1.0, 0.3], 6).reshape(env.action_space.shape))
    state = worlds_of(env).state
    assert len(np.unique(worlds_of(env).fleet.num_trailers)) == 2
    np.testing.assert_allclose(state.speed[:, 0], 1.0, rtol=1e-6)
    np.testing.assert_allclose(state.steering[:, 0], 0.3, rtol=1e-6)
    together = PhysicalParallelActions(parallel_env(scenario=MIXED, vehicle="off_axle"))
    together.reset(seed=1)
    together.step({agent: [0.5, -0.2] for agent in together.agents})
    state = worlds_of(together).state
    np.testing.assert_allclose(state.speed[:, 0], 0.5, rtol=1e-6)
    np.testing.assert_allclose(state.steering[:, 0], -0.2, rtol=1e-6)


@pytest.mark.exhaustive
def test_a_reset_that_writes_goals_keeps_bent_starts():
    env = parallel_env(scenario=load_explicit(DEPOT), vehicle="realistic")
    env.reset(seed=0)
    drawn = worlds_of(env).state.heading.copy()
    assert np.diff(drawn[0, :, 0]).tolist() == pytest.approx([0.2, -0.1])
    goals = worlds_of(env).goals[..., 0]
    env.reset(seed=0, options={"goals": goals})
    np.testing.assert_allclose(worlds_of(env).state.heading[0], drawn[0], atol=1e-12)
    env.reset(seed=0, options={"bends": [[0.0, 0.3], [0.1]]})
    heading = worlds_of(env).state.heading[..., 0]
    assert np.diff(heading[0]).tolist() == pytest.approx([0.0, 0.3])
    assert heading[1, 1] - heading[1, 0] == pytest.approx(0.1)


def test_a_reset_that_writes_hitches_is_refused_where_the_vehicle_knows_none():
    env = parallel_env(num_havs=2, vehicle="on_axle")
    env.reset(seed=0)
    with pytest.raises(ValueError, match="must support hitches"):
        env.reset(seed=0, options={"lengths": ["eurocombi", [4.0, 5.0]]})


class Sleepy(NamedTuple):
    """A custom model with hitches: half as fast."""

    share: float = 0.5


_OFF_AXLE = OffAxle(1, 0)


@move.register(Sleepy)
def drive_sleepily(vehicle, dt, world, agent):
    move(_OFF_AXLE, vehicle.share * dt, world, agent)


needs_hitches.register(Sleepy, lambda vehicle: True)


@pytest.mark.exhaustive
def test_a_model_of_ones_own_may_have_hitches():
    fleet = catalogue_fleet("eurocombi")
    batches = [
        Batch(RandomPoses(fleet=fleet), 2, vehicle=vehicle) for vehicle in (Sleepy(), OffAxle())
    ]
    for batch in batches:
        batch.reset(3)
    start = batches[0].worlds.state.x.copy()
    for batch in batches:
        batch.step(np.ones((1, 2)), np.zeros((1, 2)))
    slow, fast = (batch.worlds.state.x - start for batch in batches)
    np.testing.assert_allclose(2 * slow, fast, rtol=1e-9)


def test_who_rolls_on_after_its_goal_was_not_closer_to_it():
    """The least distance is that of the path to the goal, up to the hit."""
    goals = [[30.0, 0.0, 0.0], [200.0, 0.0, 0.0]], [[500.0, 50.0, 0.0], [900.0, 50.0, 0.0]]
    scenario = explicit([[4.0, 5.0]] * 2, [[0.0, 0.0, 0.0], [0.0, 50.0, 0.0]], goals, speed_max=5.0)
    batch = Batch(scenario, vehicle=OnAxle(actuators=Limited()))
    batch.reset(0)
    record, state = batch.worlds.record.goal[0, 0, :, 0], batch.worlds.state
    speed = np.full((2, 1), 5.0)
    while np.isnan(record[HIT_DISTANCE]):
        batch.step(speed, np.zeros((2, 1)))
    hit, place = record[HIT_DISTANCE], state.x[0, 0]
    for _ in range(20):
        batch.step(speed, np.zeros((2, 1)))
    assert state.waiting[0, 0]
    assert state.x[0, 0] > place + 1.0
    assert record[CLOSEST] == hit
