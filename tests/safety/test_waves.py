"""Predictions of several HAVs at a time decide as predictions step by step do, to the bit."""

import math

import numpy as np
import pytest

from hav_env import Batch, OffAxle, OnAxle, RandomFleet, RandomPoses
from hav_env.compiled import canonical, entry, kernel, lanes_from
from hav_env.maths.geometry import clip
from hav_env.safety.filters import SafetyFilter
from hav_env.safety.keeping import keep_safe
from hav_env.safety.straightening import bends_too_far, bound_backup
from hav_env.safety.trial_moves import (
    IN_DOUBT,
    count_rows,
    drive_on_trial,
    keep_posture,
    put_back,
)
from hav_env.world.arrays import INTERVENTIONS, SPEED, STEERING
from hav_env.world.lanes import block_of
from hav_env.world.task import Task
from tests.support.budgets import budget

_SIZE = 60  # worlds of a block
_SHARES = (0.0, 0.25, 0.5, 0.7, 0.85)


@kernel
def _straightens(horizon, vehicle, dt, world, speed, steering, rows, first):
    """Simulate the backup step by step; ``first`` lets a bound decide before the joints do."""
    speed[0, 0], steering[0, 0] = world.fleet.limit[0, SPEED, 0], 0.0
    for step in range(horizon):
        bound_backup(dt, world, 0, rows)
        held = rows[IN_DOUBT, 0] == 0.0
        if bends_too_far(world, 0, 0) and not (first and step == 0 and held):
            return False
        if held:
            return True
        drive_on_trial(vehicle, dt, world, 0, speed, steering)
    return False


@entry
def filter_unabridged(first, last, horizon, vehicle, dt, worlds, speed, steering, rows):
    """Filter the commands (1, W) of the only HAV of each world."""
    for w in range(first, last):
        world = block_of(worlds, w, 1, worlds.units)
        v, phi, own = lanes_from(speed, w), lanes_from(steering, w), lanes_from(rows, w)
        asked, turned = v[0, 0], phi[0, 0]
        limit = world.fleet.limit
        keep_posture(world, 0, own)
        steepest = limit[0, STEERING, 0]
        faster, share = limit[0, SPEED, 0], 0.0  # the backup
        for number in range(len(_SHARES) + 1):
            given = number == 0
            tried = turned if given else clip(turned, -steepest, steepest) * _SHARES[number - 1]
            v[0, 0], phi[0, 0] = asked, tried
            drive_on_trial(vehicle, dt, world, 0, v, phi)
            kept = world.state.speed[0, 0] == 0.0 or (asked == limit[0, SPEED, 0] and number == 1)
            kept = kept or _straightens(horizon, vehicle, dt, world, v, phi, own, given)
            put_back(world, 0, own)
            if kept:
                faster, share = asked, tried
            if kept == given:  # the given command, or the first share that is refused
                break
        v[0, 0], phi[0, 0] = faster, share


@entry
def _filter_blocks(first, last, safety, task, vehicle, worlds, speed, steering, rows):
    for start in range(first, last, _SIZE):
        world = block_of(worlds, start, min(_SIZE, last - start), worlds.units)
        keep_safe(
            safety,
            task,
            vehicle,
            world,
            0,
            speed[:, start:],
            steering[:, start:],
            rows[:, start:],
        )


def bent_worlds(num_worlds, fleet, vehicle, seed):
    """Return worlds of one HAV whose joints are bent at random, some nearly to the limit."""
    batch = Batch(RandomPoses(num_havs=1, fleet=fleet), num_worlds, vehicle=vehicle)
    batch.reset(seed)
    rng, state = np.random.default_rng(seed), batch.worlds.state
    sizes = rng.uniform(0.0, 1.75, num_worlds) * rng.choice([0.3, 0.8, 1.0], num_worlds)
    bends = rng.uniform(-1.0, 1.0, state.heading[0].shape) * sizes
    state.heading[0] = np.cumsum(np.where(rng.random(num_worlds) < 0.5, np.abs(bends), bends), 0)
    edge = rng.random(num_worlds) < 0.2  # within the spare angle of the limit
    state.heading[0, 1, edge] = (
        state.heading[0, 0, edge] + math.pi / 2 - 2e-6 * rng.random(edge.sum())
    )
    state.cosine[:], state.sine[:] = np.cos(state.heading), np.sin(state.heading)
    return batch.worlds


# bounds of long chains overflow, of which plain Python warns
@pytest.mark.filterwarnings("ignore:overflow encountered", "ignore:invalid value encountered")
@pytest.mark.parametrize(
    ("vehicle", "trailers", "horizon"),
    [
        (OnAxle(), (1, 10), 1_000),
        (OnAxle(), (1, 10), 13),
        pytest.param(OnAxle(), (20, 40), 1_000, marks=pytest.mark.exhaustive),
        pytest.param(OnAxle(substeps=2), (1, 10), 1_000, marks=pytest.mark.exhaustive),
        pytest.param(OnAxle(simultaneous=True), (1, 10), 1_000, marks=pytest.mark.exhaustive),
        pytest.param(OffAxle(), (1, 10), 1_000, marks=pytest.mark.exhaustive),
        pytest.param(OffAxle(integrator="euler"), (1, 10), 70, marks=pytest.mark.exhaustive),
    ],
)
def test_commands_are_those_of_predictions_step_by_step(vehicle, trailers, horizon):
    fleet = RandomFleet(min_trailers=trailers[0], max_trailers=trailers[1])
    count = budget(6_000, 12)
    worlds, rng = bent_worlds(count, fleet, vehicle, 31), np.random.default_rng(32)
    commands = rng.choice([0.0, 0.4, 1.0], (1, count)), rng.uniform(-0.9, 0.9, (1, count))
    rows, model = np.zeros((count_rows(worlds.units), count)), canonical(vehicle)
    expected = [np.array(command) for command in commands]
    filter_unabridged(count, horizon, model, 0.2, worlds, *expected, rows, threads=1)
    before = worlds.state.heading.copy()
    safety = canonical(SafetyFilter("jackknife", horizon))
    found = [np.array(command) for command in commands]
    _filter_blocks(count, safety, canonical(Task()), model, worlds, *found, rows, threads=1)
    assert np.array_equal(found, expected)
    assert np.array_equal(worlds.state.heading, before)
    changed = (found[0] != commands[0]) | (found[1] != commands[1])
    assert np.array_equal(worlds.record.total[:, INTERVENTIONS], changed)
    assert 0.02 < changed.mean() < 0.95 or budget(0, 1)
