"""This module computes plane geometry on floats: angles, frames, segments, hulls."""

import math

from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import floor

TWO_PI = 2.0 * math.pi
TURNS_PER_RADIAN = 1.0 / TWO_PI


@kernel
def wrap(angle):
    """Return the angle [rad] moved by whole turns into [-pi, pi), up to rounding."""
    return angle - TWO_PI * floor((angle + math.pi) * TURNS_PER_RADIAN)


@kernel
def clip(value, low, high):
    """Return the value clipped to [low, high]."""
    return min(max(value, low), high)


@kernel
def into_frame(dx, dy, cosine, sine):
    """Rotate a difference of positions [m] into the frame of a heading: (forward, left)."""
    return dx * cosine + dy * sine, dy * cosine - dx * sine


@kernel
def nearest_on_segment(ax, ay, dx, dy, length, px, py):
    """Return the point nearest to p on the segment from a that is ``length`` long.

    (dx, dy) is the segment's direction, of length 1.
    """
    along = clip((px - ax) * dx + (py - ay) * dy, 0.0, length)
    return ax + along * dx, ay + along * dy


@kernel
def _side(ax, ay, bx, by, px, py):
    """Return a number > 0 if p is left of the line a -> b, < 0 if right, 0 if on it."""
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@kernel
def _in_box(ax, ay, bx, by, px, py):
    return min(ax, bx) <= px <= max(ax, bx) and min(ay, by) <= py <= max(ay, by)


@kernel
def segments_intersect(ax, ay, bx, by, cx, cy, dx, dy):
    """Return whether the segments a-b and c-d have a point in common; touching counts."""
    c_side, d_side = _side(ax, ay, bx, by, cx, cy), _side(ax, ay, bx, by, dx, dy)
    a_side, b_side = _side(cx, cy, dx, dy, ax, ay), _side(cx, cy, dx, dy, bx, by)
    crossed = (c_side < 0 < d_side or d_side < 0 < c_side) and (
        a_side < 0 < b_side or b_side < 0 < a_side
    )
    return (
        crossed
        or (c_side == 0 and _in_box(ax, ay, bx, by, cx, cy))
        or (d_side == 0 and _in_box(ax, ay, bx, by, dx, dy))
        or (a_side == 0 and _in_box(cx, cy, dx, dy, ax, ay))
        or (b_side == 0 and _in_box(cx, cy, dx, dy, bx, by))
    )


@kernel
def point_segment_squared(px, py, ax, ay, bx, by):
    """Return the squared distance [m^2] from p to the segment a-b, which may be a point."""
    dx, dy = bx - ax, by - ay
    squared = dx * dx + dy * dy
    along = (px - ax) * dx + (py - ay) * dy
    share = clip(along / squared, 0.0, 1.0) if squared > 0.0 else 0.0
    x, y = ax + share * dx - px, ay + share * dy - py
    return x * x + y * y


@kernel
def squared_gap(ax, ay, bx, by, cx, cy, dx, dy):
    """Return the squared distance [m^2] between the segments a-b and c-d, which may be points."""
    if segments_intersect(ax, ay, bx, by, cx, cy, dx, dy):
        return 0.0
    return min(
        point_segment_squared(ax, ay, cx, cy, dx, dy),
        point_segment_squared(bx, by, cx, cy, dx, dy),
        point_segment_squared(cx, cy, ax, ay, bx, by),
        point_segment_squared(dx, dy, ax, ay, bx, by),
    )


@kernel
def segments_apart(ax, ay, bx, by, cx, cy, dx, dy, margin):
    """Return whether the segments a-b and c-d keep more than a margin [m] from each other."""
    if (
        max(ax, bx) + margin < min(cx, dx)
        or max(cx, dx) + margin < min(ax, bx)
        or max(ay, by) + margin < min(cy, dy)
        or max(cy, dy) + margin < min(ay, by)
    ):
        return True
    squared = margin * margin
    return (
        point_segment_squared(ax, ay, cx, cy, dx, dy) > squared
        and point_segment_squared(bx, by, cx, cy, dx, dy) > squared
        and point_segment_squared(cx, cy, ax, ay, bx, by) > squared
        and point_segment_squared(dx, dy, ax, ay, bx, by) > squared
        and not segments_intersect(ax, ay, bx, by, cx, cy, dx, dy)
    )


@rare_kernel
def hull_apart(rows, place, count, ax, ay, bx, by, margin):
    """Return whether the convex hull of points keeps more than a margin [m] from the segment a-b.

    Args:
        rows: Array that holds the points, x and y [m] one after the other.
        place: Index of the first point's x in ``rows``.
        count: Number of points.
        ax: X of the segment's first end [m].
        ay: Y of the segment's first end [m].
        bx: X of the segment's second end [m].
        by: Y of the segment's second end [m].
        margin: Distance to exceed [m].
    """
    for i in range(count):
        px, py = rows[place + 2 * i], rows[place + 2 * i + 1]
        for j in range(i + 1, count):
            qx, qy = rows[place + 2 * j], rows[place + 2 * j + 1]
            if not segments_apart(px, py, qx, qy, ax, ay, bx, by, margin):
                return False
            for k in range(j + 1, count):  # no edge is near: the segment may be inside
                if _in_triangle(
                    px, py, qx, qy, rows[place + 2 * k], rows[place + 2 * k + 1], ax, ay
                ):
                    return False
    return True


@kernel
def _in_triangle(ax, ay, bx, by, cx, cy, px, py):
    one, two = _side(ax, ay, bx, by, px, py), _side(bx, by, cx, cy, px, py)
    three = _side(cx, cy, ax, ay, px, py)
    return (one > 0 and two > 0 and three > 0) or (one < 0 and two < 0 and three < 0)
