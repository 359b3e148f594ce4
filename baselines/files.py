"""Files that are written whole or not at all."""

import contextlib
import os
import pathlib
from collections.abc import Iterator


@contextlib.contextmanager
def whole_file(path: pathlib.Path) -> Iterator[pathlib.Path]:
    """Give a temporary name in the same folder; rename it to ``path`` when all went well."""
    unfinished = path.with_name(f".{os.getpid()}.{path.name}")
    try:
        yield unfinished
        os.replace(unfinished, path)
    finally:
        unfinished.unlink(missing_ok=True)


def write_text(text: str, path: pathlib.Path) -> None:
    """Write a text file."""
    with whole_file(path) as unfinished:
        unfinished.write_text(text, encoding="utf-8")
