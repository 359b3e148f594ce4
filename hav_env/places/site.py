"""This module has sites: the walls, buildings, kerbs and bounds among which HAVs drive."""

import math
from collections.abc import Sequence
from typing import Annotated, Any, NamedTuple

import numpy as np

from hav_env.compiled import kernel
from hav_env.models.annotations import Range, is_number, show, split_range
from hav_env.models.checks import check_relations
from hav_env.models.quantities import Coordinate

BOUNDARY, POLYGON, LINE = range(3)  # kinds of outlines: keep inside, keep outside, keep off
_CIRCLE_SIDES = 16
MOST_SEGMENTS = 100_000

Ends = Annotated[np.ndarray, Range(-1e8, 1e8, "m")]


class Site(NamedTuple):
    """Outlines in the plane, as segments that no HAV may touch. Build one with ``build_site``.

    HAVs collide with segments alone. Nothing fills a polygon: a HAV inside one touches nothing
    until it drives out. Scenarios place nobody there.
    """

    segment: Ends
    """(S, 4) x and y of one end, x and y of the other [m]."""
    outline: np.ndarray
    """(S,) whole numbers: to which outline each segment belongs, ascending from 0."""
    kind: np.ndarray
    """(K,) whole numbers: BOUNDARY, POLYGON or LINE, of each outline."""

    @property
    def num_segments(self) -> int:
        """S, how many segments there are."""
        return len(self.segment)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Least x, least y, greatest x, greatest y [m] of all segments."""
        points = self.segment.reshape(-1, 2)
        (left, low), (right, high) = points.min(axis=0), points.max(axis=0)
        return float(left), float(low), float(right), float(high)


NOWHERE = Site(np.zeros((0, 4)), np.zeros(0, np.int64), np.zeros(0, np.int64))


@check_relations.register
def _(site: Site) -> None:
    segment, outline, kind = site
    if segment.ndim != 2 or segment.shape[1] != 4:
        raise ValueError(f"site segment has shape {segment.shape}, but must have (S, 4)")
    if len(segment) > MOST_SEGMENTS:
        told = f"site has {len(segment)} segments"
        raise ValueError(f"{told}, but must have at most {MOST_SEGMENTS}: simplify its outlines")
    if outline.shape != (len(segment),) or kind.ndim != 1:
        raise ValueError("site outline must have one number for each segment, and kind one axis")
    ascending = np.array_equal(np.unique(outline), np.arange(len(kind)))
    if not (ascending and (np.diff(outline, prepend=0) >= 0).all()):
        raise ValueError("site outline must ascend from 0, with a kind for each of its numbers")
    if not np.isin(kind, (BOUNDARY, POLYGON, LINE)).all():
        raise ValueError("site kind must hold BOUNDARY (0), POLYGON (1) or LINE (2) alone")


def build_site(
    boundary: Sequence[Sequence[float]] | None = None,
    polygons: Sequence[Sequence[Sequence[float]]] = (),
    lines: Sequence[Sequence[Sequence[float]]] = (),
    circles: Sequence[Sequence[float]] = (),
) -> Site:
    """Build a site from its outlines; all coordinates in m.

    Args:
        boundary: corners (x, y) of the polygon that HAVs stay inside of; none by default. The last
            corner is joined to the first.
        polygons: corners of each obstacle; likewise.
        lines: points of each polygonal chain, at least two.
        circles: x, y and radius of each; it becomes a polygon of 16 sides that holds it.

    Raises:
        TypeError: naming what is no list or no number.
        ValueError: naming the outline, and what is wrong with it.
    """
    outlines: list[tuple[int, np.ndarray]] = []
    if boundary is not None:
        outlines.append((BOUNDARY, _read_ring("boundary", boundary)))
    for k, ring in enumerate(polygons):
        outlines.append((POLYGON, _read_ring(f"polygons[{k}]", ring)))
    for k, chain in enumerate(lines):
        points = read_points(f"lines[{k}]", chain)
        if len(points) < 2:
            raise ValueError(f"lines[{k}] has {len(points)} points, but must have at least 2")
        outlines.append((LINE, points))
    for k, circle in enumerate(circles):
        outlines.append((POLYGON, _round_polygon(f"circles[{k}]", circle)))
    return join_outlines(outlines)


def join_outlines(outlines: Sequence[tuple[int, np.ndarray]]) -> Site:
    """Return the site of outlines, each its kind and its points (P, 2) [m].

    Points that coincide with the one before are left out. Rings close by themselves.

    Raises:
        ValueError: when there are too many segments.
    """
    segments: list[np.ndarray] = []
    owner: list[np.ndarray] = []
    kinds: list[int] = []
    for kind, points in outlines:
        ends = np.concatenate([points, points[:1]]) if kind != LINE else points
        own = np.concatenate([ends[:-1], ends[1:]], axis=1)
        own = own[(own[:, :2] != own[:, 2:]).any(axis=1)]
        if len(own):
            segments.append(own)
            owner.append(np.full(len(own), len(kinds), np.int64))
            kinds.append(kind)
    if not segments:
        return NOWHERE
    site = Site(
        np.ascontiguousarray(np.concatenate(segments)),
        np.concatenate(owner),
        np.array(kinds, np.int64),
    )
    check_relations(site)
    return site


def outlines_of(site: Site) -> list[tuple[int, np.ndarray]]:
    """Return the outlines of a site: the kind and the points (P, 2) [m] of each.

    The last point of a ring is its first one again.
    """
    found = []
    for number, kind in enumerate(site.kind):
        own = site.segment[site.outline == number]
        found.append((int(kind), np.concatenate([own[:, :2], own[-1:, 2:]])))
    return found


def read_points(name: str, value: Any) -> np.ndarray:
    """Return points (P, 2) [m] that a user gave.

    Args:
        name: of the outline, for messages.
        value: value that the user gave.

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


