"""This module reads JSON files of bounded size, and rejects duplicate entries."""

import json
import os
from collections.abc import Callable
from typing import Any, TypeVar

from hav_env.models.annotations import show

Made = TypeVar("Made")


def read_json(
    path: str | os.PathLike[str], kind: str, most_bytes: int, make: Callable[[Any], Made]
) -> Made:
    """Return the result of a function of the content of a JSON file.

    The file is in UTF-8, UTF-16 or UTF-32, with a byte order mark or without.

    Args:
        path: path of the file.
        kind: kind of the file, for messages.
        most_bytes: largest size of the file [bytes].
        make: function of the parsed JSON; the messages of its TypeError and ValueError get the name
            of the file.

    Raises:
        ValueError: if the file is wrong; the message names it and the rule. OSError: if the system
            cannot read it.
    """
    with open(path, "rb") as file:
        content = file.read(most_bytes + 1)
    if len(content) > most_bytes:
        raise ValueError(f"{path} has more than {most_bytes} bytes, the most of a {kind} file")
    try:
        data = json.loads(content, object_pairs_hook=_collect)
    except _TwiceError as error:
        raise ValueError(f"{path}: {error}") from None
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path} is not a JSON file: {error}") from None
    try:
        return make(data)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{path}: {error}") from None


class _TwiceError(Exception):
    """An object has a duplicate entry."""


def _collect(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in pairs:
        if name in found:
            raise _TwiceError(f"the entry {show(name)} stands twice in an object")
        found[name] = value
    return found
