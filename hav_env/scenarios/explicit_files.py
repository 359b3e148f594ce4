"""This module reads a scenario that is written down from a JSON file."""

import json
import os
from typing import Any

from hav_env.models.annotations import show
from hav_env.scenarios.explicit import Explicit, explicit

_MOST_BYTES = 2**26  # a swarm of 10,000 HAVs with 100 goals each
_LIMIT_NAMES = ("speed_max", "steering_max", "articulation_max", "footprint_truck_share")


def load_explicit(path: str | os.PathLike[str]) -> Explicit:
    """Read a scenario from a JSON file (examples/two_havs.json shows the form).

    The file is in UTF-8, UTF-16 or UTF-32, with a byte order mark or without.

    Raises:
        ValueError: when the file is no such scenario, naming file and entry; OSError: when it
            cannot be read.
    """
    with open(path, "rb") as file:
        content = file.read(_MOST_BYTES + 1)
    if len(content) > _MOST_BYTES:
        raise ValueError(f"{path} has more than {_MOST_BYTES} bytes, the most of a scenario file")
    try:
        data = json.loads(content, object_pairs_hook=_collect)
    except _TwiceError as error:
        raise ValueError(f"{path}: {error}") from None
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path} is not a JSON file: {error}") from None
    try:
        return _from_json(data)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{path}: {error}") from None


class _TwiceError(Exception):
    """An object has an entry twice."""


def _collect(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in pairs:
        if name in found:
            raise _TwiceError(f"the entry {show(name)} stands twice in an object")
        found[name] = value
    return found


def _from_json(data: Any) -> Explicit:
    if not isinstance(data, dict) or not isinstance(data.get("havs"), list):
        raise ValueError('a scenario is an object with a list "havs"')
    limits = {name: data[name] for name in data if name != "havs"}
    unknown = sorted(set(limits) - set(_LIMIT_NAMES))
    if unknown:
        known = ", ".join(("havs", *_LIMIT_NAMES))
        raise ValueError(f"unknown entry {show(unknown[0])}; known: {known}")
    columns: dict[str, list] = {"lengths": [], "start": [], "goals": []}
    for agent, hav in enumerate(data["havs"]):
        if not isinstance(hav, dict) or set(hav) != set(columns):
            raise ValueError(f'HAV {agent} must have "lengths", "start" and "goals", and no more')
        for name, column in columns.items():
            column.append(hav[name])
    return explicit(columns["lengths"], columns["start"], columns["goals"], **limits)