def _read_ring(name: str, value: Any) -> np.ndarray:
    points = read_points(name, value)
    if len(points) > 1 and (points[0] == points[-1]).all():
        points = points[:-1]
    if len(np.unique(points, axis=0)) < 3:
        raise ValueError(f"{name} is {show(value)}, but must have at least 3 different corners")
    return points


def _round_polygon(name: str, circle: Any) -> np.ndarray:
    """Return the corners of a regular polygon round a circle."""
    listed = isinstance(circle, Sequence) and not isinstance(circle, str | bytes)
    if not listed or len(circle) != 3 or not all(map(is_number, circle)):
        raise TypeError(f"{name} is {show(circle)}, but must be [x, y, radius]")
    x, y, radius = circle
    _check_coordinates(name, (x, y, radius))
    if not radius > 0.0:
        raise ValueError(f"{name} has radius {show(radius)}, but must have one above 0 m")
    angle = 2.0 * math.pi * (np.arange(_CIRCLE_SIDES) + 0.5) / _CIRCLE_SIDES
    corner = radius / math.cos(math.pi / _CIRCLE_SIDES)
    return np.stack([x + corner * np.cos(angle), y + corner * np.sin(angle)], axis=1)


def _check_coordinates(name: str, numbers: Sequence[float]) -> None:
    _, allowed = split_range(Coordinate)
    assert allowed is not None
    for number in numbers:
        if not allowed.low <= number <= allowed.high:
            raise ValueError(f"{name} holds {show(number)}, but must hold numbers {allowed.rule}")


@kernel
def is_inside(site, x, y):
    """Tell whether a place [m] is where HAVs may be: inside the boundary, outside all polygons.

    A ray to the right crosses a ring an odd number of times from inside. On a segment either may
    come out.
    """
    inside, number, odd = True, -1, False
    for s in range(site.segment.shape[0]):
        if site.outline[s] != number:
            inside = inside and (number < 0 or _is_kept(site.kind[number], odd))
            number, odd = site.outline[s], False
        ax, ay, bx, by = site.segment[s]
        if (ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
            odd = not odd
    return inside and (number < 0 or _is_kept(site.kind[number], odd))


@kernel
def _is_kept(kind, odd):
    """Tell whether a place that is inside a ring, or not, keeps to it."""
    return kind == LINE or odd == (kind == BOUNDARY)
