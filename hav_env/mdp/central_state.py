"""This module writes the state of a whole world as one row, for centralized critics."""

import numpy as np
from gymnasium import spaces

from hav_env.observation.columns import LENGTH_CUT, LENGTH_UNIT
from hav_env.simulator.batch import Batch
from hav_env.world.arrays import ARTICULATION, COSINE, PHASE, SINE, STEP, Fleet, X, Y, is_removed
from hav_env.world.units.parts import Hitches
from hav_env.world.units.reading import limits_in, offsets_in, shapes_in

POSITION_UNIT, MOST_POSITIONS = 100.0, 100.0  # [m]; where positions are cut
_TILE = POSITION_UNIT * MOST_POSITIONS  # [m]


class CentralState:
    """Reads the states of the worlds of a batch.

    Attributes:
        names: of the entries: the clock, then HAV after HAV. Positions are in 100 m from the
            origin, in a world far from it from the nearest point whose coordinates are multiples
            of 10 km; lengths are in 10 m, time in episodes. A HAV that was removed is all zeros.
            Where trailers are hitched, their limits and the bodies of units stand only where the
            vehicle has them.
        space: of the states.
    """

    def __init__(self, batch: Batch) -> None:
        """Read from this batch."""
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
        self.names = ("time", *(f"hav_{k}_{name}" for k in havs for name in own))
        low, high = np.array([_bounds_of(name) for name in self.names], np.float32).T
        self.space = spaces.Box(low.copy(), high.copy(), dtype=np.float32)

    def read(self, w: int = 0) -> np.ndarray:
        """Return the state of a world, (len(names),) float32."""
        batch, worlds = self._batch, self._batch.worlds
        state, goal = worlds.state, worlds.state.goal[..., w]
        # the same for a whole episode, and (0, 0) for worlds that are drawn; as large coordinates
        # float32 and the bounds of the space would keep nothing of where HAVs are
        origin = _TILE * np.rint(worlds.goals[:, :, [X, Y], w].mean(axis=(0, 1)) / _TILE)
        waits, place = state.waiting[:, w], np.stack([state.x[:, w], state.y[:, w]], axis=1)
        cosine, sine = state.cosine[..., w], state.sine[..., w]
        ahead_cosine, ahead_sine = cosine[:, :-1], sine[:, :-1]
        present = np.arange(cosine.shape[1]) <= worlds.fleet.num_trailers[:, w, None]
        num_goals = batch.scenario.num_goals
        rows = np.column_stack(
            [
                np.ones(len(waits)),
                waits,
                (num_goals - goal[:, PHASE] - waits) / num_goals,
                (place - origin) / POSITION_UNIT,
                cosine[:, 0],
                sine[:, 0],
                (goal[:, [X, Y]] - origin) / POSITION_UNIT,
                goal[:, [COSINE, SINE]],
                np.where(present, worlds.fleet.length[..., w] / LENGTH_UNIT, 0.0),
                present[:, 1:] * (cosine[:, 1:] * ahead_cosine + sine[:, 1:] * ahead_sine),
                present[:, 1:] * (sine[:, 1:] * ahead_cosine - cosine[:, 1:] * ahead_sine),
                *_parts_of(worlds.fleet, w, present),
            ]
        )
        rows[is_removed(worlds, slice(None), w)] = 0.0
        time = state.clock[STEP, w] / batch.task.max_steps
        row = np.concatenate([[time], rows.ravel()]).astype(np.float32)
        return row.clip(self.space.low, self.space.high)


_BODY = ("half_width", "front_overhang", "rear_overhang")


def _names_of_parts(fleet: Fleet, most: int) -> list[str]:
    """Return the names of what ``_parts_of`` returns, given the largest number of trailers."""
    names = []
    if isinstance(fleet.joints, Hitches):
        joint = ("hitch_offset", "articulation_limit")
        names += [f"{name}_{j}" for name in joint for j in range(1, most + 1)]
    if shapes_in(fleet, 0) is not None:
        names += [f"{name}_{unit}" for name in _BODY for unit in range(most + 1)]
    return names


def _parts_of(fleet: Fleet, w: int, present: np.ndarray) -> list[np.ndarray]:
    """Return what a world's joints and bodies have, columns of (N, ...); none for the paper's."""
    columns, shapes = [], shapes_in(fleet, w)
    if isinstance(fleet.joints, Hitches):
        columns.append(present[:, 1:] * offsets_in(fleet, w)[:, :-1] / LENGTH_UNIT)
        limits = limits_in(fleet, w, fleet.limit[:, ARTICULATION, w])
        columns.append(present[:, 1:] * limits[:, 1:] / np.pi)
    if shapes is not None:
        columns += [present * shapes[..., k] / LENGTH_UNIT for k in range(len(_BODY))]
    return columns


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
