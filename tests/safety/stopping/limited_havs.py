"""This module integrates HAVs with limited actuators in NumPy, straight from the equations.

It shares no code with the simulator or with the safety filter.
"""

import itertools

import numpy as np
import shapely

from hav_env.compiled import canonical, entry, kernel
from hav_env.safety import filter_commands, scratch_rows
from hav_env.world.lanes import block_of
from tests.support.audit import Audit
from tests.support.obstacles import unit_shapes

_SIZE = 40  # worlds of a block


class OnAxleHavs:
    """HAVs of many worlds: on-axle hitches, Euler steps, limited rates.

    Attributes:
        x, y: (N, W) rear axle of the truck [m].
        heading: (N, U, W) [rad].
        speed, steering: (N, W) of the truck [m/s], [rad].
    """

    def __init__(self, worlds, limits, dt=0.2):
        """Begin at the places of HAVs that stand."""
        state, fleet = worlds.state, worlds.fleet
        self.x, self.y, self.heading = state.x.copy(), state.y.copy(), state.heading.copy()
        self.speed, self.steering = np.zeros(self.x.shape), np.zeros(self.x.shape)
        self.units = fleet.num_trailers + 1  # (N, W)
        self.length = np.where(self._present(), fleet.length, 1.0)
        self.fastest, self.steepest, self.most_bent = np.moveaxis(fleet.limit[:, :3], 1, 0)
        self.limits, self.dt = limits, dt

    def _present(self):
        return np.arange(self.heading.shape[1])[:, None] < self.units[:, None]

    def step(self, speed, steering, waiting):
        """Move all HAVs by a step: commands (N, W); waiting HAVs (N, W) brake."""
        limits, dt = self.limits, self.dt
        wanted = np.clip(np.where(waiting, self.steering, steering), -self.steepest, self.steepest)
        turn = limits.steering_rate * dt
        self.steering += np.clip(wanted - self.steering, -turn, turn)
        tangent = np.tan(self.steering)
        in_curve = np.sqrt(limits.lateral * self.length[:, 0] / np.maximum(abs(tangent), 1e-30))
        target = np.where(waiting, 0.0, np.clip(speed, 0.0, self.fastest))
        change = np.minimum(target, in_curve) - self.speed
        self.speed += np.clip(change, -limits.braking * dt, limits.acceleration * dt)
        self.heading[:, 0] += dt * self.speed * tangent / self.length[:, 0]
        self.x += dt * self.speed * np.cos(self.heading[:, 0])
        self.y += dt * self.speed * np.sin(self.heading[:, 0])
        ahead = self.speed
        for unit in range(1, self.heading.shape[1]):
            bend = self.heading[:, unit] - self.heading[:, unit - 1]
            turned = -dt * ahead * np.sin(bend) / self.length[:, unit]
            self.heading[:, unit] += np.where(self._present()[:, unit], turned, 0.0)
            ahead = ahead * np.cos(self.heading[:, unit] - self.heading[:, unit - 1])

    def bends(self):
        """Return the largest articulation of each HAV (N, W) [rad]."""
        bends = np.abs(np.diff(self.heading, axis=1))
        return np.where(self._present()[:, 1:], bends, 0.0).max(axis=1)

    def gaps(self):
        """Return the distances of all pairs of HAVs (P, W) [m], as Shapely measures them."""
        units = np.moveaxis(self.heading, 1, 2), np.moveaxis(self.length, 1, 2)
        lines = unit_shapes(self.x, self.y, *units, np.zeros(units[0].shape))
        lines = np.where(np.moveaxis(self._present(), 1, 2), lines, shapely.Point())
        havs = shapely.union_all(lines, axis=2)
        pairs = itertools.combinations(range(len(havs)), 2)
        return np.array([shapely.distance(havs[i], havs[j]) for i, j in pairs])


class Guarded:
    """A batch whose commands pass the safety filter, and the same HAVs in NumPy."""

    def __init__(self, batch, safety, task, vehicle, seed):
        """Begin the episodes of a seed; without a filter (None) all commands are executed."""
        self.batch, self.safety, self.task, self.vehicle = batch, safety, task, vehicle
        batch.reset(seed)
        self.havs = OnAxleHavs(batch.worlds, vehicle.actuators, task.dt)
        self.audit = Audit(batch.worlds, task.dt)
        self.least, self.touched = np.inf, self.havs.gaps() <= 0.0

    def command(self, speed, steering):
        """Filter and execute commands (N, W), and audit the step; return what was executed."""
        worlds, given = self.batch.worlds, np.stack([speed, steering])
        executed = given
        if self.safety is not None:
            executed = filter_all(self.safety, self.task, self.vehicle, worlds, given)
        waiting = worlds.state.waiting.copy()
        self.batch.step(*executed)
        self.havs.step(*executed, waiting)
        self.audit.look()
        gaps = np.where(self.touched, np.inf, self.havs.gaps())
        self.least = gaps.min(initial=self.least)
        return executed

    def error(self):
        """Return the largest difference of the positions from those of the batch [m]."""
        state = self.batch.worlds.state
        return max(abs(state.x - self.havs.x).max(), abs(state.y - self.havs.y).max())


@entry
def _filter_worlds(first, last, safety, task, vehicle, worlds, command, filtered, memory, rows):
    filter_blocks(first, last, safety, task, vehicle, worlds, command, filtered, memory, rows)


@kernel
def filter_blocks(first, last, safety, task, vehicle, worlds, command, filtered, memory, rows):
    """Filter commands (2, N, W) of all worlds."""
    for start in range(first, last, _SIZE):
        world = block_of(worlds, start, min(_SIZE, last - start), worlds.units)
        filter_commands(
            safety,
            task,
            vehicle,
            world,
            command[:, :, start:],
            filtered[:, :, start:],
            memory[:, :, start:],
            rows[:, start:],
        )


def filter_all(safety, task, vehicle, worlds, command, plain=False):
    """Return the filtered commands (2, N, W) of all worlds, in plain Python or compiled."""
    filtered, num_worlds = np.zeros(command.shape), command.shape[2]
    rows = np.zeros((scratch_rows(safety, worlds.units), num_worlds))
    memory = np.zeros((len(worlds.state.x), 0, num_worlds))
    models = canonical(safety), canonical(task), canonical(vehicle)
    arrays = worlds, command, filtered, memory, rows
    if plain:
        filter_blocks(0, num_worlds, *models, *arrays)
    else:
        _filter_worlds(num_worlds, *models, *arrays, threads=1)
    return filtered
