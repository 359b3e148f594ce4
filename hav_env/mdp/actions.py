"""This module checks the actions that users pass to environments: finite numbers of one shape."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from hav_env.models.annotations import show

# kinds of NumPy's types that are numbers: no bool, no complex, no text, no object
REAL_KINDS = "fiu"
_READ_AS_THEY_ARE = np.float32, np.float64
_SHORT_LIST = 64  # numbers up to which a list is looked at in less time than an array


def take_actions(name: str, actions: Any, shape: tuple[int, ...]) -> np.ndarray:
    """Return finite actions that compiled code can read: the user's own array where it can.

    Args:
        name: as of ``read_action``.
        actions: as of ``read_action``.
        shape: as of ``read_action``.

    Returns:
        A contiguous array of float32 or float64, to be read at once and not to be kept.

    Raises:
        TypeError, ValueError: as of ``read_action``.
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
    """Return the numbers of an action of few, one after the other.

    Args:
        name: as of ``read_action``.
        action: as of ``read_action``.
        shape: as of ``read_action``.

    Raises:
        TypeError, ValueError: as of ``read_action``.
    """
    if type(action) is np.ndarray and action.dtype.kind in REAL_KINDS and action.shape == shape:
        numbers = action.ravel().tolist()
        if all(map(math.isfinite, numbers)):
            return numbers
    return read_action(name, action, shape).ravel().tolist()


def read_action(name: str, action: Any, shape: tuple[int, ...]) -> np.ndarray:
    """Return an action, or those of many worlds, as finite float64: a contiguous copy.

    Args:
        name: of the action, for the message: "the action of hav_0".
        action: the user's action: an array, or anything that NumPy turns into one.
        shape: that it must have.

    Raises:
        TypeError: when the action is anything but real numbers.
        ValueError: when its shape is wrong or a number is not finite.
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
    """Tell whether all numbers of an array are finite."""
    if actions.size <= _SHORT_LIST:
        return all(map(math.isfinite, actions.ravel().tolist()))
    return np.count_nonzero(np.isfinite(actions)) == actions.size


def check_mapping(actions: Any) -> None:
    """Raise TypeError unless the actions are a dictionary or another mapping."""
    if type(actions) is not dict and not isinstance(actions, Mapping):
        raise TypeError(f"actions is {show(actions)}, but must be a dictionary: agent to action")


def _array_of(name: str, action: Any) -> np.ndarray:
    """Return what NumPy makes of an action."""
    if _holds_bool(action):  # beside a float, NumPy would make a number of it
        raise TypeError(f"{name} is {show(action)}, but must be real numbers")
    try:
        return np.asarray(action)
    except Exception as error:  # lists of unequal lengths, tensors that NumPy cannot reach
        told = f"{name} is {show(action)}, but must be real numbers: {' '.join(str(error).split())}"
        raise TypeError(told) from None


def _holds_bool(action: Any) -> bool:
    if isinstance(action, list | tuple):
        return any(map(_holds_bool, action))
    return isinstance(action, bool | np.bool_)
