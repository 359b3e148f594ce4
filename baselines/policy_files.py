"""Trained policies as files: everything that a policy needs to act, and how it came to be."""

import json
import pathlib
from typing import Any, NamedTuple

import numpy as np

from baselines.files import whole_file
from baselines.network import Network
from hav_env.observation import Observation, name_columns

SUFFIX = ".policy"
_ARRAYS = {"sizes": np.int64, "weights": np.float32, "mean": np.float64, "scale": np.float64}


class Trained(NamedTuple):
    """What a file holds."""

    policy: Network
    about: dict[str, Any]
    """How it came to be, in words and numbers that JSON knows: scenario, arguments of the
    training, versions, learning curve, figures of its evaluation."""


def save_policy(policy: Network, path: pathlib.Path, about: dict[str, Any]) -> None:
    """Write a policy to a file; there is never half a file.

    Raises:
        ValueError: when the name does not end with ``.policy``.
        OSError: when the file cannot be written.
    """
    if path.suffix != SUFFIX:
        raise ValueError(f"{path} must end with {SUFFIX}")
    layout = {
        "actions": ["speed", "steering"],
        "columns": name_columns(policy.observation, policy.max_trailers),
        "observation": policy.observation._asdict(),
        "max_trailers": policy.max_trailers,
        "frame_skip": policy.frame_skip,
        "limit": policy.limit,
    }
    kept: dict[str, Any] = {
        "layout": np.array(json.dumps(layout)),
        "about": np.array(json.dumps(about)),
        **{name: getattr(policy, name).astype(kind) for name, kind in _ARRAYS.items()},
    }
    with whole_file(path) as unfinished, open(unfinished, "wb") as file:
        np.savez_compressed(file, **kept)


def load_policy(path: str | pathlib.Path) -> Network:
    """Return the policy in a file; see ``load_trained``."""
    return load_trained(path).policy


def load_trained(path: str | pathlib.Path) -> Trained:
    """Read a file.

    Raises:
        ValueError: when there is no such file, it is broken, or its policy observes other columns
            than this version of the project offers.
    """
    if not pathlib.Path(path).is_file():
        raise ValueError(f"there is no policy file {path}")
    try:
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as kept:
            arrays = {name: kept[name] for name in _ARRAYS}
            layout, about = (json.loads(str(kept[name])) for name in ("layout", "about"))
        policy = Network(
            arrays["sizes"].astype(np.int64),
            arrays["weights"].astype(np.float64),
            arrays["mean"].astype(np.float64),
            arrays["scale"].astype(np.float64),
            float(layout["limit"]),
            int(layout["frame_skip"]),
            Observation(**layout["observation"]),
            int(layout["max_trailers"]),
        )
        theirs = list(layout["columns"])
        ours = list(name_columns(policy.observation, policy.max_trailers))
    except Exception as error:  # what is broken may break the reading anywhere
        raise ValueError(f"{path} is no policy file, or a broken one: {error}") from None
    if theirs != ours:
        raise ValueError(
            f"{path} observes other columns than this version: {_differ(theirs, ours)}"
        )
    return Trained(policy, about)


def _differ(theirs: list[str], ours: list[str]) -> str:
    """Say in which columns two layouts differ."""
    more, fewer = sorted(set(theirs) - set(ours)), sorted(set(ours) - set(theirs))
    parts = [f"only it has {', '.join(more)}"] * bool(more)
    parts += [f"it lacks {', '.join(fewer)}"] * bool(fewer)
    return "; ".join(parts) or "they stand in another order"
