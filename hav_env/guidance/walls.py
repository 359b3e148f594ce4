"""This module checks whether drives keep clear of the walls of a site, given as segments.

A drive is a Dubins path of the truck's rear axle. It keeps clear if a disc of a given radius around
each of its points touches no segment.
"""

import math
from typing import NamedTuple

import numpy as np

from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.dubins import turns
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import point_segment_squared

CHECKED_EVERY = 0.1  # [m], the longest step along a drive close to a wall


class Grid(NamedTuple):
    """Square cells over the rectangle of a site."""

    x: float
    """Western edge [m]."""
    y: float
    """Southern edge [m]."""
    cell: float
    """Side of a cell [m]."""


class Walls(NamedTuple):
    """The walls, and the distances of the cells from them."""

    segments: np.ndarray  # (S, 4) x1, y1, x2, y2 [m]
    gaps: np.ndarray  # (ny, nx) from the middle of each cell to the nearest segment [m]
    grid: Grid


def lay_grid(bounds: tuple[float, float, float, float], cell: float) -> tuple[Grid, int, int]:
    """Return the grid over a rectangle, and its numbers of rows and columns, at least 2 each.

    Args:
        bounds: x and y [m] of the south-western corner, then of the north-eastern one.
        cell: side of a cell [m].
    """
    west, south, east, north = bounds
    rows = max(2, math.ceil((north - south) / cell))
    columns = max(2, math.ceil((east - west) / cell))
    return Grid(float(west), float(south), float(cell)), rows, columns


def measure_gaps(segments: np.ndarray, grid: Grid, rows: int, columns: int) -> np.ndarray:
    """Return the distance of the middle of each cell from the nearest segment (rows, columns) [m].

    Args:
        segments: (S, 4) x1, y1, x2, y2 [m].
        grid: the cells.
        rows: number of cells along y.
        columns: number of cells along x.
    """
    x = grid.x + grid.cell * (np.arange(columns) + 0.5)
    y = grid.y + grid.cell * (np.arange(rows) + 0.5)[:, None]
    squared = np.full((rows, columns), np.inf)
    for start_x, start_y, end_x, end_y in segments:
        dx, dy = end_x - start_x, end_y - start_y
        long = dx * dx + dy * dy
        along = (x - start_x) * dx + (y - start_y) * dy
        share = np.clip(along / long, 0.0, 1.0) if long > 0.0 else np.zeros_like(along)
        away = (start_x + share * dx - x) ** 2 + (start_y + share * dy - y) ** 2
        np.minimum(squared, away, out=squared)
    return np.sqrt(squared)


@rare_kernel
def gap_of_point(segments, x, y):
    """Return the distance of a point from the nearest segment [m]; infinity without segments.

    Args:
        segments: (S, 4) [m].
        x: of the point [m].
        y: of the point [m].
    """
    least = math.inf
    for s in range(segments.shape[0]):
        squared = point_segment_squared(
            x, y, segments[s, 0], segments[s, 1], segments[s, 2], segments[s, 3]
        )
        least = min(least, squared)
    return math.sqrt(least)


@rare_kernel
def path_keeps_clear(site, clearance, x, y, cosine, sine, radius, word, first, second, third):
    """Return whether all points of a Dubins path keep a distance from all segments.

    The reserve of a point is its distance from the segments minus the clearance. From each checked
    point, the next one is ahead by the reserve, or by ``CHECKED_EVERY`` if that is more. Each of
    them must have half of ``CHECKED_EVERY`` in reserve. So the check may reject a path that keeps
    clear by less than that. It never accepts a path that does not keep clear.

    Args:
        site: the walls.
        clearance: distance to keep [m].
        x: x of the start [m].
        y: y of the start [m].
        cosine: cosine of the heading at the start.
        sine: sine of the heading at the start.
        radius: radius of the turns [m].
        word: index into ``hav_env.maths.dubins.WORDS``.
        first: length of the first segment [m].
        second: length of the second segment [m].
        third: length of the third segment [m].
    """
    side, middle, last = turns(word)
    per_radius = 1.0 / radius
    gap = _gap_to_keep(site, clearance, x, y)
    for part in range(3):
        length = first if part == 0 else second if part == 1 else third
        turn = side if part == 0 else middle if part == 1 else last
        px, py, at = x, y, 0.0
        bend_cosine, bend_sine = 1.0, 0.0
        while gap >= clearance and at < length:
            at = min(at + max(gap - clearance, CHECKED_EVERY), length)
            forward, left, bend_cosine, bend_sine = _drive(at, turn, radius, per_radius)
            px = x + forward * cosine - left * sine
            py = y + forward * sine + left * cosine
            gap = _gap_to_keep(site, clearance, px, py)
        x, y = px, py
        cosine, sine = (
            cosine * bend_cosine - sine * bend_sine,
            sine * bend_cosine + cosine * bend_sine,
        )
    return gap >= clearance


@rare_kernel
def _gap_to_keep(site, clearance, x, y):
    """Return a lower bound of the gap of a point [m], -1 if its reserve is too small."""
    asked = clearance + 0.5 * CHECKED_EVERY
    gap = _known_gap(site, x, y)
    if gap < asked + CHECKED_EVERY:
        gap = gap_of_point(site.segments, x, y)
    return gap if gap >= asked else -1.0


@kernel
def _drive(length, turn, radius, per_radius):
    """Return the end of a Dubins segment (forward, left) [m], and cosine and sine of its turn.

    Args:
        length: length of the segment [m].
        turn: 1.0 left, -1.0 right, 0.0 straight.
        radius: of the turn [m].
        per_radius: 1 / radius [1/m].
    """
    sine, cosine = sincos(length * per_radius)
    straight = turn == 0.0
    return (
        length if straight else radius * sine,
        turn * radius * (1.0 - cosine),
        1.0 if straight else cosine,
        turn * sine,
    )


@rare_kernel
def _known_gap(site, x, y):
    """Return a lower bound of the gap of a point [m], from the gap of its cell."""
    grid = site.grid
    j, i = math.floor((x - grid.x) / grid.cell), math.floor((y - grid.y) / grid.cell)
    rows, columns = site.gaps.shape
    if i < 0 or j < 0 or i >= rows or j >= columns:
        return -math.inf
    dx, dy = x - grid.x - (j + 0.5) * grid.cell, y - grid.y - (i + 0.5) * grid.cell
    return site.gaps[i, j] - math.sqrt(dx * dx + dy * dy)
