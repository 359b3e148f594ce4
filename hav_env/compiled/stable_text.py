"""This module writes values as text that is the same in every process, for digests."""

import dataclasses
import functools
import hashlib
from typing import Any

import numpy as np


@functools.singledispatch
def stable_text(value: Any) -> str:
    """Return a value as text; for a value that is neither data nor code, only its type name."""
    if dataclasses.is_dataclass(value):
        return f"{name_of(type(value))}{stable_text(vars(value))}"
    return getattr(value, "__qualname__", None) or name_of(type(value))


@stable_text.register(int | float | complex | bool | str | bytes | type(None))
def _(value: Any) -> str:
    return repr(value)


@stable_text.register(type)
def _(value: type) -> str:
    return f"{name_of(value)}{getattr(value, '_fields', '')}"


@stable_text.register(np.ndarray)
def _(value: np.ndarray) -> str:
    content = hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()
    return f"array {value.dtype} {value.shape} {content}"


@stable_text.register(np.generic)
def _(value: np.generic) -> str:
    return f"{value.dtype} {value.item()!r}"


@stable_text.register(tuple | list)
def _(value: tuple | list) -> str:
    fields = getattr(value, "_fields", None)
    name = name_of(type(value)) if fields else ""
    return f"{name}({', '.join(map(stable_text, value))})"


@stable_text.register(dict)
def _(value: dict) -> str:
    return f"{{{', '.join(f'{stable_text(k)}: {stable_text(v)}' for k, v in value.items())}}}"


@stable_text.register(set | frozenset)
def _(value: set | frozenset) -> str:
    return f"{{{', '.join(sorted(map(stable_text, value)))}}}"


def name_of(kind: type) -> str:
    """Return the full name of a class."""
    return f"{kind.__module__}.{kind.__qualname__}"
