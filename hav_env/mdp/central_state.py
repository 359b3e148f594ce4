"""This module writes the state of a whole world as one row, for centralised critics."""

from typing import Any

import numpy as np
from gymnasium import spaces

from hav_env.observation.columns import LENGTH_CUT, LENGTH_UNIT
from hav_env.simulator.batch import Batch
from hav_env.world.arrays import ARTICULATION, COSINE, PHASE, SINE, STEP, Fleet, X, Y, is_removed
from hav_env.world.place.reading import segments_in
from hav_env.world.place.segments import Obstacles
from hav_env.world.units.parts import Hitches
from hav_env.world.units.reading import limits_in, offsets_in, shapes_in

POSITION_UNIT, MOST_POSITIONS = 100.0, 100.0  # unit [m]; positions are clipped at so many units
_TILE = POSITION_UNIT * MOST_POSITIONS  # [m]


class CentralState:
    """Reads the states of the worlds of a batch.

    Attributes:
        names: Names of the entries: the clock, then one HAV after another. Positions are in units
            of 100 m from the origin. In a world far from the origin, they are relative to the
            nearest point whose coordinates are multiples of 10 km. Lengths are in units of 10 m,
            times in episode lengths. A HAV that was removed is all zeros. Hitch offsets, joint
            limits and bodies of units are listed only if the vehicle has them. If the world has
            obstacles, all segments follow, with both ends, and their number as a share of the
            largest number. Entries after the last segment are 0.
        space: Space of the states.
    """

    def __init__(self, batch: Batch) -> None:
        """Read states from this batch."""
        self._batch = batch
        most = batch.scenario.max_trailers
        joints = range(1, most + 1)
        own = [
            *("present", "waits", "goals_left", "x", "y", "heading_cosine", "heading_sine"),
            *("goal_x", "goal_y", "goal_heading_cosine", "goal_heading_sine"),
            *(f"length_{unit}" for unit in range(most + 1)),
            *(f"articulation_{part}_{j}" for part in ("cosine", "sine") for j in joints),
            *_names_of_parts(batch.worlds.fleet, most),
        ]
        havs = range(batch.scenario.num_havs)
        self.names = (
            "time",
            *(f"hav_{k}_{name}" for k in havs for name in own),
            *_names_of_place(batch.worlds.place),
        )
        low, high = np.array([_bounds_of(name) for name in self.names], np.float32).T
        self.space = spaces.Box(low.copy(), high.copy(), dtype=np.float32)

    def read(self, w: int = 0) -> np.ndarray:
        """Return the state of a world, (len(names),) float32."""
        return self.read_worlds(slice(w, w + 1))[0]

    def read_worlds(self, chosen: slice = slice(None)) -> np.ndarray:
        """Return the states of worlds, all by default: (W, len(names)) float32."""
        batch, worlds = self._batch, self._batch.worlds
        state, goal = worlds.state, worlds.state.goal[..., chosen]
        # constant in an episode, and (0, 0) for worlds that are drawn. At large coordinates,
        # float32 and the bounds of the space would lose the positions of HAVs
        aims = worlds.goals[:, :, [X, Y]][..., chosen]
        origin = _TILE * np.rint(aims.mean(axis=(0, 1)) / _TILE)
        waits = state.waiting[:, None, chosen]
        place = np.stack([state.x[:, chosen], state.y[:, chosen]], axis=1)
        cosine, sine = state.cosine[..., chosen], state.sine[..., chosen]
        ahead_cosine, ahead_sine = cosine[:, :-1], sine[:, :-1]
        units = np.arange(cosine.shape[1])[:, None]
        present = units <= worlds.fleet.num_trailers[:, None, chosen]
        num_goals = batch.scenario.num_goals
        rows = np.concatenate(
            [
                np.ones(waits.shape),
                waits,
                (num_goals - goal[:, PHASE, None] - waits) / num_goals,
                (place - origin) / POSITION_UNIT,
                cosine[:, :1],
                sine[:, :1],
                (goal[:, [X, Y]] - origin) / POSITION_UNIT,
                goal[:, [COSINE, SINE]],
                np.where(present, worlds.fleet.length[..., chosen] / LENGTH_UNIT, 0.0),
                present[:, 1:] * (cosine[:, 1:] * ahead_cosine + sine[:, 1:] * ahead_sine),
                present[:, 1:] * (sine[:, 1:] * ahead_cosine - cosine[:, 1:] * ahead_sine),
                *_parts_of(worlds.fleet, chosen, present),
            ],
            axis=1,
        )
        removed = is_removed(worlds, slice(None), chosen)
        rows = np.where(removed[:, None], 0.0, rows)  # (N, columns, W)
        time = state.clock[STEP, None, chosen] / batch.task.max_steps
        columns = rows.reshape(len(rows) * rows.shape[1], rows.shape[2])
        segments = _numbers_of_place(worlds.place, chosen, origin)
        states = np.concatenate([time, columns, segments]).T.astype(np.float32, order="C")
        return states.clip(self.space.low, self.space.high)


