"""This module declares columns of an observation, and the scales of their values.

A group of columns is a tuple of ``Column``. It is in the module of the kernel that writes it:
own.py, route.py, neighbors.py. Names, bounds and indices follow from it.
"""

import collections
import math
from collections.abc import Iterable
from typing import Any, NamedTuple

from hav_env.compiled import kernel, single
from hav_env.maths.elementary import log, sqrt
from hav_env.maths.geometry import clip

LENGTH_UNIT, LENGTH_CUT = 10.0, 10.0  # unit and clipping limit of unit lengths [m]
DISTANCE_CUT = 1e4  # [m], clipping limit of distances
SPEED_UNIT = 10.0  # [m/s], clipping limit of speeds
TINY_DISTANCE = 1e-12  # [m], keeps the direction finite for a point at distance 0
_PER_LOGARITHM = 1.0 / math.log(1.0 + DISTANCE_CUT)


class Column(NamedTuple):
    """One number of an observation."""

    name: str
    low: float = 0.0
    """Lower bound."""
    high: float = 1.0
    """Upper bound."""


def length_column(name: str) -> Column:
    """Return the column of the length of a unit, which ``scale_length`` writes."""
    return Column(name, 0.0, LENGTH_CUT)


def direction_columns(name: str) -> tuple[Column, Column]:
    """Return the two columns that ``write_direction`` writes."""
    return Column(f"{name}_cosine", -1.0), Column(f"{name}_sine", -1.0)


def place_columns(prefix: str) -> tuple[Column, Column, Column]:
    """Return the three columns that ``write_place`` writes."""
    return Column(f"{prefix}distance"), *direction_columns(f"{prefix}bearing")


def place_names(names: Iterable[str]) -> Any:
    """Return an object with the index of each name as an attribute of that name: 0, 1, ...

    Compiled code treats the indices as constants.
    """
    found = list(names)
    return collections.namedtuple("Places", found, module=__name__)(*range(len(found)))


def places_of(group: tuple[Column, ...]) -> Any:
    """Return the index of each column in its group, as an attribute of its name."""
    return place_names(column.name for column in group)


@kernel
def scale_distance(distance):
    """Return ln(1 + d / 1 m) / ln(1 + 10 km / 1 m), clipped to 1; it resolves 1 m as well as 300 m.

    The distance is a float32.
    """
    return min(log(1.0 + distance) * _PER_LOGARITHM, 1.0)


@kernel
def scale_length(length):
    """Return the length of a unit, a float32, in units of 10 m, clipped to 10."""
    return min(length * (1.0 / LENGTH_UNIT), LENGTH_CUT)


@kernel
def _polar(forward, left):
    """Return the distance of a point [m], cosine and sine of its bearing; all 0 at distance 0."""
    distance = sqrt(forward * forward + left * left)
    per_distance = 1.0 / max(distance, TINY_DISTANCE)
    return distance, forward * per_distance, left * per_distance


@kernel
def _cut_to_one(share):
    """Return a share clipped to [-1, 1], which rounding may have exceeded."""
    return clip(share, -1.0, 1.0)


@kernel
def write_place(columns, column, lane, forward, left):
    """Write distance, cosine and sine of the bearing of a point [m], given as float32."""
    distance, cosine, sine = _polar(forward, left)
    columns[column, lane] = scale_distance(distance)
    write_direction(columns, column + 1, lane, cosine, sine)


@kernel
def write_direction(columns, column, lane, cosine, sine):
    """Write a cosine and a sine, clipped to [-1, 1], which rounding may have exceeded."""
    columns[column, lane] = _cut_to_one(single(cosine))
    columns[column + 1, lane] = _cut_to_one(single(sine))
