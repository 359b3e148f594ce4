"""This module follows paths of arcs and straights, and returns the heading along them.

The paths are like Dubins words, but their arcs may have different radii. A HAV's memory holds a
path as segments, each with a curvature [1/m], positive to the left, and a length [m].
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.dubins import INFEASIBLE, LRL, RLR, word_segments
from hav_env.maths.elementary import atan2, floor
from hav_env.maths.geometry import TURNS_PER_RADIAN, TWO_PI

_ANGLE_ROUNDING = 1e-9  # [rad] an arc that is a whole turn but for this is none at all


@kernel
def _wrap_positive(angle):
    """Return the angle [rad] moved by whole turns into [0, 2 pi)."""
    turned = floor((angle + _ANGLE_ROUNDING) * TURNS_PER_RADIAN)
    return max(angle - TWO_PI * turned, 0.0)


@kernel
def tangent_path(first_side, last_side, x, y, heading, cosine, sine, first_radius, last_radius):
    """Return the lengths [m] of an arc, a straight and an arc to a pose in the start's frame.

    Args:
        first_side: Side of the first arc, 1.0 left, -1.0 right.
        last_side: Side of the last arc, 1.0 left, -1.0 right.
        x: Forward coordinate of the pose [m].
        y: Left coordinate of the pose [m].
        heading: Heading of the pose [rad].
        cosine: Cosine of that heading.
        sine: Sine of that heading.
        first_radius: Radius of the first arc [m].
        last_radius: Radius of the last arc [m].

    Returns:
        The three lengths. The first is ``INFEASIBLE`` if one circle lies within the other, or if
        the sides differ and the circles overlap.
    """
    start, end = first_side * first_radius, last_side * last_radius
    across_x = x - end * sine
    across_y = y + end * cosine - start
    offset = end - start
    squared = across_x * across_x + across_y * across_y - offset * offset
    straight = math.sqrt(max(squared, 0.0))
    direction = atan2(
        across_y * straight - across_x * offset, across_x * straight + across_y * offset
    )
    first = first_radius * _wrap_positive(first_side * direction)
    last = last_radius * _wrap_positive(last_side * (heading - direction))
    return INFEASIBLE if squared < 0.0 else first, straight, last


@kernel
def circles_path(side, x, y, heading, radius):
    """Return the lengths [m] of three arcs of one radius, the first and the last to ``side``."""
    first, middle, last = word_segments(LRL if side > 0.0 else RLR, x, y, heading, radius)
    return first * radius, middle * radius, last * radius


@kernel
def append(rows, path, curvature, length):
    """Append a segment to a path, unless its length is 0."""
    count = int(rows[path + m.NUM_SEGMENTS])
    if length > 0.0:
        rows[path + m.CURVATURES + count] = curvature
        rows[path + m.LENGTHS + count] = length
        rows[path + m.NUM_SEGMENTS] = count + 1.0


@kernel
def total_length(rows, path):
    """Return the length of a path [m]."""
    total = 0.0
    for segment in range(int(rows[path + m.NUM_SEGMENTS])):
        total += rows[path + m.LENGTHS + segment]
    return total


@rare_kernel
def heading_at(rows, path, distance):
    """Return the change of heading [rad] along a path from its start to a distance [m]."""
    heading = 0.0
    for segment in range(int(rows[path + m.NUM_SEGMENTS])):
        if distance <= 0.0:
            break
        along = min(distance, rows[path + m.LENGTHS + segment])
        heading += rows[path + m.CURVATURES + segment] * along
        distance -= along
    return heading


@kernel
def copy_path(rows, path, source):
    """Copy the path ``source`` to the path ``path``."""
    for row in range(m.LENGTHS + sizes.MAX_SEGMENTS):
        rows[path + row] = rows[source + row]
