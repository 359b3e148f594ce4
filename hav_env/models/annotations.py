"""This module reads the annotations of models, such as ranges, and shows values in errors.

A model is a NamedTuple or a dataclass of parameters.
"""

import dataclasses
import functools
import numbers
import sys
import typing
from collections.abc import Callable
from typing import Annotated, Any, ForwardRef, NamedTuple

_MOST_SHOWN = 100  # characters of a value in an error


class Range(NamedTuple):
    """The range of a field, bounds included."""

    low: float
    high: float
    unit: str = ""
    said: str = ""
    """The rule in words, where it is not "at least low and at most high"."""

    @property
    def rule(self) -> str:
        """The rule in words."""
        unit = f" {self.unit}" if self.unit else ""
        low, high = (n if isinstance(n, int) else f"{n:.6g}" for n in (self.low, self.high))
        return self.said or f"at least {low}{unit} and at most {high}{unit}"


@functools.cache
def kinds_of(model_class: Any) -> dict[str, Any]:
    """Return the annotations of the fields of a model; ``Any`` for one that cannot be resolved."""
    found: dict[str, Any] = {}
    for part in reversed(model_class.__mro__):
        names = vars(sys.modules.get(part.__module__, typing))
        for field, kind in vars(part).get("__annotations__", {}).items():
            found[field] = _resolve(kind, names)
    return found


def _resolve(kind: Any, names: dict[str, Any]) -> Any:
    """Return an annotation that may be a string, as under ``from __future__``."""
    text = kind.__forward_arg__ if isinstance(kind, ForwardRef) else kind
    if not isinstance(text, str):
        return kind
    try:
        return eval(text, dict(names))
    except Exception:  # a name that exists for type checkers only
        return Any


def split_range(kind: Any) -> tuple[Any, Range | None]:
    """Return an annotation without its range, and the range."""
    if typing.get_origin(kind) is not Annotated:
        return kind, None
    base, *notes = typing.get_args(kind)
    return base, next((note for note in notes if isinstance(note, Range)), None)


def is_model(value: Any) -> bool:
    """Return whether a value is an instance of a NamedTuple or a dataclass."""
    named = hasattr(value, "_asdict") and not isinstance(value, type)
    return named or dataclasses.is_dataclass(type(value))


def values_of(model: Any) -> dict[str, Any]:
    """Return the values of the fields of a model, by name."""
    if hasattr(model, "_asdict"):
        return model._asdict()
    return {field.name: getattr(model, field.name) for field in dataclasses.fields(model)}


def is_number(value: Any) -> bool:
    """Return whether a value is a real number of Python or NumPy; a bool is not."""
    return isinstance(value, numbers.Real) and not isinstance(value, bool)


def show(value: Any, how: Callable[[Any], str] = repr) -> str:
    """Return a value as one short line."""
    try:
        text = " ".join(how(value).split())
    except Exception:  # Python does not print a whole number of 5,000 digits; users' code may fail
        text = f"{with_article(type(value))} that cannot be shown"
    return text if len(text) <= _MOST_SHOWN else f"{text[:_MOST_SHOWN]} ..."


def with_article(kind: type | str) -> str:
    """Return a name, or that of a type, with its article: "an int", "a Task"."""
    name = kind if isinstance(kind, str) else kind.__name__
    return f"{'an' if name[0] in 'AEIOUaeiou' else 'a'} {name}"
