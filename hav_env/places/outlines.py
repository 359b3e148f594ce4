"""This module reads outlines from users and files: rings, chains of points, circles."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from hav_env.models.annotations import is_number, show, split_range
from hav_env.models.quantities import Coordinate

_CIRCLE_SIDES = 16


def read_points(name: str, value: Any) -> np.ndarray:
    """Return the points (P, 2) [m] of a user's outline.

    Args:
        name: name of the outline, for messages.
        value: value that the user passed.

    Raises:
        TypeError: when it is no list of pairs of numbers.
        ValueError: when a number is not within the range of coordinates.
    """
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, str | bytes) or not isinstance(value, Sequence):
        raise TypeError(f"{name} is {show(value)}, but must be a list of points [x, y]")
    for k, point in enumerate(value):
        pair = isinstance(point, Sequence) and not isinstance(point, str | bytes)
        if not pair or len(point) != 2 or not all(map(is_number, point)):
            raise TypeError(f"{name}[{k}] is {show(point)}, but must be a point [x, y]")
        _check_coordinates(f"{name}[{k}]", point)
    return np.array(value, float).reshape(-1, 2)


def read_chain(name: str, value: Any) -> np.ndarray:
    """Return the points (P, 2) [m] of a polygonal chain.

    Args:
        name: name of the chain, for messages.
        value: value that the user passed.

    Raises:
        TypeError: when it is no list of pairs of numbers.
        ValueError: when a number is out of range, or there are not two different points.
    """
    points = read_points(name, value)
    if len(np.unique(points, axis=0)) < 2:
        told = f"{name} is {show(points.tolist())}"
        raise ValueError(f"{told}, but must have at least 2 different points")
    return points


def read_ring(name: str, value: Any) -> np.ndarray:
    """Return the corners (P, 2) [m] of a polygon; the last one repeats the first.

    Args:
        name: name of the ring, for messages.
        value: value that the user passed; its last corner may repeat its first one.

    Raises:
        TypeError: when it is no list of pairs of numbers.
        ValueError: when a number is out of range, or there are not three different corners.
    """
    points = read_points(name, value)
    if len(np.unique(points, axis=0)) < 3:
        told = f"{name} is {show(points.tolist())}"
        raise ValueError(f"{told}, but must have at least 3 different corners")
    return np.concatenate([points, points[:1]])


def read_circle(name: str, value: Any) -> np.ndarray:
    """Return the corners (P, 2) [m] of a polygon of 16 sides that contains a circle.

    Args:
        name: name of the circle, for messages.
        value: x, y and radius.

    Raises:
        TypeError: when it is no list of three numbers.
        ValueError: when a number is out of range.
    """
    if hasattr(value, "tolist"):
        value = value.tolist()
    listed = isinstance(value, Sequence) and not isinstance(value, str | bytes)
    if not listed or len(value) != 3 or not all(map(is_number, value)):
        raise TypeError(f"{name} is {show(value)}, but must be [x, y, radius]")
    _check_coordinates(name, value)
    x, y, radius = map(float, value)
    if not radius > 0.0:
        raise ValueError(f"{name} has radius {show(value[2])}, but must have one above 0 m")
    angle = 2.0 * math.pi * (np.arange(_CIRCLE_SIDES) + 0.5) / _CIRCLE_SIDES
    corner = radius / math.cos(math.pi / _CIRCLE_SIDES)
    points = np.stack([x + corner * np.cos(angle), y + corner * np.sin(angle)], axis=1)
    _check_coordinates(f"{name} has a side of its polygon that", points.ravel().tolist())
    if len(np.unique(points, axis=0)) < _CIRCLE_SIDES:
        raise ValueError(f"{name} is {show(value)}, but must be larger: its corners coincide")
    return np.concatenate([points, points[:1]])


def _check_coordinates(name: str, numbers: Sequence[float]) -> None:
    _, allowed = split_range(Coordinate)
    assert allowed is not None
    for number in numbers:
        if not allowed.low <= number <= allowed.high:
            raise ValueError(f"{name} holds {show(number)}, but must hold numbers {allowed.rule}")
