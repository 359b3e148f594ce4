"""This module collects the records of ended episodes, a row for each HAV, for the episode table."""

import functools

import numpy as np

from hav_env.policies.interface import joint_weights
from hav_env.world.arrays import (
    DUBINS,
    HIT_PATH,
    HIT_STEP,
    MISS_ARTICULATION,
    MISS_COUNT,
    NEVER,
    WHERE,
    World,
)
from hav_env.world.event_table import EVENTS, Event, events_in, happened
from hav_env.world.task import Task
from hav_env.world.units.reading import offsets_in


class HavRecords:
    """R rows, in the order of episodes and HAVs; names and columns as in ``hav_env.world.arrays``.

    Attributes:
        num_havs: Number of HAVs of a world.
        num_goals: G, of a HAV.
        dt: Duration of a step [s].
        policy: Policy whose jackknife weights are reported; the paper's weights for policies
            without any.
        clock: (4, R) clock.
        num_trailers: (R,) number of trailers.
        length: (R, U) length of each unit [m], 0 beyond the last unit.
        offset: (R, U) distance from each axle back to the hitch of the next trailer [m], 0 for the
            last unit.
        present: (R, U - 1) bool: whether the HAV has this trailer.
        radius: (R, 2) radii [m].
        start: (R, 3) start poses.
        goals: (R, G, 3) goal poses.
        first: (R, E, 2) step and place of the first occurrence of every event.
        total: (R, 4) running totals.
        goal: (R, G, 6) records of goals.
        miss: (R, G, 2, 3 + U - 1) records of close misses.
    """

    def __init__(self, worlds: World, start: np.ndarray, policy, task: Task) -> None:
        """Arrange the records.

        Args:
            worlds: Batch at the end of its episodes.
            start: (N, 3, W) start poses.
            policy: Policy whose jackknife weights are reported.
            task: Rules of the episode.
        """
        self.num_havs, self._num_worlds = worlds.state.x.shape
        self.num_goals = worlds.goals.shape[1]
        self.dt, self.policy = task.dt, policy
        self.clock = np.repeat(worlds.state.clock, self.num_havs, axis=1)
        self.num_trailers = self._rows(worlds.fleet.num_trailers)
        length = self._rows(worlds.fleet.length)
        self.present = np.arange(1, length.shape[1]) <= self.num_trailers[:, None]
        self.length = length.copy()
        self.length[:, 1:][~self.present] = 0.0
        self.offset = self._rows(offsets_in(worlds.fleet, slice(None))).copy()
        self.offset[:, :-1][~self.present] = self.offset[:, -1] = 0.0
        self.radius, self.start = self._rows(worlds.fleet.radius), self._rows(start)
        self.first, self.total = self._rows(worlds.record.first), self._rows(worlds.record.total)
        self.goals, self.goal = self._rows(worlds.goals), self._rows(worlds.record.goal)
        self.miss = self._rows(worlds.record.miss)

    def _rows(self, values: np.ndarray) -> np.ndarray:
        """Reshape (N, ..., W) to (W * N, ...)."""
        shape = self._num_worlds * self.num_havs, *values.shape[1:-1]
        # contiguous: NumPy's order of summation, and so the last bit, depends on the layout
        return np.ascontiguousarray(np.moveaxis(values, -1, 0)).reshape(shape)

    @property
    def hav(self) -> np.ndarray:
        """Return the number of each HAV in its world, (R,)."""
        return np.tile(np.arange(self.num_havs), self._num_worlds)

    @functools.cached_property
    def vehicle_length(self) -> np.ndarray:
        """Return the length (R,) from the front axle to the last axle of the straight HAV [m]."""
        return self.length.sum(axis=1) + self.offset.sum(axis=1)

    @functools.cached_property
    def hitch_places(self) -> np.ndarray:
        """Return the distance (R, U) from a straight HAV's front axle to each unit's hitch [m]."""
        return np.cumsum(self.length, axis=1) + np.cumsum(self.offset, axis=1)

    @property
    def obstacles(self) -> bool:
        """Return whether the worlds have obstacles."""
        return len(events_in(self.first)) == len(EVENTS)

    def happened(self, event: Event) -> np.ndarray:
        """Return whether an event has happened to each HAV, (R,) bool."""
        return happened(self.first, event)

    def joint_of(self, event: Event) -> np.ndarray:
        """Return the joint (R,) of an event; 1 if the event never happened."""
        return np.where(self.happened(event), self.first[:, event.row, WHERE], 1)

    @functools.cached_property
    def length_differences(self) -> np.ndarray:
        """Return |l^j - l^{j-1}| (R, U - 1) at every joint [m], 0 beyond the last."""
        return np.where(self.present, np.abs(np.diff(self.length, axis=1)), 0.0)

    def at_joint(self, values: np.ndarray, joint: np.ndarray) -> np.ndarray:
        """Return from values (R, joints) the one (R,) at a joint (R,), which counts from 1."""
        return values[np.arange(len(joint)), joint - 1]

    def hit(self, g: int) -> np.ndarray:
        """Return whether each HAV has hit goal g, from 0: (R,) bool."""
        return self.goal[:, g, HIT_STEP] != NEVER

    def assigned(self, g: int) -> np.ndarray:
        """Return whether goal g was ever under way: (R,) bool."""
        return ~np.isnan(self.goal[:, g, DUBINS])

    def driven(self, g: int) -> np.ndarray:
        """Return the path (R,) from the assignment of goal g to its hit [m]."""
        before = self.goal[:, g - 1, HIT_PATH] if g > 0 else np.zeros(len(self.goal))
        return self.goal[:, g, HIT_PATH] - before

    def misses(self, g: int, kind: int) -> np.ndarray:
        """Return the number of steps (R,) with a close miss of goal g."""
        return self.miss[:, g, kind, MISS_COUNT].astype(np.int64)

    def miss_weight(self, g: int, kind: int) -> np.ndarray:
        """Return the sum (R,) of all joints' jackknife weights at the narrowest close miss."""
        bends = self.miss[:, g, kind, MISS_ARTICULATION:]
        weights = joint_weights(self.policy, np.cos(bends))
        return np.where(self.present, weights, 0.0).sum(axis=1)
