"""This module reads JSON files that others made: of bounded size, no entry twice in an object."""

import json
import os
from collections.abc import Callable
from typing import Any, TypeVar

from hav_env.models.annotations import show

Made = TypeVar("Made")


def read_json(
    path: str | os.PathLike[str], kind: str, most_bytes: int, make: Callable[[Any], Made]
) -> Made:
    """Return what is made of the content of a JSON file.

    The file is in UTF-8, UTF-16 or UTF-32, with a byte order mark or without.

    Args:
        path: of the file.
        kind: of the file, for messages.
        most_bytes: a larger file is refused.
        make: takes what JSON has made of the file; its TypeError and ValueError are told with the
            file.

    Raises:
        ValueError: naming the file and what is wrong with it; OSError: when it cannot be read.
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
    """An object has an entry twice."""


def _collect(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in pairs:
        if name in found:
            raise _TwiceError(f"the entry {show(name)} stands twice in an object")
        found[name] = value
    return found
