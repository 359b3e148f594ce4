"""This module follows routes segment by segment: straights and arcs of the truck's rear axle.

A route is a column of ``guidance.route``; ``hav_env.world.place.guidance`` defines its rows.
"""

import math

from hav_env.compiled import kernel
from hav_env.maths.dubins import pose_after_segment, shortest_path, turns
from hav_env.maths.elementary import atan2, sincos
from hav_env.maths.geometry import clip, into_frame, wrap
from hav_env.world.place.guidance import (
    BENT,
    FROM_HEADING,
    FROM_X,
    FROM_Y,
    LEFT,
    REST,
    ROUTE_CURVATURE,
    ROUTE_DIRECT,
    ROUTE_DRIVEN,
    ROUTE_KNOWN,
    ROUTE_LENGTH,
    ROUTE_TURN,
    STAYS,
)

_PASSED = 1.0  # [m] behind the goal, where a route ends
NEGLIGIBLE = 1e-3  # [m]; shorter segments are skipped
# distances within which a truck turns to the heading of its route and returns to the route [m]; the
# steepest angle of the return [rad]
_TURNS_WITHIN, _RETURNS_WITHIN, _STEEPEST_RETURN = 2.5, 6.0, 1.0


@kernel
def begin_segment(route, agent, lane, pose, side, length, rest):
    """Begin a segment in a pose (x, y [m], heading [rad]); ``rest`` is the length behind it [m]."""
    x, y, heading = pose
    route[agent, FROM_X, lane], route[agent, FROM_Y, lane] = x, y
    route[agent, FROM_HEADING, lane] = heading
    route[agent, ROUTE_TURN, lane], route[agent, ROUTE_LENGTH, lane] = side, length
    route[agent, REST, lane], route[agent, ROUTE_DRIVEN, lane] = rest, 0.0
    route[agent, ROUTE_KNOWN, lane] = 1.0


@kernel
def segment_to_begin_with(word, first, second, third):
    """Return side and length [m] of the first segment of a Dubins path that is not negligible."""
    one, two, three = turns(word)
    side = two if second >= NEGLIGIBLE else three
    side = one if first >= NEGLIGIBLE else side
    length = second if second >= NEGLIGIBLE else third
    length = first if first >= NEGLIGIBLE else length
    return side, length


@kernel
def begin_direct(route, agent, lane, pose, goal, radius):
    """Begin the Dubins path from a pose to a goal pose, as the rest of the route."""
    x, y, heading = pose
    sine, cosine = sincos(heading)
    forward, left = into_frame(goal[0] - x, goal[1] - y, cosine, sine)
    word, first, second, third = shortest_path(forward, left, goal[2] - heading, radius)
    side, length = segment_to_begin_with(word, first, second, third)
    begin_segment(route, agent, lane, pose, side, length, first + second + third - length)
    route[agent, BENT, lane], route[agent, ROUTE_DIRECT, lane] = radius, 1.0


@kernel
def end_of_segment(route, agent, lane):
    """Return the pose at the end of the current segment."""
    x, y = route[agent, FROM_X, lane], route[agent, FROM_Y, lane]
    heading, side = route[agent, FROM_HEADING, lane], route[agent, ROUTE_TURN, lane]
    length, radius = route[agent, ROUTE_LENGTH, lane], route[agent, BENT, lane]
    return pose_after_segment(x, y, heading, side, length, radius)


@kernel
def note_progress(route, agent, lane, x, y, heading):
    """Update the progress of a truck on the current segment, and the curvature that follows it.

    Returns:
        (off, turned): the truck's distance to the left of the route [m], and its turn to the left
        of the route [rad].
    """
    start, side = route[agent, FROM_HEADING, lane], route[agent, ROUTE_TURN, lane]
    radius = route[agent, BENT, lane]
    sine, cosine = sincos(start)
    dx, dy = x - route[agent, FROM_X, lane], y - route[agent, FROM_Y, lane]
    forward, left = into_frame(dx, dy, cosine, sine)
    driven, off, along, bend = forward, left, start, 0.0
    if side != 0.0:
        # relative to the circle's centre, in a frame where the truck starts at angle 0 and turns
        # left
        outward, onward = radius - side * left, forward
        before = route[agent, ROUTE_DRIVEN, lane] / radius
        angle = before + wrap(atan2(onward, outward) - before)
        distance = math.sqrt(outward * outward + onward * onward)
        driven, off, along = radius * angle, side * (radius - distance), start + side * angle
        bend = side / radius
    turned = wrap(heading - along)
    back = clip(-off / _RETURNS_WITHIN, -_STEEPEST_RETURN, _STEEPEST_RETURN)
    route[agent, ROUTE_DRIVEN, lane] = driven
    route[agent, STAYS, lane] = max(route[agent, ROUTE_LENGTH, lane] - driven, 0.0)
    left_over = route[agent, ROUTE_LENGTH, lane] - driven + route[agent, REST, lane]
    route[agent, LEFT, lane] = max(left_over, 0.0)
    route[agent, ROUTE_CURVATURE, lane] = bend + (back - turned) / _TURNS_WITHIN
    return off, turned


@kernel
def is_at_end(route, agent, lane):
    """Return whether the truck has reached the end of the current segment."""
    return route[agent, ROUTE_DRIVEN, lane] >= route[agent, ROUTE_LENGTH, lane] - NEGLIGIBLE


@kernel
def is_past(route, agent, lane):
    """Return whether a truck has driven past the end of its route."""
    ended = route[agent, REST, lane] < NEGLIGIBLE
    return ended and route[agent, ROUTE_DRIVEN, lane] > route[agent, ROUTE_LENGTH, lane] + _PASSED
