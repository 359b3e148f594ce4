"""This module checks the numbers of explicit scenarios: lists, lengths, poses."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from hav_env.models.annotations import is_number, show, split_range, with_article
from hav_env.models.quantities import Coordinate, Heading, Length

_POSE_PARTS = {"x": Coordinate, "y": Coordinate, "heading": Heading}


def read_numbers(name: str, value: Any, depth: int) -> list:
    """Return nested lists of numbers; arrays and other sequences become lists.

    Args:
        name: name of the argument, for the message.
        value: value that the user passed.
        depth: nesting depth of the numbers.

    Raises:
        TypeError: if a value is no list or no number; the message names it.
        ValueError: if a number exceeds the range of a float.
    """
    value = read_list(value, name)
    if depth > 1:
        return [read_numbers(f"{name}[{k}]", part, depth - 1) for k, part in enumerate(value)]
    for k, number in enumerate(value):
        _check_float(f"{name}[{k}]", number)
    return list(value)


def read_list(value: Any, name: str = "lengths") -> list:
    """Return a sequence, or an array, as a list.

    Raises:
        TypeError: if it is no list; the message names it.
    """
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, str | bytes) or not isinstance(value, Sequence):
        raise TypeError(f"{name} is {show(value)}, which is not a list")
    return list(value)


def _check_float(name: str, value: Any) -> None:
    if not is_number(value):
        raise TypeError(f"{name} is {show(value)}, {with_article(type(value))} and not a number")
    try:
        float(value)
    except OverflowError:
        told = f"{name} is {show(value, str)}, but must be at most 1e308"
        raise ValueError(told) from None


def check_shapes(scenario: Any) -> None:
    """Raise ValueError unless the arrays of an explicit scenario have its shapes."""
    havs, units = scenario.num_havs, scenario.max_trailers + 1
    shapes = {
        "bend": (havs, units),
        "start": (havs, 3),
        "goals": (havs, scenario.num_goals, 3),
    }
    for field, shape in shapes.items():
        found = getattr(scenario, field).shape
        if found != shape:
            raise ValueError(f"scenario {field} has shape {found}, but must have {shape}")


def check_lengths(length: np.ndarray, num_trailers: np.ndarray) -> None:
    """Raise ValueError unless the lengths (N, U) of the HAVs' units are in their range [m]."""
    _, allowed = split_range(Length)
    assert allowed is not None
    for agent, (own, trailers) in enumerate(zip(length, num_trailers, strict=True)):
        units = own[: trailers + 1]
        if not ((units >= allowed.low) & (units <= allowed.high)).all():
            told = f"HAV {agent} has lengths {show(units.tolist())}"
            raise ValueError(f"{told}, but each must be {allowed.rule}")


def check_poses(places: np.ndarray) -> None:
    """Raise ValueError unless starts and goals (N, 1 + G, 3) are in the range of poses."""
    for column, (part, kind) in enumerate(_POSE_PARTS.items()):
        _, allowed = split_range(kind)
        assert allowed is not None
        values = places[..., column]
        wrong = np.argwhere(~((values >= allowed.low) & (values <= allowed.high)))
        if len(wrong) == 0:
            continue
        agent, which = wrong[0]
        name, value = "start" if which == 0 else f"goal {which}", values[agent, which]
        if not math.isfinite(value):
            told = f"HAV {agent} has a pose that is not finite: {part} of its {name} is {value}"
        else:
            told = f"{part} of the {name} of HAV {agent} is {value}"
        raise ValueError(f"{told}, but must be {allowed.rule}")


def check_apart(places: np.ndarray, radius: np.ndarray) -> None:
    """Raise ValueError if starts, or goals of a phase, are in potential collision.

    Args:
        places: (N, 1 + G, 3), starts first; the first two columns are x and y [m].
        radius: (N,) radii of the footprints [m].
    """
    for which in range(places.shape[1]):
        pair = _find_overlap(places[:, which, :2], radius)
        if pair is not None:
            one, other = sorted(pair)
            name = "starts" if which == 0 else f"goals {which}"
            gap, least = math.dist(*places[[one, other], which, :2]), radius[one] + radius[other]
            raise ValueError(
                f"the {name} of HAVs {one} and {other} are {gap:.2f} m apart, a potential"
                f" collision: they need more than {least:.2f} m"
            )


def _find_overlap(places: np.ndarray, radius: np.ndarray) -> tuple[int, int] | None:
    """Return two circles that overlap or touch, None if there are none.

    The check sorts circles along the axis of their largest spread, and compares each with the next,
    the next but one, ... until all are too far apart. A row of thousands takes milliseconds.
    """
    along = places[:, np.argmax(np.ptp(places, axis=0))]
    order = np.argsort(along)
    for lag in range(1, len(order)):
        one, other = order[:-lag], order[lag:]
        near = along[other] - along[one] <= 2.0 * radius.max()
        if not near.any():
            return None
        one, other = one[near], other[near]
        gaps = np.hypot(*(places[one] - places[other]).T)
        overlap = np.flatnonzero(gaps <= radius[one] + radius[other])
        if len(overlap):
            return int(one[overlap[0]]), int(other[overlap[0]])
    return None
