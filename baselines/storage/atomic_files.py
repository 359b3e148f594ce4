"""This module writes files atomically: complete or not at all."""

import contextlib
import hashlib
import itertools
import json
import os
import pathlib
import re
import sys
from collections.abc import Iterator
from typing import Any, BinaryIO

from baselines.storage.locks import is_at, lock


@contextlib.contextmanager
def whole_file(path: pathlib.Path) -> Iterator[pathlib.Path]:
    """Yield a temporary name in the same folder; rename it to ``path`` if no error occurs.

    It removes leftovers of the same file from killed processes.
    """
    _remove_left(path)
    unfinished, held = _begin(path)
    with held:
        try:
            yield unfinished
            _close_on_windows(held)
            os.replace(unfinished, path)
        except BaseException:  # afterwards the name may be another writer's
            _close_on_windows(held)
            unfinished.unlink(missing_ok=True)
            raise


def _close_on_windows(held: BinaryIO) -> None:
    """Close a file on systems where an open file cannot be renamed or removed."""
    if sys.platform == "win32":
        held.close()


def _begin(path: pathlib.Path) -> tuple[pathlib.Path, BinaryIO]:
    """Make an empty file with a name that no other writer has; it is locked while it is open."""
    for number in itertools.count():
        unfinished = path.with_name(f".{os.getpid()}.{number}.{path.name}")
        try:
            held = unfinished.open("xb")
        except FileExistsError:
            continue
        try:
            mine = lock(held.fileno())
        except OSError:  # without locks, no process removes it either
            mine = True
        if mine and is_at(held.fileno(), unfinished):
            return unfinished, held
        held.close()  # another writer removed it as a leftover before it was locked
    raise AssertionError("numbers end")


def _remove_left(path: pathlib.Path) -> None:
    """Remove unfinished files of this name that no process holds any more.

    A process id is no evidence: it may be in use again, or belong to another machine.
    """
    name = re.compile(r"\.\d+\.(\d+\.)?" + re.escape(path.name))
    with contextlib.suppress(OSError), os.scandir(path.parent) as entries:
        for entry in entries:
            if name.fullmatch(entry.name):
                _remove_unless_held(entry.path)


def _remove_unless_held(path: str) -> None:
    with contextlib.suppress(OSError):
        if sys.platform == "win32":  # Windows refuses while the file is open
            os.unlink(path)
            return
        descriptor = os.open(path, os.O_RDWR)
        try:
            if lock(descriptor) and is_at(descriptor, pathlib.Path(path)):
                os.unlink(path)
        finally:
            os.close(descriptor)


def write_text(text: str, path: pathlib.Path) -> None:
    """Write a text file."""
    with whole_file(path) as unfinished:
        unfinished.write_text(text, encoding="utf-8")


def digest_of(path: pathlib.Path) -> str | None:
    """Return the SHA-256 of a file, in hexadecimal digits; None if there is no such file."""
    if not path.is_file():
        return None
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def read_object(path: pathlib.Path) -> dict[str, Any]:
    """Read a JSON object.

    Raises:
        ValueError: If the file is broken or holds another type.
        OSError: If it cannot be read.
    """
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path} is broken: {error}") from None
    if not isinstance(found, dict):
        raise ValueError(f"{path} is broken: it holds no JSON object")
    return found
