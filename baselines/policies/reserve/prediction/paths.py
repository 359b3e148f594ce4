"""Paths of arcs and straights: Dubins words whose arcs may differ, and the heading along a path.

A path stands in a HAV's memory as segments: curvature [1/m], left positive, and length [m].
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.dubins import INFEASIBLE, LRL, RLR, word_segments
from hav_env.maths.elementary import atan2, floor
from hav_env.maths.geometry import TURNS_PER_RADIAN, TWO_PI

_ROUNDING = 1e-9  # [rad] what is hardly below a whole turn is none


@kernel
def _angle_round(angle):
    """Return the angle [rad] moved by whole turns into [0, 2 pi)."""
    turned = floor((angle + _ROUNDING) * TURNS_PER_RADIAN)
    return max(angle - TWO_PI * turned, 0.0)


@kernel
def tangent_path(first_side, last_side, x, y, heading, cosine, sine, first_radius, last_radius):
    """Return the lengths [m] of an arc, a straight and an arc to a pose in the start's frame.

    Args:
        first_side, last_side: 1.0 for an arc to the left, -1.0 to the right.
        x, y, heading, cosine, sine: the pose [m, rad].
        first_radius, last_radius: of both arcs [m].

    Returns:
        Three lengths; the first is ``INFEASIBLE`` when one circle lies within the other, or the
        sides differ and the circles overlap.
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
    first = first_radius * _angle_round(first_side * direction)
    last = last_radius * _angle_round(last_side * (heading - direction))
    return INFEASIBLE if squared < 0.0 else first, straight, last


@kernel
def circles_path(side, x, y, heading, radius):
    """Return the lengths [m] of three arcs of one radius, the first and last to one side."""
    first, middle, last = word_segments(LRL if side > 0.0 else RLR, x, y, heading, radius)
    return first * radius, middle * radius, last * radius


@kernel
def append(rows, path, curvature, length):
    """Append a segment to a path; one without length is left out."""
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
    """Return the heading [rad] of a path after a distance [m], less the one it starts with."""
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
    """Write a path over another one."""
    for row in range(m.LENGTHS + sizes.MAX_SEGMENTS):
        rows[path + row] = rows[source + row]
