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
        num_havs: of a world.
        num_goals: G, of a HAV.
        dt: duration of a step [s].
        policy: whose jackknife weights are reported; the paper's for policies without.
        clock: (4, R).
        num_trailers: (R,).
        length: (R, U) [m], 0 beyond the last unit.
        offset: (R, U) how far behind each axle the next trailer is hitched [m], 0 for the last.
        present: (R, U - 1) bool: the HAV has this trailer.
        radius: (R, 2) [m].
        start: (R, 3) start poses.
        goals: (R, G, 3) goal poses.
        first: (R, E, 2) of every event.
        total: (R, 4).
        goal: (R, G, 6).
        miss: (R, G, 2, 3 + U - 1).
    """

    def __init__(self, worlds: World, start: np.ndarray, policy, task: Task) -> None:
        """Arrange the records.

        Args:
            worlds: the batch at the end of its episodes.
            start: (N, 3, W) the start poses.
            policy: whose jackknife weights are reported.
            task: the rules.
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
        """(N, ..., W) -> (W * N, ...)."""
        shape = self._num_worlds * self.num_havs, *values.shape[1:-1]
        # contiguous: NumPy's order of summation, and so the last bit, depends on the layout
        return np.ascontiguousarray(np.moveaxis(values, -1, 0)).reshape(shape)

    @property
    def hav(self) -> np.ndarray:
        """(R,) number of the HAV in its world."""
        return np.tile(np.arange(self.num_havs), self._num_worlds)

    @functools.cached_property
    def vehicle_length(self) -> np.ndarray:
        """(R,) from the front axle to the last one of a straight HAV [m]."""
        return self.length.sum(axis=1) + self.offset.sum(axis=1)

    @functools.cached_property
    def hitch_places(self) -> np.ndarray:
        """(R, U) how far behind a straight HAV's front axle the hitch of each unit is [m]."""
        return np.cumsum(self.length, axis=1) + np.cumsum(self.offset, axis=1)

    @property
    def obstacles(self) -> bool:
        """There are obstacles to collide with."""
        return len(events_in(self.first)) == len(EVENTS)

    def happened(self, event: Event) -> np.ndarray:
        """(R,) bool: the event has happened to the HAV."""
        return happened(self.first, event)

    def joint_of(self, event: Event) -> np.ndarray:
        """(R,) the joint at which an event happened, 1 where it never did."""
        return np.where(self.happened(event), self.first[:, event.row, WHERE], 1)

    @functools.cached_property
    def length_differences(self) -> np.ndarray:
        """(R, U - 1) |l^j - l^{j-1}| at every joint [m], 0 beyond the last."""
        return np.where(self.present, np.abs(np.diff(self.length, axis=1)), 0.0)

    def at_joint(self, values: np.ndarray, joint: np.ndarray) -> np.ndarray:
        """(R,) of values (R, joints) the one of a joint (R,), which counts from 1."""
        return values[np.arange(len(joint)), joint - 1]

    def hit(self, g: int) -> np.ndarray:
        """(R,) bool: the HAV has hit goal g, from 0."""
        return self.goal[:, g, HIT_STEP] != NEVER

    def assigned(self, g: int) -> np.ndarray:
        """(R,) bool: goal g was under way at some time."""
        return ~np.isnan(self.goal[:, g, DUBINS])

    def driven(self, g: int) -> np.ndarray:
        """(R,) path from where goal g was assigned to its hit [m]."""
        before = self.goal[:, g - 1, HIT_PATH] if g > 0 else np.zeros(len(self.goal))
        return self.goal[:, g, HIT_PATH] - before

    def misses(self, g: int, kind: int) -> np.ndarray:
        """(R,) in how many steps the HAV was in a close miss of goal g."""
        return self.miss[:, g, kind, MISS_COUNT].astype(np.int64)

    def miss_weight(self, g: int, kind: int) -> np.ndarray:
        """(R,) sum of the jackknife weights of all joints at the narrowest close miss."""
        bends = self.miss[:, g, kind, MISS_ARTICULATION:]
        weights = joint_weights(self.policy, np.cos(bends))
        return np.where(self.present, weights, 0.0).sum(axis=1)
