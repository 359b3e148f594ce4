"""This module checks the fields of models by their annotations: kinds, ranges, allowed words.

Ranges stand beside the fields, as in ``share: Annotated[float, Range(0.0, 1.0)]``. The module also
checks models from outside the package: their plain numbers must be finite.
"""

import functools
import numbers
import sys
import types
import typing
from typing import Any, Literal

import numpy as np

from hav_env.models.annotations import (
    Range,
    is_model,
    is_number,
    kinds_of,
    show,
    split_range,
    values_of,
    with_article,
)

_WHOLE = Range(-(2**63), 2**63 - 1, said="a whole number of 64 bits")
_REAL = Range(-sys.float_info.max, sys.float_info.max, said="finite")


def check_model(kind: str, model: Any, stub: Any) -> None:
    """Check a model whose type selects a kernel.

    Args:
        kind: kind of model, for the message.
        model: the model.
        stub: the generic kernel with which its type must be registered.

    Raises:
        TypeError: if the type is not registered, or a field has a value of another kind.
        ValueError: if a field is outside its range; the message names its value and the rule.
    """
    if type(model) not in stub.table:
        told = f"{show(model)} is not a {kind}: register its type with {stub.__name__}"
        raise TypeError(told)
    check_fields(kind, model)


def check_fields(kind: str, model: Any) -> None:
    """Check all fields of a model by their annotations, then the relations between them.

    Args:
        kind: kind of model, for the message; for a model in a field, the field's name.
        model: a NamedTuple or a dataclass.

    Raises:
        TypeError: if a field has a value of another kind.
        ValueError: if a field is outside its range; the message names its value and the rule.
    """
    if not is_model(model):
        raise TypeError(f"{kind} is {show(model)}, but must be a NamedTuple")
    model_class: Any = type(model)
    kinds = kinds_of(model_class)
    for field, value in values_of(model).items():
        check_value(f"{kind} {field}".lstrip(), kinds.get(field, Any), value)
    check_relations(model)


@functools.singledispatch
def check_relations(model: Any) -> None:
    """Check the relations between the fields of a model, after the check of each field.

    Models with such relations register a function that raises ValueError.
    """


def require(allowed: bool, kind: str, model: Any, field: str, rule: str) -> None:
    """Raise ValueError, naming the field, its value and the rule, unless the value is allowed.

    Args:
        allowed: whether the value is allowed.
        kind: kind of model, for the message.
        model: a NamedTuple.
        field: name of one of its fields.
        rule: the rule for the value.
    """
    if not allowed:
        raise ValueError(
            f"{kind} {field} is {show(getattr(model, field), str)}, but must be {rule}"
        )


def check_value(name: str, kind: Any, value: Any) -> None:
    """Check one value.

    Args:
        name: name of the argument, for the message.
        kind: an annotation, ``Annotated`` with a range.
        value: value that the user passed.

    Raises:
        TypeError: if the value is of another kind.
        ValueError: if it is outside its range; the message names the argument, its value and the
            rule.
    """
    base, allowed = split_range(kind)
    origin, parts = typing.get_origin(base), typing.get_args(base)
    if base is float:
        _check_number(name, allowed or _REAL, value)
    elif base is int:
        _check_whole(name, allowed or _WHOLE, value)
    elif base is bool:
        _check_flag(name, value)
    elif origin is Literal:
        _check_word(name, parts, value)
    elif origin is np.ndarray or base is np.ndarray:
        _check_array(name, allowed or _REAL, value)
    elif origin in (typing.Union, types.UnionType):
        _check_union(name, parts, value)
    elif origin is tuple and parts[1:] == (Ellipsis,):
        _check_tuple(name, parts[0], value)
    elif base is Any or not isinstance(base, type):
        _check_anything(name, value)
    else:
        _check_instance(name, base, value)


def _check_number(name: str, allowed: Range, value: Any, whole: str = "") -> None:
    if not is_number(value):
        told = f"{name} is {show(value, str)}, {with_article(type(value))} and not a {whole}number"
        raise TypeError(f"{told}, but must be {allowed.rule}")
    # a short float of NumPy fails in a comparison with bounds beyond its own range
    plain = float(value) if isinstance(value, np.floating) else value
    if not allowed.low <= plain <= allowed.high:
        raise ValueError(f"{name} is {show(value, str)}, but must be {allowed.rule}")


def _check_whole(name: str, allowed: Range, value: Any) -> None:
    _check_number(name, allowed, value, "whole ")
    if not isinstance(value, numbers.Integral):
        told = f"{name} is {show(value, str)}, but must be {allowed.rule}"
        raise ValueError(told if allowed is _WHOLE else f"{told}, a whole number")


def _check_flag(name: str, value: Any) -> None:
    if not isinstance(value, bool | np.bool_):
        error = ValueError if is_number(value) else TypeError
        raise error(f"{name} is {show(value)}, but must be True or False")


def _check_word(name: str, words: tuple, value: Any) -> None:
    if not any(isinstance(value, type(word)) and value == word for word in words):
        raise ValueError(f"{name} is {show(value)}, but must be {' or '.join(map(str, words))}")


def _check_array(name: str, allowed: Range, value: Any) -> None:
    if not isinstance(value, np.ndarray) or value.dtype.kind not in "iuf":
        told = f"{name} is {show(value, str)}, {with_article(type(value))}"
        raise TypeError(f"{told}, but must be an array of real numbers")
    if allowed.low == -np.inf and allowed.high == np.inf:  # the model checks each by itself
        return
    with np.errstate(over="ignore"):
        plain = value.astype(np.float64)
    outside = value[~((plain >= allowed.low) & (plain <= allowed.high))]
    if outside.size:
        told = f"{name} is {show(value, str)}, which holds {outside[0]}"
        raise ValueError(f"{told}, but must be {allowed.rule}")


def _check_union(name: str, kinds: tuple, value: Any) -> None:
    if value is None and type(None) in kinds:
        return
    *others, last = [kind for kind in kinds if kind is not type(None)]
    models = [kind for kind in kinds if hasattr(kind, "_fields")]
    if len(models) == len(kinds):  # the check of the value's own kind names the mistake
        for model in models:
            if isinstance(value, model):
                return check_value(name, model, value)
        allowed = " or ".join(map(with_article, models))
        raise TypeError(f"{name} is {show(value)}, but must be {allowed}")
    for kind in others:
        try:
            return check_value(name, kind, value)
        except (TypeError, ValueError):
            continue
    check_value(name, last, value)


def _check_tuple(name: str, kind: Any, value: Any) -> None:
    if not isinstance(value, tuple):
        raise TypeError(f"{name} is {show(value)}, but must be a tuple")
    for part in value:
        try:
            check_value("a part of it", kind, part)
        except (TypeError, ValueError) as error:
            raise type(error)(f"{name} is {show(value)}: {error}") from None


def _check_instance(name: str, base: type, value: Any) -> None:
    if not isinstance(value, base):
        raise TypeError(f"{name} is {show(value)}, but must be {with_article(base)}")
    if is_model(value):
        check_fields(name.rpartition(" ")[2], value)


def _check_anything(name: str, value: Any) -> None:
    """Check a value without an annotation: numbers must be finite."""
    if is_model(value):
        check_fields(name.rpartition(" ")[2], value)
    elif isinstance(value, np.ndarray):
        _check_array(name, _REAL, value)
    elif is_number(value):
        _check_number(name, _WHOLE if isinstance(value, numbers.Integral) else _REAL, value)
