"""This module finds the edges of roads: the sides of the area of all lanes."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from hav_env.places.libraries import import_maps

_INSIDE = 0.1  # [m] depth inside the area of all lanes beyond which nothing is an edge
_LEAST_ISLAND = 4.0  # [m2] smaller gaps among lanes are artefacts of drawing


class Lane(NamedTuple):
    """A piece of a lane, such as a lanelet."""

    left: np.ndarray
    """(P, 2) points of its left bound in the direction of driving [m]."""
    right: np.ndarray
    """(Q, 2) points of its right bound [m]."""
    ends_left: bool
    """Whether there is no lane to its left."""
    ends_right: bool
    """Whether there is no lane to its right."""


def edges_of_roads(lanes: Sequence[Lane]) -> list[np.ndarray]:
    """Return the bounds without a lane beyond them, as chains of points (P, 2) [m].

    Lanes cross and fork at junctions. There the result leaves out parts of bounds that other lanes
    cover: those farther than 0.1 m inside the area of all. Gaps among lanes of less than 4 m2 count
    as covered.

    Args:
        lanes: lanes of all roads.

    Raises:
        ImportError: without the extra ``maps``.
    """
    bounds = [lane.left for lane in lanes if lane.ends_left]
    bounds += [lane.right for lane in lanes if lane.ends_right]
    if not bounds:
        return []
    shapely = import_maps("shapely")
    rings = [np.concatenate([lane.left, lane.right[::-1], lane.left[:1]]) for lane in lanes]
    areas = shapely.make_valid([shapely.Polygon(ring) for ring in rings])
    covered = [_filled(shapely, part) for part in shapely.get_parts(shapely.union_all(areas))]
    inside = shapely.buffer(shapely.union_all(covered), -_INSIDE)
    shapely.prepare(inside)
    edges = shapely.difference([shapely.LineString(bound) for bound in bounds], inside)
    parts = shapely.get_parts(shapely.line_merge(shapely.union_all(edges)))
    lines = parts[(shapely.get_type_id(parts) == 1) & ~shapely.is_empty(parts)]
    return [np.asarray(line.coords) for line in lines]


def _filled(shapely: Any, part: Any) -> Any:
    """Return a part of the area of all lanes without its small holes."""
    if part.geom_type != "Polygon":  # a lane without width
        return part
    holes = [hole for hole in part.interiors if shapely.Polygon(hole).area >= _LEAST_ISLAND]
    return shapely.Polygon(part.exterior, holes)
