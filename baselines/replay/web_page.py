"""This module writes a web page that replays an episode: ``page/page.html`` with all its parts."""

import base64
import importlib.resources
import json
import os
import pathlib
from typing import Any

import numpy as np

from baselines.replay.trajectory import Trajectory, chain_points
from baselines.storage.atomic_files import write_text
from hav_env.rendering.colors import DARK_GROUND_PALETTE, PALETTE, PATTERNS, web_color
from hav_env.world.arrays import NEVER
from hav_env.world.event_table import events_in

_STYLE, _SCRIPT, _EPISODE_SLOT = "__STYLE__", "__SCRIPT__", "__EPISODE__"  # slots of the parts
# parts of one function of JavaScript, in order: each part uses definitions of earlier parts
_SCRIPTS = (
    "episode",
    "colors",
    "view",
    "plane",
    "obstacles",
    "bodies",
    "vehicles",
    "chart",
    "panel",
    "controls",
)
_SHOWN_OF_EVENTS = ("place", "state", "happens", "sign", "color", "company", "harm")
_MOST_UNITS_AWAY = 2**15 - 1  # of the offset of an axle: a HAV of 100 m has a resolution of 3 mm


def write_replay(trajectory: Trajectory, path: str | os.PathLike, speed: float = 10.0) -> None:
    """Write a self-contained page that replays an episode.

    Args:
        trajectory: The episode.
        path: Path of the file, written whole or not at all.
        speed: Initial speed over real time.
    """
    # a name with an end tag would end the element of the data, so "<" is escaped
    data = json.dumps(_pack(trajectory, speed), separators=(",", ":")).replace("<", "\\u003c")
    write_text(template().replace(_EPISODE_SLOT, data), pathlib.Path(path))


def template() -> str:
    """Return the page without an episode."""
    folder = importlib.resources.files("baselines.replay").joinpath("page")

    def read(name: str) -> str:
        return folder.joinpath(name).read_text(encoding="utf-8")

    script = "\n".join(read(f"{part}.js") for part in _SCRIPTS)
    return read("page.html").replace(_STYLE, read("style.css")).replace(_SCRIPT, script)


def _pack(trajectory: Trajectory, speed: float) -> dict:
    """Return the episode as JSON; arrays over states become base64 of small numbers."""
    units = np.arange(trajectory.length.shape[1]) <= trajectory.num_trailers[:, None]  # (N, U)

    def of_units(values: np.ndarray) -> list[list]:
        return [row[present].tolist() for row, present in zip(values, units, strict=True)]

    # 32 bits resolve millimetres within some kilometres of an origin in the middle
    places = trajectory.x, trajectory.y
    origin = [float(np.round((values.min() + values.max()) / 2)) for values in places]
    axles, axle_units = _pack_axles(trajectory)
    return {
        "policy": trajectory.policy,
        "scenario": trajectory.scenario,
        "seed": trajectory.seed,
        "episode": trajectory.episode,
        "dt": trajectory.dt,
        "speed": speed,
        "colors": {
            "light": [web_color(color) for color in PALETTE],
            "dark": [web_color(color) for color in DARK_GROUND_PALETTE],
        },
        "patterns": PATTERNS,
        "origin": origin,
        "lengths": of_units(trajectory.length),
        "hitchOffsets": of_units(trajectory.offset),
        "shapes": None if trajectory.shape is None else of_units(trajectory.shape),
        "footprint": trajectory.footprint.tolist(),
        "articulationMax": of_units(trajectory.articulation_max),
        "goals": (trajectory.goals - [*origin, 0.0]).tolist(),
        "segments": _encode(np.round(trajectory.segment - 2 * origin, 3), "<f4"),
        "events": [
            {key: getattr(event, key) for key in _SHOWN_OF_EVENTS}
            for event in events_in(trajectory.first)
        ],
        "first": trajectory.first.tolist(),
        "hitStep": trajectory.hit_step.tolist(),
        "step": _encode(trajectory.step, "<i4"),
        "phase": _encode(trajectory.phase, "<i2"),
        "x": _encode(np.round(trajectory.x - origin[0], 3), "<f4"),
        "y": _encode(np.round(trajectory.y - origin[1], 3), "<f4"),
        "axles": _encode(axles, "<i2"),
        "axleUnit": axle_units,
        # the last state has no decisions; steering in tenths of milliradians
        "driving": _encode(np.nan_to_num(trajectory.motion[..., 0]), "<f4"),
        "steering": _encode(np.round(np.nan_to_num(trajectory.motion[..., 1]) * 1e4), "<i2"),
        "evaded": _encode(trajectory.evaded, "<i2"),
        "removed": _encode(trajectory.removed, "u1"),
        **_pack_outlines(trajectory, origin),
        "maxSteps": trajectory.max_steps,
    }


def _pack_axles(trajectory: Trajectory) -> tuple[np.ndarray, list[float]]:
    """Return the positions of all other axles relative to the trucks' rear axles.

    Returns:
        (T, all units of all HAVs, 2) whole numbers, and the unit of each HAV's numbers [m].
    """
    packed, sizes = [], []
    for hav in range(len(trajectory.length)):
        chain = chain_points(trajectory, hav, slice(None))
        offsets = np.delete(chain - chain[:, 1:2], 1, axis=1)
        sizes.append(float(np.abs(offsets).max()) / _MOST_UNITS_AWAY)
        packed.append(np.round(offsets / sizes[-1]))
    return np.concatenate(packed, axis=1), sizes


def _pack_outlines(trajectory: Trajectory, origin: list[float]) -> dict[str, Any]:
    """Return the outlines that HAVs reserve in the shown states, and their numbers by state."""
    numbers, reserved = np.unique(trajectory.reserved, return_inverse=True)
    reserved = reserved.reshape(trajectory.reserved.shape)
    if numbers[0] == NEVER:
        numbers, reserved = numbers[1:], reserved - 1
    corners = trajectory.outline[numbers] - origin
    unit = float(np.abs(corners).max(initial=0.0)) / _MOST_UNITS_AWAY or 1.0
    return {
        "reserved": _encode(reserved if len(numbers) else np.zeros(0), "<i4"),
        "outlines": _encode(np.round(corners / unit), "<i2"),
        "outlineUnit": unit,
    }


def _encode(values: np.ndarray, kind: str) -> str:
    """Return numbers as base64 of their bytes, row by row."""
    return base64.b64encode(np.ascontiguousarray(values).astype(kind).tobytes()).decode("ascii")
