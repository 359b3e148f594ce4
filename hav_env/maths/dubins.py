"""This module computes Dubins paths, the shortest paths of a point that drives forward and turns.

The frame is that of the start pose. In it, the path is a function of the goal (forward, left,
heading) and the radius alone. A path is one of six words of three segments. The words of Dubins
(1957) follow here from the centres of the start's and the goal's circles. Words have an outer
tangent (LSL, RSR), an inner tangent (LSR, RSL) or a third circle that touches both (RLR, LRL).

The search has no branch, so loops over lanes may call it. It computes all six words and selects the
shortest.
"""

import math

from hav_env.compiled import either, kernel
from hav_env.maths.elementary import atan2, atan2_positive, sincos, sqrt
from hav_env.maths.geometry import TWO_PI, wrap

LSL, RSR, LSR, RSL, RLR, LRL = range(6)
WORDS = ("LSL", "RSR", "LSR", "RSL", "RLR", "LRL")
INFEASIBLE = math.inf
# rounding error of a zero angle [rad] or tangent [radii], in double and in single precision
_ROUNDING = 1e-12, 2e-5


@kernel
def turns(word):
    """Return the side of each segment of a word: 1.0 left, -1.0 right, 0.0 straight."""
    first = 1.0 if (word == LSL) | (word == LSR) | (word == LRL) else -1.0
    middle = -first if word >= RLR else 0.0
    last = -first if (word == LSR) | (word == RSL) else first
    return first, middle, last


@kernel
def _turn_angle(angle):
    """Return the angle [rad], which is in [-4 pi, 2 pi), moved by whole turns into [0, 2 pi).

    Rounding may turn a zero angle into -1e-17; a vehicle on its path would then drive a full circle
    first. An angle slightly below a whole turn therefore becomes 0.
    """
    angle = angle + TWO_PI if angle < -either(angle, *_ROUNDING) else angle
    angle = angle + TWO_PI if angle < -either(angle, *_ROUNDING) else angle
    return max(angle, 0.0)


@kernel
def _outer_tangent(across_x, across_y, heading):
    """Return the path of two left turns and a straight; ``across`` joins the circles' centres."""
    straight = sqrt(across_x * across_x + across_y * across_y)
    towards = atan2(across_y, across_x)
    # start and goal on one circle: the first turn is the whole path
    first = _turn_angle(heading if straight < either(straight, *_ROUNDING) else towards)
    return first, straight, _turn_angle(heading - first)


@kernel
def _inner_tangent(across_x, across_y, heading):
    """Return the path of a left turn, a straight that changes sides, and a right turn."""
    squared = across_x * across_x + across_y * across_y - 4.0
    straight = sqrt(max(squared, 0.0))  # circles that touch: no straight between them
    first = _turn_angle(
        atan2(across_y * straight + 2.0 * across_x, across_x * straight - 2.0 * across_y)
    )
    last = _turn_angle(first - heading - TWO_PI)
    return INFEASIBLE if squared < -either(squared, *_ROUNDING) else first, straight, last


@kernel
def _third_circle(towards, across, heading):
    """Return the path of a left turn, a right turn of more than half a circle, and a left turn.

    The centres of the start's and the goal's left circle are those of the word LSL. ``across`` is
    their distance [radii], ``towards`` the direction from one to the other.
    """
    left_over = 16.0 - across * across
    middle = TWO_PI - 2.0 * atan2_positive(across, sqrt(max(left_over, 0.0)))
    first = _turn_angle(towards + 0.5 * middle - TWO_PI)
    last = _turn_angle(heading - first + middle - TWO_PI)
    return INFEASIBLE if left_over < 0.0 else first, middle, last


