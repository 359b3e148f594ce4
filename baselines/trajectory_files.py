"""Recorded episodes on disk: one compressed NumPy archive each, with a versioned layout."""

import os
import pathlib
import zipfile
from typing import BinaryIO

import numpy as np

from baselines.files import whole_file
from baselines.trajectories import Trajectory
from hav_env.world import NEVER

_KIND, _VERSION = "hav_env trajectory", 1
# of every field: NumPy's kinds of numbers that are allowed, and its shape
_LAYOUT = {
    "step": ("iu", "T"),
    "x": ("f", "TN"),
    "y": ("f", "TN"),
    "heading": ("f", "TNU"),
    "waiting": ("b", "TN"),
    "removed": ("b", "TN"),
    "phase": ("iu", "T"),
    "speed": ("f", "TN"),
    "steering": ("f", "TN"),
    "evaded": ("i", "TN"),
    "num_trailers": ("iu", "N"),
    "length": ("f", "NU"),
    "footprint": ("f", "N"),
    "articulation_max": ("f", "N"),
    "goals": ("f", "NG3"),
    "first": ("i", "N32"),
    "hit_step": ("i", "NG"),
    "dt": ("f", ""),
    "policy": ("U", ""),
    "scenario": ("U", ""),
    "seed": ("iu", ""),
    "episode": ("iu", ""),
}


def save_trajectory(trajectory: Trajectory, path: str | os.PathLike) -> None:
    """Write an episode as an ``.npz`` file, whole or not at all; ``load_trajectory`` reads it."""
    fields: dict = trajectory._asdict()
    # given an open file, NumPy does not add a suffix of its own
    with whole_file(pathlib.Path(path)) as unfinished, unfinished.open("wb") as file:
        np.savez_compressed(file, kind=_KIND, version=_VERSION, **fields)


def load_trajectory(path: str | os.PathLike) -> Trajectory:
    """Read an episode that ``save_trajectory`` wrote.

    Raises:
        ValueError: when the file is broken, cut short, of another kind or of another version.
        OSError: when it cannot be opened.
    """
    with pathlib.Path(path).open("rb") as file:
        try:
            trajectory = _read(file)
            _check(trajectory)
        except Exception as error:  # what is broken may break the reading anywhere
            raise ValueError(f"{path} is not a whole recorded episode: {error}") from None
    return trajectory


def _read(file: BinaryIO) -> Trajectory:
    if not zipfile.is_zipfile(file):
        raise ValueError("no archive, or cut short")
    file.seek(0)
    with np.load(file, allow_pickle=False) as stored:
        if "kind" not in stored or str(stored["kind"]) != _KIND:
            raise ValueError("an archive of another kind")
        if int(stored["version"]) != _VERSION:
            raise ValueError(f"version {stored['version']} of the layout, not {_VERSION}")
        missing = sorted(set(_LAYOUT) - set(stored.files))
        if missing:
            raise ValueError(f"{missing[0]!r} is missing")
        arrays = {name: stored[name] for name in _LAYOUT}
    sizes = {"2": 2, "3": 3}
    for name, (kinds, shape) in _LAYOUT.items():
        array = arrays[name]
        fits = array.dtype.kind in kinds and array.ndim == len(shape)
        # the first array that has an axis says how long it is
        if not fits or any(
            sizes.setdefault(axis, size) != size
            for axis, size in zip(shape, array.shape, strict=True)
        ):
            raise ValueError(f"{name!r} is {array.dtype} of shape {array.shape}")
    return Trajectory(
        **{name: array if array.ndim else array.item() for name, array in arrays.items()}
    )


def _check(trajectory: Trajectory) -> None:
    """Raise ValueError for contents that no episode has."""
    havs, units = trajectory.length.shape
    present = np.arange(units) <= trajectory.num_trailers[:, None]
    events = trajectory.first[:, 0, 1]  # the joints of jackknifes
    others = np.concatenate([trajectory.evaded.ravel(), trajectory.first[:, 1:, 1].ravel()])
    lengths = trajectory.length[present]
    laws = {
        "no state or no HAV": trajectory.x.size and trajectory.goals.size,
        "steps out of order": trajectory.step[0] >= 0 and (np.diff(trajectory.step) > 0).all(),
        "an impossible number of trailers": np.isin(trajectory.num_trailers, range(1, units)).all(),
        "an impossible length": (np.isfinite(lengths) & (lengths > 0)).all(),
        "an impossible duration of a step": np.isfinite(trajectory.dt) and trajectory.dt > 0,
        "an impossible limit": (
            (trajectory.articulation_max > 0) & (trajectory.articulation_max <= np.pi)
        ).all(),
        "a goal that there is not": np.isin(
            trajectory.phase, range(trajectory.goals.shape[1])
        ).all(),
        "a HAV that there is not": ((others >= NEVER) & (others < havs)).all(),
        "a joint that there is not": ((events >= NEVER) & (events < units)).all(),
        "a number that is not finite": all(
            np.isfinite(values).all()
            for values in (
                trajectory.x,
                trajectory.y,
                trajectory.heading[:, present],
                trajectory.footprint,
                trajectory.goals,
            )
        ),
    }
    for complaint, holds in laws.items():
        if not holds:
            raise ValueError(complaint)
