"""This module saves and loads trained policies: weights, normalizer, settings and provenance."""

import json
import pathlib
from typing import Any, NamedTuple

import numpy as np

from baselines.policies.network import (
    MOST_COLUMNS,
    MOST_OBSERVED_TRAILERS,
    Network,
    check_network,
    count_columns,
    find_inputs,
    input_names,
)
from baselines.storage.archives import MOST_TEXT, one_line, read_archive
from baselines.storage.atomic_files import whole_file
from hav_env.observation import Observation, check_observation

SUFFIX = ".policy"
_KINDS = {"sizes": "i", "weights": "f", "mean": "f", "scale": "f", "layout": "U", "about": "U"}
_MOST_POLICY_BYTES = 1 << 26  # unpacked
_MOST_NAMED = 8  # columns in a message
_MOST_HELD = 1_000_000  # steps that an action is held
_ARRAYS = {"sizes": np.int64, "weights": np.float32, "mean": np.float64, "scale": np.float64}
_TRAINED_ON = "hitched", "rectangles"  # what vehicles had; without a word, the paper's


class Trained(NamedTuple):
    """The content of a policy file."""

    policy: Network
    about: dict[str, Any]
    """Its origin, in words and numbers that JSON knows: scenario, arguments of the
    training, versions, learning curve, figures of its evaluation."""


def save_policy(policy: Network, path: pathlib.Path, about: dict[str, Any]) -> None:
    """Write a policy to a file; there is never half a file.

    Raises:
        ValueError: when the name does not end with ``.policy``, or the policy is none that
            ``load_trained`` reads.
        OSError: when the file cannot be written.
    """
    if path.suffix != SUFFIX:
        raise ValueError(f"{path} must end with {SUFFIX}")
    check_network(policy)
    layout = {
        "actions": ["speed", "steering"],
        "columns": input_names(policy),
        "observation": policy.observation._asdict(),
        "max_trailers": policy.max_trailers,
        "frame_skip": policy.frame_skip,
        "limit": policy.limit,
        **{name: getattr(policy, name) for name in _TRAINED_ON},
    }
    told = {"layout": json.dumps(layout), "about": json.dumps(about)}
    for name, text in told.items():
        if len(text) > MOST_TEXT:
            rule = f"but must have at most {MOST_TEXT:,}"
            raise ValueError(f"{name} has {len(text):,} characters, {rule}")
    kept: dict[str, Any] = {
        **{name: np.array(text) for name, text in told.items()},
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
        ValueError: when there is no such file, it is broken, or its policy reads columns that this
            version of the project does not have.
    """
    try:
        found = pathlib.Path(path).is_file()
    except OSError as error:  # the name is too long
        raise ValueError(f"there is no policy file {path!s:.80}: {error.strerror}") from None
    if not found:
        raise ValueError(f"there is no policy file {path}")
    try:
        with open(path, "rb") as file:
            arrays = read_archive(file, _KINDS, _MOST_POLICY_BYTES)
        layout, about = (json.loads(arrays[name].item()) for name in ("layout", "about"))
        if not isinstance(about, dict):
            raise ValueError(f"about is {type(about).__name__}, but must be an object")
        observation = _read_observation(layout["observation"])
        max_trailers = _whole(layout, "max_trailers", MOST_OBSERVED_TRAILERS)
        count_columns(observation, max_trailers)
        inputs, missing = find_inputs(_read_names(layout), observation, max_trailers)
        policy = Network(
            arrays["sizes"].astype(np.int64),
            arrays["weights"].astype(np.float64),
            arrays["mean"].astype(np.float64),
            arrays["scale"].astype(np.float64),
            _real(layout, "limit"),
            _whole(layout, "frame_skip", _MOST_HELD),
            observation,
            max_trailers,
            inputs,
            *(_flag(layout, name) for name in _TRAINED_ON),
        )
        check_network(policy)
    except Exception as error:  # what is broken may break the reading anywhere
        raise ValueError(f"{path} is no policy file, or a broken one: {one_line(error)}") from None
    if missing:
        raise ValueError(f"{path} observes what this version does not: {_list(missing)}")
    return Trained(policy, about)


def _read_observation(told: dict[str, Any]) -> Observation:
    observation = Observation(**told)
    for name, usual in Observation()._asdict().items():
        value = getattr(observation, name)
        if type(value) is not type(usual):
            rule = f"but must be of type {type(usual).__name__}"
            raise ValueError(f"observation {name} is {value!r:.40}, {rule}")
    check_observation(observation)
    return observation


def _whole(layout: dict[str, Any], name: str, most: int) -> int:
    value = layout[name]
    if type(value) is not int or not 0 <= value <= most:
        raise ValueError(f"{name} is {value!r:.40}, but must be a whole number from 0 to {most}")
    return value


def _flag(layout: dict[str, Any], name: str) -> bool:
    value = layout.get(name, False)
    if type(value) is not bool:
        raise ValueError(f"{name} is {value!r:.40}, but must be true or false")
    return value


def _real(layout: dict[str, Any], name: str) -> float:
    value = layout[name]
    if type(value) not in (int, float):
        raise ValueError(f"{name} is {value!r:.40}, but must be a number")
    return float(value)


def _read_names(layout: dict[str, Any]) -> list[str]:
    """Return the names of the columns that a policy reads."""
    names = layout["columns"]
    if not isinstance(names, list) or not all(
        isinstance(name, str) and name.isidentifier() for name in names
    ):
        raise ValueError("columns must be a list of names")
    if not 0 < len(set(names)) == len(names) <= MOST_COLUMNS:
        raise ValueError(f"columns must be 1 to {MOST_COLUMNS} names, each once")
    return names


def _list(names: list[str]) -> str:
    told = ", ".join(name[:40] for name in names[:_MOST_NAMED])
    return told + f" and {len(names) - _MOST_NAMED} more" * (len(names) > _MOST_NAMED)
