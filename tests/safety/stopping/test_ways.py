"""No point of a HAV moves farther until it stands than its bound, and joints hold on the way on."""

import numpy as np
import pytest

from hav_env import (
    Batch,
    Limited,
    OffAxle,
    OnAxle,
    RandomFleet,
    RandomPoses,
    Rectangles,
    Task,
    catalogue_fleet,
)
from hav_env.compiled import canonical, entry
from hav_env.safety import SafetyFilter
from hav_env.safety.stopping.ways import sum_of_speeds, way_of_other
from tests.safety.stopping.limited_havs import filter_all
from tests.safety.test_bounds import corners
from tests.support.audit import joints_of
from tests.support.budgets import budget

TASK = Task(max_steps=10_000)
FAST = RandomPoses(num_havs=1, fleet=RandomFleet(speed_max=4.0))
REAL = RandomPoses(num_havs=1, fleet=catalogue_fleet(("baggage-train", "wb-67", "b-double")))


@entry
def _bound_ways(first, last, actuators, dt, worlds, brakes, bounds):
    for w in range(first, last):
        bounds[w] = way_of_other(actuators, dt, worlds, 0, w, brakes)


def bound_ways(vehicle, worlds, brakes):
    """Return the bounds [m] on the movement of the only HAV of each world."""
    bounds = np.zeros(worlds.lanes)
    limits = canonical(vehicle.actuators)
    _bound_ways(worlds.lanes, limits, TASK.dt, worlds, brakes, bounds, threads=1)
    return bounds


def test_speeds_of_braking_add_up():
    rng = np.random.default_rng(1)
    for speed, slower in rng.uniform(0.001, 30.0, (500, 2)):
        speeds, sum_of_all = speed, 0.0
        while speeds > 0.0:
            sum_of_all, speeds = sum_of_all + speeds, speeds - slower
        assert sum_of_speeds(speed, slower) == pytest.approx(sum_of_all, rel=1e-12)
    assert sum_of_speeds(1.0, 2e8) == 1.0
    assert sum_of_speeds(1.2, 0.4) == pytest.approx(2.4, abs=1e-12)


def stop(batch, vehicle, rng, brakes):
    """Let HAVs stop; return the farthest movement of any point, as a share of the bound."""
    state, limit = batch.worlds.state, batch.worlds.fleet.limit
    bounds, begin = bound_ways(vehicle, batch.worlds, brakes), corners(batch.worlds)
    moves, first = np.zeros(len(begin)), not brakes
    while first or (state.speed > 0.0).any():
        if first:  # the worst command may be any
            sign = rng.choice([-1.0, 0.0, 1.0], state.x.shape)
            batch.step(limit[:, 0].copy(), sign * limit[:, 1])
        else:
            batch.step(np.zeros(state.x.shape), state.steering.copy())
        first = False
        ways = [abs(b - a).max() for a, b in zip(begin, corners(batch.worlds), strict=True)]
        moves = np.maximum(moves, ways)
    assert (moves[bounds == 0.0] == 0.0).all() or brakes
    far = bounds > 0.0
    return moves[far] / bounds[far]


@pytest.mark.parametrize(
    ("vehicle", "scenario"),
    [
        (OnAxle(actuators=Limited()), FAST),
        pytest.param(
            OffAxle(bodies=Rectangles(), actuators=Limited()), REAL, marks=pytest.mark.exhaustive
        ),
    ],
)
def test_no_point_moves_farther_until_its_hav_stands_than_the_bound(vehicle, scenario):
    batch, rng = Batch(scenario, budget(60, 3), TASK, vehicle), np.random.default_rng(3)
    batch.reset(3)
    state, limit, shares = batch.worlds.state, batch.worlds.fleet.limit, []
    for number in range(budget(12, 3)):
        sign = rng.choice([-1.0, 1.0], state.x.shape)
        for _ in range(rng.integers(1, 40)):
            batch.step(limit[:, 0].copy(), sign * limit[:, 1])
        shares.append(stop(batch, vehicle, rng, brakes=number % 2 == 0))
    for some in (shares[::2], shares[1::2]):
        assert np.concatenate(some).max() <= 1.0
        assert np.concatenate(some).max() > (0.5 if scenario is FAST else 0.2)  # informative


@pytest.mark.exhaustive
@pytest.mark.parametrize(
    ("vehicle", "scenario"),
    [
        (OnAxle(actuators=Limited()), FAST),
        (OffAxle(bodies=Rectangles(), actuators=Limited()), REAL),
    ],
)
def test_havs_keep_their_joints_straight_on_at_any_speeds(vehicle, scenario):
    worlds, safety = budget(200, 3), SafetyFilter("jackknife")
    batch, rng = Batch(scenario, worlds, TASK, vehicle), np.random.default_rng(6)
    batch.reset(6)
    state, limit = batch.worlds.state, batch.worlds.fleet.limit

    def go(speed, steering):
        batch.step(speed, steering)
        assert (joints_of(batch.worlds) < limit[:, 2:3]).all()

    for _ in range(budget(8, 2)):
        for step in range(budget(60, 8)):
            if step % 20 == 0:
                signs = rng.choice([-1.0, 0.5, 1.0], state.x.shape)
            given = np.stack([limit[:, 0], signs * limit[:, 1]])
            go(*filter_all(safety, TASK, vehicle, batch.worlds, given))
        while (state.speed > 0.0).any():
            go(np.zeros(state.x.shape), state.steering.copy())
        while (state.steering != 0.0).any():
            go(np.zeros(state.x.shape), np.zeros(state.x.shape))
        for _ in range(budget(60, 8)):
            go(limit[:, 0] * rng.choice([0.0, 0.1, 1.0], state.x.shape), np.zeros(state.x.shape))
