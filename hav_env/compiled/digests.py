"""Which files compiled code comes from, and a digest of them."""

import hashlib
import pathlib
from collections.abc import Callable, Iterable
from typing import Any

import numba

sources: set[pathlib.Path] = set()  # packages and files whose code ends up in compiled loops


def note_sources(function: Callable) -> None:
    """Remember where a function comes from."""
    sources.add(source_of(function))


def source_of(function: Any) -> pathlib.Path:
    """Return the outermost package that a function or kernel belongs to, or its file if in none."""
    path = pathlib.Path(function.__code__.co_filename)
    while (path.parent / "__init__.py").exists():
        path = path.parent
    return path


def source_digest(sources: Iterable[pathlib.Path]) -> str:
    """Return a digest of the code in packages and files, and of Numba's version."""
    digest = hashlib.sha256(numba.__version__.encode())
    for source in sorted(set(sources)):
        for path in sorted(source.rglob("*.py")) if source.is_dir() else [source]:
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
