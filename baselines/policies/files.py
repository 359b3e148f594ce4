"""This module saves and loads trained policies: weights, normalizer, settings and provenance."""

import json
import pathlib
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from baselines.policies.network import Network, find_inputs, input_names
from baselines.policies.network_checks import (
    MOST_COLUMNS,
    MOST_OBSERVED_TRAILERS,
    check_network,
    count_columns,
    split_columns,
)
from baselines.policies.pooling import Encoder, NoPooling
from baselines.policies.reserve import Reserve
from baselines.storage.archives import MOST_TEXT, one_line, read_archive
from baselines.storage.atomic_files import whole_file
from hav_env.observation import Observation, check_observation, name_columns
from hav_env.policies.backup import NoBackup
from hav_env.policies.filtered import Filtered
from hav_env.safety import SAFETY, Unfiltered, make_safety
from hav_env.simulator.guiding import GUIDANCES

SUFFIX = ".policy"
BACKUPS = {"reserve": Reserve}
"""The policies that can be the backup of a policy file, by name."""
_KINDS = {"sizes": "i", "weights": "f", "mean": "f", "scale": "f", "layout": "U", "about": "U"}
_MOST_POLICY_BYTES = 1 << 26  # of an uncompressed archive
_MOST_NAMED = 8  # columns that a message lists
_MOST_HELD = 1_000_000  # steps that an action is held
_ARRAYS = {"sizes": np.int64, "weights": np.float32, "mean": np.float64, "scale": np.float64}
_ENCODED = {f"encoder_{name}": kind for name, kind in _KINDS.items() if name in _ARRAYS}


class Trained(NamedTuple):
    """The content of a policy file."""

    policy: Network
    about: dict[str, Any]
    """Origin of the policy, as values for JSON: scenario, arguments of the training, versions,
    learning curve, figures of its evaluation."""
    safety: str | None
    """Events that the safety filter prevented in training, one of ``hav_env.safety.SAFETY``; None
    without a filter."""
    backup: str | None
    """Name of the backup behind the policy in training, one of ``BACKUPS``; None without one."""


def save_policy(
    policy: Network,
    path: pathlib.Path,
    about: dict[str, Any],
    safety: str | None = None,
    backup: str | None = None,
) -> None:
    """Write a policy to a file, whole or not at all.

    Args:
        policy: The policy, without its filter.
        path: Path of the file.
        about: Origin of the policy.
        safety: Events that its filter prevents; None without a filter.
        backup: Name of the backup behind it; None without one.

    Raises:
        ValueError: If the name does not end with ``.policy``, or ``load_trained`` would reject the
            policy.
        OSError: If the file cannot be written.
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
        "hitched": policy.hitched,
        "rectangles": policy.rectangles,
        "guidance": policy.guidance,
        "safety": safety,
        "backup": backup,
    }
    pooling = policy.pooling
    if isinstance(pooling, Encoder):
        names = split_columns(policy.observation, policy.max_trailers)[1]
        layout["encoder"] = {"columns": [names[k] for k in pooling.inputs]}
    told = {"layout": json.dumps(layout), "about": json.dumps(about)}
    for name, text in told.items():
        if len(text) > MOST_TEXT:
            rule = f"but must have at most {MOST_TEXT:,}"
            raise ValueError(f"{name} has {len(text):,} characters, {rule}")
    kept: dict[str, Any] = {
        **{name: np.array(text) for name, text in told.items()},
        **{name: getattr(policy, name).astype(kind) for name, kind in _ARRAYS.items()},
    }
    if isinstance(pooling, Encoder):
        arrays = {name: getattr(pooling, name).astype(kind) for name, kind in _ARRAYS.items()}
        kept |= {f"encoder_{name}": array for name, array in arrays.items()}
    with whole_file(path) as unfinished, open(unfinished, "wb") as file:
        np.savez_compressed(file, **kept)


def load_policy(path: str | pathlib.Path) -> Network | Filtered:
    """Return the policy in a file, with its safety filter and backup; see ``load_trained``."""
    trained = load_trained(path)
    safety = make_safety(trained.safety)
    backup = BACKUPS[trained.backup]() if trained.backup else NoBackup()
    if isinstance(safety, Unfiltered) and isinstance(backup, NoBackup):
        return trained.policy
    return Filtered(trained.policy, safety, backup=backup)


def load_trained(path: str | pathlib.Path) -> Trained:
    """Read a policy file.

    Raises:
        ValueError: If there is no such file, it is broken, or its policy reads columns that this
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
        columns = name_columns(observation, max_trailers)
        pooling: NoPooling | Encoder = NoPooling()
        missing: list[str] = []
        if "encoder" in layout:
            columns, each = split_columns(observation, max_trailers)
            limit, names = _real(layout, "limit"), _read_names(layout["encoder"])
            pooling, missing = _read_encoder(path, names, columns, each, limit)
        inputs, more = find_inputs(_read_names(layout), columns)
        missing = more + missing
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
            hitched=_flag(layout, "hitched"),
            rectangles=_flag(layout, "rectangles"),
            guidance=_word(layout, "guidance", GUIDANCES.names()) or "",
            pooling=pooling,
        )
        safety = _word(layout, "safety", SAFETY)
        backup = _word(layout, "backup", BACKUPS)
        check_network(policy)
    except Exception as error:  # a broken file may raise any error
        raise ValueError(f"{path} is no policy file, or a broken one: {one_line(error)}") from None
    if missing:
        raise ValueError(f"{path} observes what this version does not: {_list(missing)}")
    return Trained(policy, about, safety, backup)


def _read_encoder(
    path: str | pathlib.Path,
    names: list[str],
    own: tuple[str, ...],
    each: tuple[str, ...],
    limit: float,
) -> tuple[Encoder, list[str]]:
    """Return the encoder in a policy file, and the columns that no neighbour has."""
    with open(path, "rb") as file:
        arrays = read_archive(file, _ENCODED, _MOST_POLICY_BYTES)
    sizes = arrays["encoder_sizes"].astype(np.int64)
    real = ("weights", "mean", "scale")
    weights, mean, scale = (arrays[f"encoder_{name}"].astype(np.float64) for name in real)
    places = {name: k for k, name in enumerate(each)}
    inputs = np.array([places.get(name, 0) for name in names], np.int64)
    missing = [f"neighbor_{name}" for name in names if name not in places]
    return Encoder(sizes, weights, mean, scale, limit, inputs, len(own), len(each)), missing


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
    """Return a flag, False if the file has none: then the training had the paper's vehicles."""
    value = layout.get(name, False)
    if type(value) is not bool:
        raise ValueError(f"{name} is {value!r:.40}, but must be true or false")
    return value


def _word(layout: dict[str, Any], name: str, known: Iterable[str]) -> str | None:
    """Return one of several words, None if the file has none."""
    value = layout.get(name) or None
    if value is not None and value not in known:
        raise ValueError(f"{name} is {value!r:.40}, but must be one of {', '.join(known)}")
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
