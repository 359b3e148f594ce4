"""Own speed and steering are two optional columns after the own ones."""

import numpy as np
import pytest

from hav_env import Limited, Observation, OnAxle, RandomFleet, RandomPoses, Task
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.observation import name_columns
from hav_env.world.arrays import SPEED, STEERING
from tests.support.budgets import budget

# large goals are hit by chance, and weak brakes let HAVs roll on from them
TASK = Task(dt=2.0, distance_tolerance=25.0, heading_tolerance=2.8)
VEHICLE = OnAxle(actuators=Limited(braking=0.05))
FAST = RandomPoses(num_havs=3, fleet=RandomFleet(speed_max=5.0))
OTHERS = {"neighbors": 2, "fronts": True}


@pytest.mark.parametrize("neighbors", [0, 2])
def test_motion_adds_two_columns_behind_the_own_ones(neighbors):
    without, within = (name_columns(Observation(neighbors, motion=m), 3) for m in (False, True))
    last = within.index("articulation_sine_3")
    assert within[: last + 1] == without[: last + 1]
    assert within[last + 1 : last + 3] == ("speed", "steering")
    assert within[last + 3 :] == without[last + 1 :]


def rows(process, steps, seed=3):
    """Yield rows (W, N, D) of observations at the start and during random actions."""
    everywhere, told = np.ones(process.num_worlds, np.bool_), process.outcome()
    process.begin(
        np.arange(process.num_worlds), np.zeros(process.num_worlds, int), everywhere, told
    )
    rng = np.random.default_rng(seed)
    yield told.observation
    for _ in range(steps):
        actions = rng.uniform(-1.0, 1.0, (process.num_worlds, process.num_havs, 2))
        actions[..., 0] = abs(actions[..., 0])
        yield process.step(actions).observation


@pytest.mark.exhaustive
def test_they_are_the_state_over_the_limits_and_all_else_is_as_without_them():
    worlds = budget(20, 3)
    seeing, blind = (
        DecisionProcess(
            worlds, None, scenario=FAST, task=TASK, vehicle=VEHICLE, observation=observation
        )
        for observation in (Observation(**OTHERS, motion=True), Observation(**OTHERS))
    )
    at = [seeing.columns.index(name) for name in ("speed", "steering")]
    named = [seeing.columns.index(name) for name in blind.columns]
    state, limit = seeing.batch.worlds.state, seeing.batch.worlds.fleet.limit
    rolled = turned = 0
    for one, other in zip(rows(seeing, 40), rows(blind, 40), strict=True):
        shares = state.speed / limit[:, SPEED], state.steering / limit[:, STEERING]
        for column, share in zip(at, shares, strict=True):
            assert one[..., column] == pytest.approx(share.T, abs=1e-6)
        assert one[..., named].tobytes() == other.tobytes()
        rolled += (state.waiting & (state.speed > 0.0)).sum()
        turned += (state.steering != 0.0).sum()
    assert min(rolled, turned) > budget(10, 0)


@pytest.mark.exhaustive
def test_neighbours_that_brake_at_their_goals_are_seen_at_their_speed():
    process = DecisionProcess(
        3, None, scenario=FAST, task=TASK, vehicle=VEHICLE, observation=Observation(**OTHERS)
    )
    at, present = map(process.columns.index, ("neighbor_0_speed", "neighbor_0_present"))
    state, seen = process.batch.worlds.state, 0
    for row in rows(process, 40):
        for w, agent in np.argwhere(row[..., present]):
            speeds = np.delete(state.speed[:, w], agent) / 10.0
            assert abs(speeds - row[w, agent, at]).min() < 1e-6
        seen += (state.waiting & (state.speed > 0.0)).sum()
    assert seen > 0