_BODY = ("half_width", "front_overhang", "rear_overhang")


def _names_of_parts(fleet: Fleet, most: int) -> list[str]:
    """Return the names of the entries of ``_parts_of``, given the largest number of trailers."""
    names = []
    if isinstance(fleet.joints, Hitches):
        joint = ("hitch_offset", "articulation_limit")
        names += [f"{name}_{j}" for name in joint for j in range(1, most + 1)]
    if shapes_in(fleet, 0) is not None:
        names += [f"{name}_{unit}" for name in _BODY for unit in range(most + 1)]
    return names


def _parts_of(fleet: Fleet, chosen: slice, present: np.ndarray) -> list[np.ndarray]:
    """Return joints and bodies of worlds, (N, ..., W); none for the paper's model."""
    columns, shapes = [], shapes_in(fleet, chosen)
    if isinstance(fleet.joints, Hitches):
        columns.append(present[:, 1:] * offsets_in(fleet, chosen)[:, :-1] / LENGTH_UNIT)
        limits = limits_in(fleet, chosen, fleet.limit[:, ARTICULATION, chosen])
        columns.append(present[:, 1:] * limits[:, 1:] / np.pi)
    if shapes is not None:
        columns += [present * shapes[:, :, k] / LENGTH_UNIT for k in range(len(_BODY))]
    return columns


_ENDS = ("start_x", "start_y", "end_x", "end_y")


def _names_of_place(place: Any) -> list[str]:
    """Return the names of the entries of ``_numbers_of_place``; none in a plane."""
    if not isinstance(place, Obstacles):
        return []
    room = range(place.segment.shape[0])
    return [*(f"segment_{k}_{name}" for k in room for name in _ENDS), "segments_share"]


def _numbers_of_place(place: Any, chosen: slice, origin: np.ndarray) -> np.ndarray:
    """Return the ends of all segments relative to origins (2, W) [m], and their share."""
    if not isinstance(place, Obstacles):
        return np.empty((0, origin.shape[1]))
    room, places = place.segment.shape[0], range(*chosen.indices(place.segment.shape[2]))
    numbers = np.zeros((room * len(_ENDS) + 1, len(places)))
    for k, w in enumerate(places):
        ends = segments_in(place, w)
        numbers[: ends.size, k] = (ends - np.tile(origin[:, k], 2)).ravel() / POSITION_UNIT
        numbers[-1, k] = len(ends) / room
    return numbers


def _bounds_of(name: str) -> tuple[float, float]:
    if "hitch_offset" in name:
        return -LENGTH_CUT, LENGTH_CUT
    if any(part in name for part in _BODY):
        return 0.0, LENGTH_CUT
    if name.endswith(("_x", "_y")):
        return -MOST_POSITIONS, MOST_POSITIONS
    if "length" in name:
        return 0.0, LENGTH_CUT
    return (-1.0 if "cosine" in name or "sine" in name else 0.0), 1.0
