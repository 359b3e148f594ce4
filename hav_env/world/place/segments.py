"""This module declares the place of a batch: the part of its worlds that has obstacles.

The type of ``world.place`` selects code. ``Plane`` is the paper's: it is empty, holds no arrays and
costs nothing. N HAVs of a world, U units of a HAV, S segments of a world, W worlds.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from hav_env.compiled import generic, kernel, lanes_from
from hav_env.maths.elementary import sqrt
from hav_env.world.units.parts import Array, part_from


class Plane(NamedTuple):
    """A plane without obstacles."""


class Obstacles(NamedTuple):
    """Segments that HAVs may collide with.

    A segment is tested against a HAV only if the HAV may have reached it: see
    ``hav_env.world.obstacles.collisions``. The world is the first axis of ``due``: the kernel reads
    it row by row, for one HAV of one world.
    """

    segment: Array  # (S, 5, W) columns MIDDLE_X .. HALF_LENGTH
    # (W,) number of segments of the world, or OVERFULL; the other entries are far away
    count: Array
    due: Array  # (W, N, S) distance [m] that a HAV has to drive before the segment is tested again
    driven: Array  # (N, 3, W) columns MOST_MOVED .. BODY_MARGIN [m]
    cosine: Array  # (U, W) scratch: cosines of the units of the HAV at hand before it moves
    sine: Array  # (U, W) scratch: their sines
    moved: Array  # (6, W) scratch, rows BEFORE_X .. MOST_TURNED


MIDDLE_X, MIDDLE_Y, DIRECTION_COSINE, DIRECTION_SINE, HALF_LENGTH = range(5)
# sum of the upper bounds on the movement of a HAV's points; the least distance of all that are due;
# the largest distance of bodies from the lines between their ends
MOST_MOVED, NEXT_DUE, BODY_MARGIN = range(3)
# position of the truck's rear axle before; movement of the front end of the unit at hand; largest
# squared movement of any end, and largest squared change of any direction
BEFORE_X, BEFORE_Y, WENT_X, WENT_Y, FARTHEST, MOST_TURNED = range(6)
_MOTION_ROWS = MOST_TURNED + 1
NOT_THERE = 1e12  # [m], farther than any HAV drives before the paper's longest episode ends
OVERFULL = -1  # a scenario put a segment into a world that has no space for it


def allocate_place(num_segments: int, shape: tuple[int, int, int], zeros: Callable) -> Any:
    """Return the arrays of a place: ``Obstacles``, or ``Plane`` if there are no segments.

    Args:
        num_segments: Number of segments S.
        shape: N, U and W.
        zeros: Function that makes each array from its shape and type.
    """
    if num_segments == 0:
        return Plane()
    s, (n, u, w) = num_segments, shape
    segment = zeros((s, 5, w), np.float64)
    if segment.flags.writeable:  # size estimates use arrays without memory
        segment[:, [MIDDLE_X, MIDDLE_Y]] = NOT_THERE
        segment[:, DIRECTION_COSINE] = 1.0
    return Obstacles(
        segment,
        zeros((w,), np.int64),
        zeros((w, n, s), np.float64),
        zeros((n, 3, w), np.float64),
        zeros((u, w), np.float64),
        zeros((u, w), np.float64),
        zeros((_MOTION_ROWS, w), np.float64),
    )


@part_from.register(Plane)
def _keep_plane(part, first):
    return part


@part_from.register(Obstacles)
def _obstacles_from(part, first):
    return Obstacles(
        lanes_from(part.segment, first),
        lanes_from(part.count, first),
        part.due,
        lanes_from(part.driven, first),
        lanes_from(part.cosine, first),
        lanes_from(part.sine, first),
        lanes_from(part.moved, first),
    )


@generic
def place_segment(place, number, lane, ax, ay, bx, by):
    """Put a segment from a to b [m] into a world, under its index, from 0.

    A world without space for it does not begin: its scenario must state ``num_segments``.
    """


@place_segment.register(Plane)
def _place_none(place, number, lane, ax, ay, bx, by):
    pass


@place_segment.register(Obstacles)
def _place_one(place, number, lane, ax, ay, bx, by):
    if not 0 <= number < place.segment.shape[0] or place.count[lane] == OVERFULL:
        place.count[lane] = OVERFULL
        return
    dx, dy = 0.5 * (bx - ax), 0.5 * (by - ay)
    half = sqrt(dx * dx + dy * dy)
    per_half = 1.0 / half if half > 0.0 else 0.0
    place.segment[number, MIDDLE_X, lane] = 0.5 * (ax + bx)
    place.segment[number, MIDDLE_Y, lane] = 0.5 * (ay + by)
    place.segment[number, DIRECTION_COSINE, lane] = dx * per_half if half > 0.0 else 1.0
    place.segment[number, DIRECTION_SINE, lane] = dy * per_half
    place.segment[number, HALF_LENGTH, lane] = half
    place.count[lane] = max(place.count[lane], number + 1)


@generic
def clear_place(place, lane):
    """Remove all segments from a world."""


@clear_place.register(Plane)
def _clear_nothing(place, lane):
    pass


@clear_place.register(Obstacles)
def _clear_segments(place, lane):
    for number in range(place.segment.shape[0]):
        place.segment[number, MIDDLE_X, lane] = NOT_THERE
        place.segment[number, MIDDLE_Y, lane] = NOT_THERE
        place.segment[number, HALF_LENGTH, lane] = 0.0
    place.count[lane] = 0


@kernel
def place_site(place, site, lane):
    """Put all segments of a site into a world that has none.

    Args:
        place: Place of a block of worlds with enough space for them.
        site: Site with segments (S, 4), x and y of both ends [m].
        lane: Index of the world.
    """
    for number in range(site.segment.shape[0]):
        ax, ay, bx, by = site.segment[number]
        place_segment(place, number, lane, ax, ay, bx, by)


@generic
def num_segments(place, lane):
    """Return the number of segments of a world."""


@num_segments.register(Plane)
def _none(place, lane):
    return 0


@num_segments.register(Obstacles)
def _count_of(place, lane):
    return place.count[lane]


@kernel
def segment_of(place, number, lane):
    """Return a segment as a rectangle without width, see ``hav_env.maths.rectangles``."""
    segment = place.segment
    return (
        segment[number, MIDDLE_X, lane],
        segment[number, MIDDLE_Y, lane],
        segment[number, DIRECTION_COSINE, lane],
        segment[number, DIRECTION_SINE, lane],
        segment[number, HALF_LENGTH, lane],
        0.0,
    )
