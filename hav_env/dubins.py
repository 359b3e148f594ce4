"""Dubins paths: the shortest way to a pose for a point that drives forward and turns at a radius.

Everything is in the frame of the start pose, where the path is a function of the goal (forward,
left, heading) and the radius alone. A path is one of six words of three segments. The words of
Dubins (1957) follow here from the centres of the start's and the goal's circles: an outer tangent
(LSL, RSR), an inner tangent (LSR, RSL) or a third circle that touches both (RLR, LRL).
"""

import math

from hav_env.compiled import kernel
from hav_env.geometry import TWO_PI, wrap

LSL, RSR, LSR, RSL, RLR, LRL = range(6)
WORDS = ("LSL", "RSR", "LSR", "RSL", "RLR", "LRL")
# The side of each segment of each word: 1 left, -1 right, 0 straight.
TURNS = ((1, 0, 1), (-1, 0, -1), (1, 0, -1), (-1, 0, 1), (-1, 1, -1), (1, -1, 1))
INFEASIBLE = math.inf
_ROUNDING = 1e-12  # what rounding leaves of a zero angle [rad] or tangent [radii]


@kernel
def _turn_angle(angle):
    """Return the angle [rad], which is in [-4 pi, 4 pi), moved by whole turns into [0, 2 pi).

    Rounding may leave -1e-17 of an angle that is zero; a vehicle that is on its way would then
    drive a full circle first. So almost a turn is none.
    """
    angle = angle + TWO_PI if angle < 0.0 else angle
    angle = angle + TWO_PI if angle < 0.0 else angle
    angle = angle - TWO_PI if angle >= TWO_PI else angle
    return 0.0 if angle > TWO_PI - _ROUNDING else angle


@kernel
def _outer_tangent(across_x, across_y, heading):
    """Two left turns joined by a straight: the circles' centres lie ``across`` from each other."""
    straight = math.sqrt(across_x * across_x + across_y * across_y)
    if straight < _ROUNDING:  # start and goal on one circle: the first turn does it all
        return _turn_angle(heading), 0.0, 0.0
    first = _turn_angle(math.atan2(across_y, across_x))
    return first, straight, _turn_angle(heading - first)


@kernel
def _inner_tangent(across_x, across_y, heading):
    """A left turn, a straight that changes sides, a right turn."""
    squared = across_x * across_x + across_y * across_y - 4.0
    if squared < -_ROUNDING:
        return INFEASIBLE, 0.0, 0.0
    straight = math.sqrt(max(squared, 0.0))  # circles that touch: no straight between them
    first = _turn_angle(
        math.atan2(
            across_y * straight + 2.0 * across_x,
            across_x * straight - 2.0 * across_y,
        )
    )
    return first, straight, _turn_angle(first - heading)


@kernel
def _third_circle(towards, across, heading):
    """A left turn, a right turn of more than half a circle, a left turn.

    The centres of the start's and the goal's left circle are those of the word LSL: ``across``
    from each other [radii], ``towards`` the direction from one to the other.
    """
    squared = across * across
    if squared > 16.0:
        return INFEASIBLE, 0.0, 0.0
    middle = TWO_PI - 2.0 * math.atan2(across, math.sqrt(16.0 - squared))
    first = _turn_angle(towards + 0.5 * middle)
    return first, middle, _turn_angle(heading - first + middle)


@kernel
def word_segments(word, forward, left, heading, radius):
    """Return the three segments of one word: angles [rad] of turns, radii of a straight.

    A word that starts to the right is the mirror image of one that starts to the left. The first
    segment is ``INFEASIBLE`` when the word does not reach the goal.
    """
    side = 1.0 if word in (LSL, LSR, LRL) else -1.0
    x, y, heading = forward / radius, side * left / radius, side * wrap(heading)
    sine, cosine = math.sin(heading), math.cos(heading)
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
        forward, left: the goal's position [m].
        heading: the goal's heading less the start's [rad].
        radius: of all turns [m], positive.

    Returns:
        (word, first, second, third): the index into ``WORDS`` and the lengths of the three
        segments [m]. Equally short words: the first one in the order of ``WORDS``.
    """
    heading = wrap(heading)
    return shortest_path_towards(
        forward, left, heading, math.cos(heading), math.sin(heading), radius
    )


@kernel
def shortest_path_towards(forward, left, heading, cosine, sine, radius):
    """Return ``shortest_path`` to a heading in [-pi, pi) whose cosine and sine are known."""
    x, y = forward / radius, left / radius
    left_first, left_across, left_last = _outer_tangent(x - sine, y + cosine - 1.0, heading)
    right_first, right_across, right_last = _outer_tangent(x + sine, cosine - y - 1.0, -heading)
    word, first, second, third = LSL, left_first, left_across, left_last
    shortest = first + second + third
    a, b, c = right_first, right_across, right_last
    if a + b + c < shortest:
        word, first, second, third, shortest = RSR, a, b, c, a + b + c
    a, b, c = _inner_tangent(x + sine, y - cosine - 1.0, heading)
    if a + b + c < shortest:
        word, first, second, third, shortest = LSR, a, b, c, a + b + c
    a, b, c = _inner_tangent(x - sine, -y - cosine - 1.0, -heading)
    if a + b + c < shortest:
        word, first, second, third, shortest = RSL, a, b, c, a + b + c
    a, b, c = _third_circle(right_first, right_across, -heading)
    if a + b + c < shortest:
        word, first, second, third, shortest = RLR, a, b, c, a + b + c
    a, b, c = _third_circle(left_first, left_across, heading)
    if a + b + c < shortest:
        word, first, second, third = LRL, a, b, c
    return word, first * radius, second * radius, third * radius


@kernel
def path_length(forward, left, heading, radius):
    """Return the length [m] of the shortest Dubins path; arguments as in ``shortest_path``."""
    _, first, second, third = shortest_path(forward, left, heading, radius)
    return first + second + third


@kernel
def _advance(x, y, heading, turn, length, radius):
    """Drive one segment: a straight, or an arc to the side ``turn``."""
    if turn == 0:
        return x + length * math.cos(heading), y + length * math.sin(heading), heading
    turned = heading + turn * length / radius
    side = turn * radius
    x += side * (math.sin(turned) - math.sin(heading))
    y -= side * (math.cos(turned) - math.cos(heading))
    return x, y, turned


@kernel
def pose_on_path(word, first, second, third, radius, distance):
    """Return the pose (forward, left, heading) after ``distance`` [m], which is cut at both ends.

    The segments are those of ``shortest_path``; the heading [rad] is not wrapped.
    """
    turns = TURNS[word]
    distance = max(distance, 0.0)
    x, y, heading = _advance(0.0, 0.0, 0.0, turns[0], min(distance, first), radius)
    distance = max(distance - first, 0.0)
    x, y, heading = _advance(x, y, heading, turns[1], min(distance, second), radius)
    distance = max(distance - second, 0.0)
    return _advance(x, y, heading, turns[2], min(distance, third), radius)
