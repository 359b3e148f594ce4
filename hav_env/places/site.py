"""This module defines sites: the walls, buildings, kerbs and bounds among which HAVs drive."""

from collections.abc import Iterable, Sequence
from typing import Annotated, NamedTuple

import numpy as np

from hav_env.compiled import kernel
from hav_env.models.annotations import Range, show
from hav_env.models.checks import check_relations
from hav_env.places.outlines import read_chain, read_circle, read_ring

BOUNDARY, POLYGON, LINE = range(3)  # kinds of outlines: stay inside, stay outside, do not touch
MOST_SEGMENTS = 100_000

Ends = Annotated[np.ndarray, Range(-1e8, 1e8, "m")]
Outline = tuple[int, Sequence[np.ndarray]]
"""A kind, and chains of points (P, 2) [m]: one, or the rings of a polygon with holes."""


class Site(NamedTuple):
    """Outlines in the plane, as segments that no HAV may touch. Build one with ``build_site``.

    HAVs collide with segments alone. The inside of a polygon is not solid: a HAV inside touches
    nothing until it drives out. Scenarios place no HAV there.
    """

    segment: Ends
    """(S, 4) x and y of one end, x and y of the other [m]."""
    outline: np.ndarray
    """(S,) number of the outline of each segment, ascending from 0."""
    kind: np.ndarray
    """(K,) whole numbers: BOUNDARY, POLYGON or LINE, of each outline."""

    @property
    def num_segments(self) -> int:
        """Number S of segments."""
        return len(self.segment)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Least x, least y, greatest x, greatest y [m] of all segments; inf first if none."""
        points = self.segment.reshape(-1, 2)
        low, high = points.min(axis=0, initial=np.inf), points.max(axis=0, initial=-np.inf)
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    def __repr__(self) -> str:
        """Return size and bounds: a list of all segments would make messages no clearer."""
        left, low, right, high = self.bounds
        where = f", x from {left:g} to {right:g} m, y from {low:g} to {high:g} m"
        return f"Site({self.num_segments} segments{where if self.num_segments else ''})"


NOWHERE = Site(np.zeros((0, 4)), np.zeros(0, np.int64), np.zeros(0, np.int64))


@check_relations.register
def _(site: Site) -> None:
    segment, outline, kind = site
    if segment.ndim != 2 or segment.shape[1] != 4:
        raise ValueError(f"site segment has shape {segment.shape}, but must have (S, 4)")
    if len(segment) > MOST_SEGMENTS:
        told = f"site has {len(segment)} segments"
        raise ValueError(
            f"{told}, but must have at most {MOST_SEGMENTS}: a greater tolerance helps"
        )
    if outline.shape != (len(segment),) or kind.ndim != 1:
        raise ValueError("site outline must have one number for each segment, and kind one axis")
    if outline.dtype.kind not in "iu" or kind.dtype.kind not in "iu":
        raise ValueError("site outline and kind must be arrays of whole numbers")
    ascending = np.array_equal(np.unique(outline), np.arange(len(kind)))
    if not (ascending and (np.diff(outline.astype(np.int64)) >= 0).all()):
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
        boundary: corners (x, y) of the polygon that contains all HAVs; none by default. The last
            corner connects to the first.
        polygons: corners of each obstacle, in the same form.
        lines: points of each polygonal chain, at least two.
        circles: x, y and radius of each; a polygon of 16 sides replaces and contains it.

    Raises:
        TypeError: if a value is no list or no number; the message names it.
        ValueError: if an outline is wrong; the message names it and the rule.
    """
    outlines: list[Outline] = []
    if boundary is not None:
        outlines.append((BOUNDARY, [read_ring("boundary", boundary)]))
    for name, given in (("polygons", polygons), ("lines", lines), ("circles", circles)):
        if isinstance(given, str | bytes) or not isinstance(given, Sequence | np.ndarray):
            raise TypeError(f"{name} is {show(given)}, but must be a list")
    for k, ring in enumerate(polygons):
        outlines.append((POLYGON, [read_ring(f"polygons[{k}]", ring)]))
    for k, chain in enumerate(lines):
        outlines.append((LINE, [read_chain(f"lines[{k}]", chain)]))
    for k, circle in enumerate(circles):
        outlines.append((POLYGON, [read_circle(f"circles[{k}]", circle)]))
    return join_outlines(outlines)


def join_outlines(outlines: Iterable[Outline]) -> Site:
    """Return the site of outlines; rings end with their first point.

    A point that coincides with the previous one is left out.

    Args:
        outlines: outlines of any kind; a polygon with holes has a ring for each.

    Raises:
        ValueError: if there are too many segments.
    """
    segments: list[np.ndarray] = []
    owner: list[np.ndarray] = []
    kinds: list[int] = []
    for kind, chains in outlines:
        own = np.concatenate([np.concatenate([c[:-1], c[1:]], axis=1) for c in chains])
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


def chains_of(site: Site) -> list[tuple[int, np.ndarray]]:
    """Return the chains of a site: the kind and the points (P, 2) [m] of each.

    The last point of a ring repeats its first one. A polygon with holes gives a chain for each of
    its rings.
    """
    follows = (site.segment[1:, :2] == site.segment[:-1, 2:]).all(axis=1)
    cuts = np.flatnonzero(~(follows & (site.outline[1:] == site.outline[:-1]))) + 1
    found = []
    for own in np.split(np.arange(site.num_segments), cuts) if site.num_segments else ():
        ends = site.segment[own]
        points = np.concatenate([ends[:, :2], ends[-1:, 2:]])
        found.append((int(site.kind[site.outline[own[0]]]), points))
    return found


@kernel
def is_inside(site, x, y):
    """Return whether a place [m] is free: inside the boundary, outside all polygons.

    A ray to the right crosses the rings of an outline an odd number of times from inside. On a
    segment either result is possible. Python code calls ``hav_env.places.contact.place_is_inside``.
    """
    inside, number, odd = True, -1, False
    for s in range(site.segment.shape[0]):
        if site.outline[s] != number:
            inside = inside and (number < 0 or is_kept(site.kind[number], odd))
            number, odd = site.outline[s], False
        ax, ay, bx, by = site.segment[s]
        if ray_crosses(ax, ay, bx, by, x, y):
            odd = not odd
    return inside and (number < 0 or is_kept(site.kind[number], odd))


@kernel
def ray_crosses(ax, ay, bx, by, x, y):
    """Return whether a ray to the right of a place crosses a segment [m]; arrays are allowed."""
    aside = (x - ax) * (by - ay) - (y - ay) * (bx - ax)
    return ((ay > y) != (by > y)) & ((by > ay) == (aside < 0.0))


@kernel
def is_kept(kind, odd):
    """Return whether a place satisfies an outline, given its side; arrays are allowed."""
    return (kind == LINE) | (odd == (kind == BOUNDARY))
