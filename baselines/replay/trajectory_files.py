"""This module saves and loads recorded episodes, one compressed NumPy archive each.

The layout of an archive has a version.
"""

import os
import pathlib
from typing import Any, BinaryIO

import numpy as np

from baselines.replay.trajectory import Trajectory
from baselines.storage.archives import Head, one_line, read_archive
from baselines.storage.atomic_files import whole_file
from hav_env.maths.kdop import SIDES
from hav_env.places.site import MOST_SEGMENTS
from hav_env.world.arrays import NEVER, WHEN, WHERE
from hav_env.world.event_table import EVENTS, events_in

_ARCHIVE_KIND, _VERSION = "hav_env trajectory", 5
_MOST_BYTES_KEPT = 1 << 29  # of an uncompressed archive
_HEADS = 1 << 16  # [bytes], limit of the headers of all arrays
_MOST_METRES = 1e9  # [m], [rad], limit of plausible numbers
_MOST_SECONDS = 1e6  # [s] of an episode
_LONGEST_NAME = 200  # characters
_EVENTS_IN_PLANE = sum(not event.obstacles for event in EVENTS)
# the valid kinds of NumPy's types and the shape of every field
_LAYOUT = {
    "step": ("iu", "T"),
    "x": ("f", "TN"),
    "y": ("f", "TN"),
    "heading": ("f", "TNU"),
    "waiting": ("b", "TN"),
    "removed": ("b", "TN"),
    "phase": ("iu", "TN"),
    "speed": ("f", "TN"),
    "steering": ("f", "TN"),
    "motion": ("f", "TN2"),
    "evaded": ("i", "TN"),
    "reserved": ("i", "TN"),
    "outline": ("f", "KC2"),
    "num_trailers": ("iu", "N"),
    "length": ("f", "NU"),
    "offset": ("f", "NU"),
    "shape": ("f", "NUB"),
    "footprint": ("f", "N"),
    "articulation_max": ("f", "NU"),
    "goals": ("f", "NG3"),
    "segment": ("f", "S4"),
    "first": ("i", "NE2"),
    "hit_step": ("i", "NG"),
    "dt": ("f", ""),
    "max_steps": ("iu", ""),
    "policy": ("U", ""),
    "scenario": ("U", ""),
    "seed": ("iu", ""),
    "episode": ("iu", ""),
}


def save_trajectory(trajectory: Trajectory, path: str | os.PathLike) -> None:
    """Write an episode as an ``.npz`` file, whole or not at all; ``load_trajectory`` reads it.

    Raises:
        ValueError: If the episode is larger than the limit of ``load_trajectory``.
        OSError: If the file cannot be written.
    """
    fields: dict = trajectory._asdict()
    if trajectory.shape is None:
        fields["shape"] = np.zeros((*trajectory.length.shape, 0))
    size = sum(np.asarray(value).nbytes for value in fields.values())
    if size > _MOST_BYTES_KEPT - _HEADS:
        raise ValueError(
            f"the episode has {size:,} bytes, but must have at most {_MOST_BYTES_KEPT - _HEADS:,}:"
            " keep fewer of its states"
        )
    # NumPy adds no suffix to an open file
    with whole_file(pathlib.Path(path)) as unfinished, unfinished.open("wb") as file:
        np.savez_compressed(file, kind=_ARCHIVE_KIND, version=_VERSION, **fields)


def load_trajectory(path: str | os.PathLike) -> Trajectory:
    """Read an episode that ``save_trajectory`` wrote.

    Raises:
        ValueError: If the file is broken, truncated, of another kind or of another version.
        OSError: If the file cannot be opened.
    """
    with pathlib.Path(path).open("rb") as file:
        try:
            trajectory = _read(file)
            _check(trajectory)
        except Exception as error:  # a broken file may raise any error
            raise ValueError(f"{path} is not a whole recorded episode: {one_line(error)}") from None
    return trajectory


def _read(file: BinaryIO) -> Trajectory:
    try:
        told = read_archive(file, {"kind": "U", "version": "i"}, _MOST_BYTES_KEPT)
    except ValueError as error:
        raise ValueError(f"an archive of another kind: {error}") from None
    if told["kind"].item() != _ARCHIVE_KIND:
        raise ValueError("an archive of another kind")
    if told["version"].shape or told["version"] != _VERSION:
        raise ValueError(f"version {told['version']} of the layout, not {_VERSION}")
    kinds = {name: kinds for name, (kinds, _) in _LAYOUT.items()}
    arrays = read_archive(file, kinds, _MOST_BYTES_KEPT, _check_shapes)
    fields: dict[str, Any] = {
        name: array if array.ndim else array.item() for name, array in arrays.items()
    }
    fields["shape"] = fields["shape"] if fields["shape"].shape[-1] else None
    return Trajectory(**fields)


