"""A page that replays an episode in a browser: ``replay.html`` with the episode put into it."""

import base64
import importlib.resources
import json
import os
import pathlib

import numpy as np

from baselines.replay.trajectory import Trajectory
from baselines.storage.atomic_files import write_text

_PLACE = "__EPISODE__"  # where the template wants the episode
_TURN = 65_536  # headings are stored as int16, in parts of a full turn: 0.1 mrad, a mm at 10 m


def write_replay(trajectory: Trajectory, path: str | os.PathLike, speed: float = 10.0) -> None:
    """Write one page that needs nothing else and replays an episode.

    Args:
        trajectory: the episode.
        path: of the file, written whole or not at all.
        speed: times real time, to begin with.
    """
    template = importlib.resources.files("baselines.replay").joinpath("web_page.html")
    page = template.read_text(encoding="utf-8")
    # "<" would end the element that holds the data, were a name to contain its end tag
    data = json.dumps(_pack(trajectory, speed), separators=(",", ":")).replace("<", "\\u003c")
    write_text(page.replace(_PLACE, data), pathlib.Path(path))


def _pack(trajectory: Trajectory, speed: float) -> dict:
    """Return the episode as JSON, what changes from state to state as base64 of small numbers."""
    units = np.arange(trajectory.length.shape[1]) <= trajectory.num_trailers[:, None]  # (N, U)
    # 32 bits tell millimetres apart within some kilometres of an origin in the middle
    places = trajectory.x, trajectory.y
    origin = [float(np.round((values.min() + values.max()) / 2)) for values in places]
    turns = trajectory.heading[:, units] / (2.0 * np.pi)  # (T, all units of all HAVs)
    return {
        "policy": trajectory.policy,
        "scenario": trajectory.scenario,
        "seed": trajectory.seed,
        "episode": trajectory.episode,
        "dt": trajectory.dt,
        "speed": speed,
        "origin": origin,
        "lengths": [
            row[present].tolist() for row, present in zip(trajectory.length, units, strict=True)
        ],
        "footprint": trajectory.footprint.tolist(),
        "articulationMax": trajectory.articulation_max.tolist(),
        "goals": (trajectory.goals - [*origin, 0.0]).tolist(),
        "first": trajectory.first.tolist(),
        "hitStep": trajectory.hit_step.tolist(),
        "step": _encode(trajectory.step, "<i4"),
        "phase": _encode(trajectory.phase, "<i2"),
        "x": _encode(np.round(trajectory.x - origin[0], 3), "<f4"),
        "y": _encode(np.round(trajectory.y - origin[1], 3), "<f4"),
        "heading": _encode(np.round((turns - np.round(turns)) * _TURN) % _TURN, "<u2"),
        # nothing is decided in the last state; steering in tenths of milliradians
        "driving": _encode(np.nan_to_num(trajectory.speed), "<f4"),
        "steering": _encode(np.round(np.nan_to_num(trajectory.steering) * 1e4), "<i2"),
        "evaded": _encode(trajectory.evaded, "<i2"),
        "removed": _encode(trajectory.removed, "u1"),
    }


def _encode(values: np.ndarray, kind: str) -> str:
    """Return numbers as base64 of their bytes, row by row."""
    return base64.b64encode(np.ascontiguousarray(values).astype(kind).tobytes()).decode("ascii")
