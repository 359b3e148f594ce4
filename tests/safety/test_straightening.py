"""HAVs that the filter finds safe do straighten, by the test's own integration."""

import math

import numpy as np
import pytest

from hav_env import Batch, OnAxle, RandomFleet, RandomPoses, Task
from hav_env.compiled import canonical, entry
from hav_env.safety.filters import SafetyFilter
from hav_env.safety.straightening import bound_backup, straightens_out
from hav_env.safety.trial_moves import IN_DOUBT, count_rows
from hav_env.world.lanes import block_of
from tests.support.budgets import budget

_DT = 0.2


@entry
def _settle_all(first, last, dt, worlds, rows):
    bound_backup(dt, block_of(worlds, first, last - first, worlds.units), 0, rows)


@entry
def _straighten_all(first, last, safety, vehicle, dt, worlds, speed, steering, rows, found):
    for w in range(first, last):
        block = block_of(worlds, w, 1, worlds.units)
        found[w] = straightens_out(
            safety, vehicle, dt, block, 0, speed[:, w:], steering[:, w:], rows[:, w:]
        )


def bent(num_worlds, spread, seed, limit=math.pi / 2):
    """Return worlds of one HAV each, whose articulations are random up to a spread [rad]."""
    fleet = RandomFleet(articulation_max=limit)
    batch = Batch(RandomPoses(num_havs=1, fleet=fleet), num_worlds)
    batch.reset(seed)
    rng, state = np.random.default_rng(seed), batch.worlds.state
    sizes = rng.uniform(0.0, spread, num_worlds) * rng.choice([0.3, 1.0], num_worlds)
    bends = rng.uniform(-1.0, 1.0, state.heading[0].shape) * sizes
    one_way = rng.random(num_worlds) < 0.5  # as in a long curve
    bends = np.where(one_way, np.abs(bends), bends)
    state.heading[0] = np.cumsum(bends, axis=0)
    state.cosine[:], state.sine[:] = np.cos(state.heading), np.sin(state.heading)
    return batch.worlds


def straighten(worlds, steps, speeds):
    """Return the largest articulation (W,) [rad] of HAVs that drive straight on: own equations.

    Args:
        worlds: Worlds of one HAV each.
        steps: Number of steps to integrate, in the order of the paper's program.
        speeds: Function that returns the speeds (W,) of each step [m/s].
    """
    theta, length = worlds.state.heading[0].copy(), worlds.fleet.length[0]
    count, largest = worlds.fleet.num_trailers[0], np.zeros(theta.shape[1])
    for step in range(steps + 1):
        for unit in range(1, theta.shape[0]):
            size = np.abs(theta[unit] - theta[unit - 1])
            largest = np.maximum(largest, np.where(unit <= count, size, 0.0))
        way = speeds(step) * _DT
        for unit in range(1, theta.shape[0]):
            turn = way / length[unit] * np.sin(theta[unit - 1] - theta[unit])
            theta[unit] += np.where(unit <= count, turn, 0.0)
            way = way * np.cos(theta[unit] - theta[unit - 1])
    return largest


@pytest.mark.parametrize("limit", [math.pi / 2, 1.0, 2.0])
def test_what_the_bounds_hold_safe_keeps_below_the_limit_at_all_speeds(limit):
    worlds = bent(budget(20_000, 300), 1.6, 3, limit)
    rows = np.zeros((count_rows(worlds.units), worlds.lanes))
    _settle_all(worlds.lanes, _DT, worlds, rows, threads=1)
    safe = rows[IN_DOUBT] == 0.0
    assert 0.2 < safe.mean() < 0.9
    rng = np.random.default_rng(4)
    full = straighten(worlds, 400, lambda step: np.ones(worlds.lanes))
    varied = straighten(worlds, 400, lambda step: rng.random(worlds.lanes))
    assert (full[safe] < limit).all()
    assert (varied[safe] < limit).all()
    assert (full[~safe] >= limit).any()  # the bounds do separate


def test_predictions_agree_with_an_integration_and_find_nearly_all_that_is_safe():
    worlds = bent(budget(4_000, 60), 1.7, 5)
    largest = straighten(worlds, 1_500, lambda step: np.ones(worlds.lanes))
    rows = np.zeros((count_rows(worlds.units), worlds.lanes))
    found = np.zeros(worlds.lanes, np.bool_)
    commands = np.zeros((2, 1, worlds.lanes))
    models = canonical(SafetyFilter()), canonical(OnAxle()), _DT
    _straighten_all(worlds.lanes, *models, worlds, *commands, rows, found, threads=1)
    clear = np.abs(largest - math.pi / 2) > 1e-5
    assert np.array_equal(found[clear], (largest < math.pi / 2)[clear])
    assert 0.3 < found.mean() < 1.0


def test_circles_little_wider_than_r_min_are_safe_without_a_simulation():
    worlds = bent(budget(500, 20), 0.0, 7)
    length, count = worlds.fleet.length[0], worlds.fleet.num_trailers[0]
    length = np.where(np.arange(length.shape[0])[:, None] <= count, length, 0.0)
    radius, heading = 1.1 * np.sqrt((length[1:] ** 2).sum(axis=0)), np.zeros(worlds.lanes)
    for unit in range(1, length.shape[0]):
        heading = heading + np.arcsin(length[unit] / radius)
        worlds.state.heading[0, unit] = heading
        radius = np.sqrt(radius**2 - length[unit] ** 2)
    worlds.state.cosine[:] = np.cos(worlds.state.heading)
    worlds.state.sine[:] = np.sin(worlds.state.heading)
    rows = np.zeros((count_rows(worlds.units), worlds.lanes))
    _settle_all(worlds.lanes, _DT, worlds, rows, threads=1)
    assert (rows[IN_DOUBT] == 0.0).mean() > 0.95
    assert (heading > math.pi / 2).mean() > 0.3  # more than the hull of headings holds safe


def test_longer_steps_than_trailers_are_in_doubt():
    worlds = bent(8, 0.5, 9)
    rows = np.zeros((count_rows(worlds.units), worlds.lanes))
    _settle_all(worlds.lanes, 50.0, worlds, rows, threads=1)
    assert (rows[IN_DOUBT] == 1.0).all()
    assert Task().dt == _DT