def _check_shapes(heads: dict[str, Head]) -> None:
    """Check, before reading any array, that axes with the same letter have the same length."""
    lines = heads["shape"].shape[-1:] == (0,)
    sizes = {"2": 2, "3": 3, "4": 4, "B": 0 if lines else 3, "C": SIDES}
    if heads["first"].shape[1:2] != (_EVENTS_IN_PLANE,):
        sizes["E"] = len(EVENTS)
    for name, (_, axes) in _LAYOUT.items():
        shape = heads[name].shape
        # the first array with an axis sets its length
        if len(shape) != len(axes) or any(
            sizes.setdefault(axis, size) != size for axis, size in zip(axes, shape, strict=True)
        ):
            raise ValueError(f"{name!r} is {heads[name].dtype} of shape {shape}")


def _check(trajectory: Trajectory) -> None:
    """Check that an episode can have these contents; else raise ValueError."""
    havs, units = trajectory.length.shape
    if not trajectory.x.size or not trajectory.goals.size:
        raise ValueError("no state or no HAV")
    present = np.arange(units) <= trajectory.num_trailers[:, None]
    joints, struck = _places_of(trajectory, "joint"), _places_of(trajectory, "segment")
    others = np.concatenate([trajectory.evaded.ravel(), _places_of(trajectory, "partner")])
    when = np.concatenate([trajectory.hit_step.ravel(), trajectory.first[..., WHEN].ravel()])
    lengths, limits = trajectory.length[present], trajectory.articulation_max[:, 1:][present[:, 1:]]
    bodies = np.zeros(0) if trajectory.shape is None else trajectory.shape[present]
    laws = {
        "steps out of order": trajectory.step[0] >= 0 and (np.diff(trajectory.step) > 0).all(),
        "an impossible number of trailers": (
            (trajectory.num_trailers >= 1) & (trajectory.num_trailers < units)
        ).all(),
        "an impossible length": ((lengths > 0) & (lengths <= _MOST_METRES)).all(),
        "an impossible duration of a step": 0 < trajectory.dt <= _MOST_SECONDS,
        "an impossible duration": trajectory.step[-1] * trajectory.dt <= _MOST_SECONDS,
        "an impossible body": ((bodies >= 0) & (bodies <= _MOST_METRES)).all(),
        "an impossible limit": ((limits > 0) & (limits <= np.pi)).all(),
        "a goal that there is not": (
            (trajectory.phase >= 0) & (trajectory.phase < trajectory.goals.shape[1])
        ).all(),
        "a step that there is not": ((when >= NEVER) & (when <= trajectory.step[-1])).all(),
        "a HAV that there is not": ((others >= NEVER) & (others < havs)).all(),
        "an outline that there is not": (
            (trajectory.reserved >= NEVER) & (trajectory.reserved < len(trajectory.outline))
        ).all(),
        "a limit of time that has passed": trajectory.step[-1] <= trajectory.max_steps,
        "a joint that there is not": ((joints >= NEVER) & (joints < units)).all(),
        "too many obstacles": len(trajectory.segment) <= MOST_SEGMENTS,
        "an obstacle that there is not": (
            (struck >= NEVER) & (struck < len(trajectory.segment))
        ).all(),
        "obstacles without their event": (
            len(trajectory.segment) == 0 or trajectory.first.shape[1] == len(EVENTS)
        ),
        "a number that is too large or not finite": all(
            (np.abs(values) <= _MOST_METRES).all()
            for values in (
                trajectory.x,
                trajectory.y,
                trajectory.heading[:, present],
                trajectory.offset[present],
                trajectory.footprint,
                trajectory.goals,
                trajectory.segment,
                trajectory.outline,
                # the last state has no decisions
                np.nan_to_num(trajectory.speed, posinf=np.inf, neginf=-np.inf),
                np.nan_to_num(trajectory.steering, posinf=np.inf, neginf=-np.inf),
                np.nan_to_num(trajectory.motion, posinf=np.inf, neginf=-np.inf),
            )
        ),
        "a footprint below 0": (trajectory.footprint >= 0).all(),
        "a name that cannot be shown": all(
            name.isprintable() and len(name) <= _LONGEST_NAME
            for name in (trajectory.policy, trajectory.scenario)
        ),
    }
    for complaint, holds in laws.items():
        if not holds:
            raise ValueError(complaint)


def _places_of(trajectory: Trajectory, meaning: str) -> np.ndarray:
    """Return the places of all events whose place has a given meaning, such as "joint"."""
    rows = [event.row for event in events_in(trajectory.first) if event.place == meaning]
    return trajectory.first[:, rows, WHERE].ravel()
