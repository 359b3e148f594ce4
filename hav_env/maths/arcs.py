"""This module computes paths of arcs of different radii, as Dubins paths are of one radius.

They lead to a pose in the start's frame, and drive forward only.
"""

from hav_env.compiled import kernel
from hav_env.compiled.precision import either
from hav_env.maths.dubins import INFEASIBLE, LRL, RLR, word_segments
from hav_env.maths.elementary import atan2, floor, sqrt
from hav_env.maths.geometry import TURNS_PER_RADIAN, TWO_PI

# [rad] an arc that is a whole turn but for this is none at all: in each precision
_ANGLE_ROUNDING = 1e-9, 2e-5


@kernel
def _wrap_positive(angle):
    """Return the angle [rad] moved by whole turns into [0, 2 pi)."""
    turned = floor((angle + either(angle, *_ANGLE_ROUNDING)) * TURNS_PER_RADIAN)
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
    straight = sqrt(max(squared, 0.0))
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
