"""This module interpolates the scene of an episode between the recorded states."""

import math

import numpy as np

from baselines.replay.trajectory import Trajectory
from hav_env.rendering.scene import Scene, find_potential, struck_in
from hav_env.world.arrays import NEVER, WHEN


def scene_at(trajectory: Trajectory, time: float) -> Scene:
    """Return the scene at a time [s] of the episode, by linear interpolation of the motion."""
    moments = trajectory.step * trajectory.dt
    row = int(np.clip(np.searchsorted(moments, time, "right") - 1, 0, len(moments) - 1))
    after = min(row + 1, len(moments) - 1)
    span = moments[after] - moments[row]
    share = float(np.clip((time - moments[row]) / span, 0.0, 1.0)) if span else 0.0

    def between(values: np.ndarray) -> np.ndarray:
        return values[row] + share * (values[after] - values[row])

    def has_happened(steps: np.ndarray) -> np.ndarray:
        return (steps != NEVER) & (steps * trajectory.dt <= time + 1e-9)

    happened = has_happened(trajectory.first[..., WHEN])
    x, y = between(trajectory.x), between(trajectory.y)
    phase = trajectory.phase[row]
    removed = trajectory.removed[row]
    return Scene(
        time=time,
        phase=phase,
        x=x,
        y=y,
        heading=between(trajectory.heading),
        # the last state has no decisions
        speed=np.nan_to_num(trajectory.motion[row, :, 0]),
        steering=np.nan_to_num(trajectory.motion[row, :, 1]),
        num_trailers=trajectory.num_trailers,
        length=trajectory.length,
        offset=trajectory.offset,
        shape=trajectory.shape,
        footprint=trajectory.footprint,
        articulation_max=trajectory.articulation_max,
        goal=trajectory.goals[np.arange(len(phase)), phase],
        hits=has_happened(trajectory.hit_step).sum(axis=1),
        num_goals=trajectory.goals.shape[1],
        waiting=trajectory.waiting[row],
        removed=removed,
        happened=happened,
        potential=find_potential(x, y, trajectory.footprint, ~removed),
        evaded=trajectory.evaded[row],
        command=np.nan_to_num(np.stack([trajectory.speed[row], trajectory.steering[row]], axis=1)),
        segment=trajectory.segment,
        reserved=_reserved_at(trajectory, row),
        struck=struck_in(np.where(happened[..., None], trajectory.first, NEVER)),
    )


def _reserved_at(trajectory: Trajectory, row: int) -> np.ndarray | None:
    """Return the reserved areas, (N, 24, 2) with nan for none; None if no HAV ever has one."""
    if not len(trajectory.outline):
        return None
    numbers = trajectory.reserved[row]
    return np.where((numbers == NEVER)[:, None, None], np.nan, trajectory.outline[numbers])


def frame_times(trajectory: Trajectory, speed: float, fps: int) -> np.ndarray:
    """Return the time [s] of every frame of a film at a speed, including the last state."""
    first, last = trajectory.step[[0, -1]] * trajectory.dt
    # rounding must not add a frame
    count = math.ceil((last - first) * fps / speed - 1e-6) + 1
    return np.minimum(first + np.arange(count) * speed / fps, last)
