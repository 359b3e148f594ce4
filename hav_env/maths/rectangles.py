"""This module computes on rectangles in the plane: whether two share a point, the nearest point.

A rectangle has a middle (x, y) [m], a direction along it (cosine, sine), half a length along that
direction and half a width across [m]. Either may be zero: the rectangle is then a segment, or a
point.
"""

from hav_env.compiled import kernel
from hav_env.maths.geometry import clip, into_frame

_ROUNDING = 0.01  # [m], more than the rounding error of distances in either precision


@kernel
def _gap_beside(dx, dy, cosine, sine, length, width, turn_cosine, turn_sine, other):
    """Return the larger gap between two rectangles along the normals of one of them [m].

    Args:
        dx: x from the middle of this one to that of the other [m].
        dy: y from the middle of this one to that of the other [m].
        cosine: Cosine of the direction of this one.
        sine: Sine of the direction of this one.
        length: Half its length [m].
        width: Half its width [m].
        turn_cosine: Cosine of the angle between both, as an absolute value.
        turn_sine: Sine of the angle between both, as an absolute value.
        other: Half the length and half the width of the other [m].
    """
    forward, left = into_frame(dx, dy, cosine, sine)
    along = other[0] * turn_cosine + other[1] * turn_sine
    across = other[0] * turn_sine + other[1] * turn_cosine
    return max(abs(forward) - length - along, abs(left) - width - across)


@kernel
def rectangle_gap(one, other):
    """Return the largest gap between two rectangles along a normal of a side [m].

    They share a point if and only if it is not above zero, by the separating axis theorem. It never
    exceeds their distance, and equals it if the nearest point of one is opposite a side of the
    other.

    Args:
        one: X, y, cosine, sine, half length, half width.
        other: x, y, cosine, sine, half length, half width.
    """
    x, y, cosine, sine, length, width = one
    other_x, other_y, other_cosine, other_sine, other_length, other_width = other
    dx, dy = other_x - x, other_y - y
    turn_cosine, turn_sine = into_frame(other_cosine, other_sine, cosine, sine)
    turn_cosine, turn_sine = abs(turn_cosine), abs(turn_sine)
    turn = turn_cosine, turn_sine
    return max(
        _gap_beside(dx, dy, cosine, sine, length, width, *turn, (other_length, other_width)),
        _gap_beside(
            *(dx, dy, other_cosine, other_sine, other_length, other_width), *turn, (length, width)
        ),
    )


@kernel
def rectangle_box(rectangle):
    """Return the box round a rectangle: least x, greatest x, likewise y [m]."""
    x, y, cosine, sine, length, width = rectangle
    across = abs(cosine) * length + abs(sine) * width
    up = abs(sine) * length + abs(cosine) * width
    return x - across, x + across, y - up, y + up


@kernel
def may_overlap(one, other):
    """Return whether two rectangles are so near that they may share a point, up to rounding.

    The sum of half the length and half the width is at least half the diagonal.
    """
    dx, dy = other[0] - one[0], other[1] - one[1]
    limit = one[4] + one[5] + other[4] + other[5] + _ROUNDING
    return dx * dx + dy * dy <= limit * limit


@kernel
def nearest_on_rectangle(rectangle, px, py):
    """Return the point of a rectangle that is nearest to p [m]: p itself where p is inside."""
    x, y, cosine, sine, length, width = rectangle
    forward, left = into_frame(px - x, py - y, cosine, sine)
    forward, left = clip(forward, -length, length), clip(left, -width, width)
    return x + forward * cosine - left * sine, y + forward * sine + left * cosine