@kernel
def word_segments(word, forward, left, heading, radius):
    """Return the three segments of one word: angles [rad] of turns, radii of a straight.

    A word that starts to the right is the mirror image of one that starts to the left. The first
    segment is ``INFEASIBLE`` if the word does not reach the goal.
    """
    side, _, _ = turns(word)
    x, y, heading = forward / radius, side * left / radius, side * wrap(heading)
    sine, cosine = sincos(heading)
    if word in (LSR, RSL):
        return _inner_tangent(x + sine, y - cosine - 1.0, heading)
    first, straight, last = _outer_tangent(x - sine, y + cosine - 1.0, heading)
    if word in (RLR, LRL):
        return _third_circle(first, straight, heading)
    return first, straight, last


@kernel
def shortest_path(forward, left, heading, radius):
    """Return the shortest Dubins path to a goal pose in the frame of the start pose.

    Args:
        forward: Goal's position along the start's heading [m].
        left: Goal's position to the left of that [m].
        heading: Goal's heading minus the start's [rad].
        radius: Radius of all turns [m], positive.

    Returns:
        (word, first, second, third): the index into ``WORDS`` and the lengths of the three segments
        [m]. Among equally short words, the first one in the order of ``WORDS``.
    """
    heading = wrap(heading)
    sine, cosine = sincos(heading)
    return shortest_path_towards(forward, left, heading, cosine, sine, radius)


@kernel
def _shorter(path, word, segments):
    """Return (total, word, first, second, third) of the shorter one; if equal, of ``path``."""
    least, best, first, second, third = path
    a, b, c = segments
    total = a + b + c
    better = total < least
    return (
        total if better else least,
        word if better else best,
        a if better else first,
        b if better else second,
        c if better else third,
    )


@kernel
def shortest_path_towards(forward, left, heading, cosine, sine, radius):
    """Return ``shortest_path`` to a heading in [-pi, pi) whose cosine and sine are known."""
    per_radius = 1.0 / radius
    x, y = forward * per_radius, left * per_radius
    left_turns = _outer_tangent(x - sine, y + cosine - 1.0, heading)
    right_turns = _outer_tangent(x + sine, cosine - y - 1.0, -heading)
    path = left_turns[0] + left_turns[1] + left_turns[2], LSL, *left_turns
    path = _shorter(path, RSR, right_turns)
    path = _shorter(path, LSR, _inner_tangent(x + sine, y - cosine - 1.0, heading))
    path = _shorter(path, RSL, _inner_tangent(x - sine, -y - cosine - 1.0, -heading))
    path = _shorter(path, RLR, _third_circle(right_turns[0], right_turns[1], -heading))
    path = _shorter(path, LRL, _third_circle(left_turns[0], left_turns[1], heading))
    _, word, first, second, third = path
    return word, first * radius, second * radius, third * radius


@kernel
def path_length(forward, left, heading, radius):
    """Return the length [m] of the shortest Dubins path; arguments as in ``shortest_path``."""
    _, first, second, third = shortest_path(forward, left, heading, radius)
    return first + second + third


@kernel
def pose_after_segment(x, y, heading, turn, length, radius):
    """Return the pose after one segment: a straight, or an arc to the side ``turn``."""
    sine, cosine = sincos(heading)
    if turn == 0.0:
        return x + length * cosine, y + length * sine, heading
    turned = heading + turn * length / radius
    sine_then, cosine_then = sincos(turned)
    side = turn * radius
    return x + side * (sine_then - sine), y - side * (cosine_then - cosine), turned


@kernel
def pose_on_path(word, first, second, third, radius, distance):
    """Return the pose (forward, left, heading) after ``distance`` [m], clipped to the path.

    The segments are those of ``shortest_path``; the heading [rad] is not wrapped.
    """
    sides = turns(word)
    distance = max(distance, 0.0)
    x, y, heading = pose_after_segment(0.0, 0.0, 0.0, sides[0], min(distance, first), radius)
    distance = max(distance - first, 0.0)
    x, y, heading = pose_after_segment(x, y, heading, sides[1], min(distance, second), radius)
    distance = max(distance - second, 0.0)
    return pose_after_segment(x, y, heading, sides[2], min(distance, third), radius)
