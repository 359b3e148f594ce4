"""This module checks the actions that users pass to environments: finite numbers of one shape."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from hav_env.models.annotations import show

# NumPy kinds that count as real numbers: not bool, complex, text or object
REAL_KINDS = "fiu"
_READ_AS_THEY_ARE = np.float32, np.float64
_SHORT_LIST = 64  # most numbers that a loop over a list checks faster than NumPy


def take_actions(name: str, actions: Any, shape: tuple[int, ...]) -> np.ndarray:
    """Return finite actions that compiled code can read, without a copy where possible.

    Args:
        name: See ``read_action``.
        actions: See ``read_action``.
        shape: See ``read_action``.

    Returns:
        A contiguous float32 or float64 array; the caller reads it at once and does not keep it.

    Raises:
        TypeError, ValueError: See ``read_action``.
    """
    legible = (
        type(actions) is np.ndarray
        and actions.dtype in _READ_AS_THEY_ARE
        and actions.flags.carray  # contiguous and aligned
        and actions.shape == shape
        and are_finite(actions)
    )
    return actions if legible else read_action(name, actions, shape)


def list_action(name: str, action: Any, shape: tuple[int, ...]) -> list[float]:
    """Return the few numbers of an action as a flat list.

    Args:
        name: See ``read_action``.
        action: See ``read_action``.
        shape: See ``read_action``.

    Raises:
        TypeError, ValueError: See ``read_action``.
    """
    if type(action) is np.ndarray and action.dtype.kind in REAL_KINDS and action.shape == shape:
        numbers = action.ravel().tolist()
        if are_finite_numbers(numbers):
            return numbers
    return read_action(name, action, shape).ravel().tolist()


def read_action(name: str, action: Any, shape: tuple[int, ...]) -> np.ndarray:
    """Return actions of one or many worlds as a contiguous, finite float64 copy.

    Args:
        name: Name of the action in error messages, such as "the action of hav_0".
        action: Action of the user: an array, or any object that NumPy converts to one.
        shape: Required shape.

    Raises:
        TypeError: If the action does not consist of real numbers.
        ValueError: If its shape is wrong or a number is not finite.
    """
    array = action if type(action) is np.ndarray else _array_of(name, action)
    if array.dtype.kind not in REAL_KINDS:
        raise TypeError(f"{name} is {show(action)}, but must be real numbers")
    if array.shape != shape:
        raise ValueError(f"{name} has shape {array.shape}, but must have {shape}")
    numbers = np.array(array, np.float64, order="C")
    if not are_finite(numbers):
        worst = numbers[~np.isfinite(numbers)][0]
        raise ValueError(f"{name} holds {worst}, but must be finite")
    return numbers


def are_finite(actions: np.ndarray) -> bool:
    """Return whether all numbers of an array are finite."""
    if actions.size <= _SHORT_LIST:
        return are_finite_numbers(actions.ravel().tolist())
    return np.count_nonzero(np.isfinite(actions)) == actions.size


def are_finite_numbers(numbers: list[float]) -> bool:
    """Return whether all numbers of a list are finite; if their sum is, they are."""
    return math.isfinite(sum(numbers)) or all(map(math.isfinite, numbers))


def check_mapping(actions: Any) -> None:
    """Raise TypeError unless the actions are a mapping, such as a dictionary."""
    if type(actions) is not dict and not isinstance(actions, Mapping):
        raise TypeError(f"actions is {show(actions)}, but must be a dictionary: agent to action")


def _array_of(name: str, action: Any) -> np.ndarray:
    """Return an action as the array that NumPy makes of it."""
    if _holds_bool(action):  # NumPy would convert a bool beside a float to a number
        raise TypeError(f"{name} is {show(action)}, but must be real numbers")
    try:
        return np.asarray(action)
    except Exception as error:  # lists of unequal lengths, tensors that NumPy cannot read
        told = f"{name} is {show(action)}, but must be real numbers: {' '.join(str(error).split())}"
        raise TypeError(told) from None


def _holds_bool(action: Any) -> bool:
    if isinstance(action, list | tuple):
        return any(map(_holds_bool, action))
    return isinstance(action, bool | np.bool_)
