"""This module makes outlines (k-DOPs): convex polygons given by their extent in 24 directions.

An outline occupies ``SIDES`` rows of an array. Entry k is the largest value of x cos(a) + y sin(a)
[m] over all included points, at the angle a of side k. It contains all their convex combinations.
For a disc of radius r it exceeds the disc by at most 0.9 % of r, at its corners. The included
points touch every side, so neighbouring sides meet in the corners.

Functions work on a slice of the rows, so compiled code knows that no index is negative.
"""

import math

import numpy as np

from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import atan2, sincos
from hav_env.maths.geometry import TWO_PI

SIDES = 24
_ANGLE = TWO_PI / SIDES  # angle between neighbouring sides
_ANGLES = [_ANGLE * k for k in range(SIDES)]
# arrays: compiled code would search a tuple element by element
_COSINES = np.array([math.cos(angle) for angle in _ANGLES])
_SINES = np.array([math.sin(angle) for angle in _ANGLES])
_SIDE_COSINE, _SIDE_SINE = math.cos(_ANGLE), math.sin(_ANGLE)


@kernel
def clear_outline(rows, outline):
    """Begin an outline that contains nothing."""
    sides = rows[outline : outline + SIDES]
    for side in range(SIDES):
        sides[side] = -math.inf


@kernel
def include_point(rows, outline, x, y):
    """Include a point [m]."""
    sides = rows[outline : outline + SIDES]
    for side in range(SIDES):
        sides[side] = max(sides[side], x * _COSINES[side] + y * _SINES[side])


@kernel
def include_both(rows, outline, ax, ay, bx, by):
    """Include two points [m] at once: in half of the time, because one waits for the other."""
    sides = rows[outline : outline + SIDES]
    for side in range(SIDES):
        both = max(ax * _COSINES[side] + ay * _SINES[side], bx * _COSINES[side] + by * _SINES[side])
        sides[side] = max(sides[side], both)


@rare_kernel
def include_disc(rows, outline, x, y, radius):
    """Include a disc [m]."""
    sides = rows[outline : outline + SIDES]
    for side in range(SIDES):
        sides[side] = max(sides[side], x * _COSINES[side] + y * _SINES[side] + radius)


@kernel
def widen(rows, outline, margin):
    """Move all sides of an outline outwards [m]: it then contains all points that are so near."""
    sides = rows[outline : outline + SIDES]
    for side in range(SIDES):
        sides[side] += margin


@rare_kernel
def outside(rows, outline, x, y):
    """Return the signed distance of a point from the farthest side [m]; negative inside."""
    sides, farthest = rows[outline : outline + SIDES], -math.inf
    for side in range(SIDES):
        farthest = max(farthest, x * _COSINES[side] + y * _SINES[side] - sides[side])
    return farthest


@kernel
def corner(rows, outline, side):
    """Return the corner [m] between a side and the next one."""
    after = side + 1 if side + 1 < SIDES else 0
    out = rows[outline + side]
    along = (rows[outline + after] - out * _SIDE_COSINE) / _SIDE_SINE
    return (
        out * _COSINES[side] - along * _SINES[side],
        out * _SINES[side] + along * _COSINES[side],
    )


@rare_kernel
def turn_outline(rows, outline, others, other, x, y, cosine, sine):
    """Write the outline of another outline that is given in a frame.

    Args:
        rows: Array for the new outline, which contains the other one and a little more.
        outline: Index of its first row in ``rows``.
        others: Array that holds the other outline, in its own frame.
        other: Index of its first row in ``others``.
        x: X of that frame's origin [m].
        y: Y of that frame's origin [m].
        cosine: Cosine of that frame's heading.
        sine: Sine of that frame's heading.
    """
    heading = atan2(sine, cosine)
    heading += TWO_PI if heading < 0.0 else 0.0
    passed = min(int(heading / _ANGLE), SIDES - 1)
    rest = heading - passed * _ANGLE  # angle of the frame's heading beyond a side
    # the corner that is farthest in the direction of a new side is between two sides of the other
    # outline
    before, _ = sincos(rest)
    behind, _ = sincos(_ANGLE - rest)
    before, behind = before / _SIDE_SINE, behind / _SIDE_SINE
    sides, seen = rows[outline : outline + SIDES], others[other : other + SIDES]
    for side in range(SIDES):
        at = side - passed + (SIDES if side < passed else 0)
        previous = at - 1 if at > 0 else SIDES - 1
        turned = before * seen[previous] + behind * seen[at]
        sides[side] = x * _COSINES[side] + y * _SINES[side] + turned


@rare_kernel
def outline_gap(rows, outline, other):
    """Return the widest gap [m] between two outlines across one of the 24 directions.

    Both are in one frame. The outlines are at least so far apart; if the gap is negative, they may
    overlap.
    """
    half, quarter = SIDES // 2, SIDES // 4
    sides, others = rows[outline : outline + SIDES], rows[other : other + SIDES]
    first = second = third = fourth = -math.inf  # four, because each maximum waits for the last one
    for side in range(quarter):
        first = max(first, -sides[side] - others[half + side])
        second = max(second, -sides[quarter + side] - others[half + quarter + side])
        third = max(third, -sides[half + side] - others[side])
        fourth = max(fourth, -sides[half + quarter + side] - others[quarter + side])
    return max(first, second, third, fourth)
