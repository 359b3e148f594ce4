"""This module casts rays from a HAV's truck: distances to obstacles and to other HAVs.

A ray begins at the truck's rear axle and passes through the HAV's own bodies.
"""

import math

from hav_env.compiled import generic, kernel
from hav_env.world.arrays import World, into_truck_frame
from hav_env.world.bodies import reach_of
from hav_env.world.chain import ends_behind, front_axle
from hav_env.world.place.segments import Obstacles, Plane, segment_of
from hav_env.world.rectangle_bodies import body_of

_TINY = 1e-30  # keeps quotients finite for a ray parallel to a side
_PARALLEL = 1e-6  # [rad], approximate largest angle between a ray and a segment along it
_BESIDE = 20.0 * _PARALLEL  # [rad]
_THIN = 1e-10  # [m], width of a segment or line seen from its end


@kernel
def ahead_of(first, last):
    """Return the smallest length of at least 0 between two lengths [m], inf if there is none."""
    inside = max(first, 0.0)
    return inside if inside <= last else math.inf


@kernel
def to_segment(cosine, sine, x, y, half_x, half_y):
    """Return the length of a ray from the origin to a segment [m], inf if they do not meet.

    For a segment on the ray, it is the length to the nearer end.

    Args:
        cosine: Cosine of the direction of the line.
        sine: Sine of the direction of the line.
        x: x of the middle of the segment [m].
        y: y of the middle of the segment [m].
        half_x: x from the middle to one end [m].
        half_y: y from the middle to one end [m].
    """
    turn = cosine * half_y - sine * half_x
    aside = x * sine - y * cosine
    parallel = abs(turn) <= _PARALLEL * (abs(half_x) + abs(half_y))
    length = (x * half_y - y * half_x) / (1.0 if parallel else turn)
    along, half = x * cosine + y * sine, abs(half_x * cosine + half_y * sine)
    first = along - half if parallel else length
    last = along + half if parallel else length
    meets = abs(aside) <= (_THIN if parallel else abs(turn))
    return ahead_of(first, last) if meets else math.inf


@kernel
def across_segment(cosine, sine, x, y, half_x, half_y):
    """Return the same as ``to_segment`` if no ray may lie along the segment, see below."""
    turn = cosine * half_y - sine * half_x
    aside = x * sine - y * cosine
    meets = abs(aside) <= abs(turn)
    length = (x * half_y - y * half_x) / (turn if meets else 1.0)
    return length if meets & (length >= 0.0) else math.inf


@kernel
def may_lie_along(x, y, half_x, half_y, half):
    """Return whether a ray may meet a segment that is parallel to it, up to rounding.

    The origin is then near the line through the segment: at most ``_PARALLEL`` times the sum of
    their lengths from it. The bound covers rounding in single precision.

    Args:
        x: x of the middle of the segment [m].
        y: y of the middle of the segment [m].
        half_x: x from the middle to one end [m].
        half_y: y from the middle to one end [m].
        half: Half the length of the segment [m].
    """
    return abs(x * half_y - y * half_x) <= _BESIDE * half * (max(abs(x), abs(y)) + half)


@kernel
def to_rectangle(cosine, sine, x, y, along_cosine, along_sine, half, width):
    """Return between which lengths a line through the origin is inside a rectangle [m].

    If it never is, the first length is the larger one.

    Args:
        cosine: Cosine of the direction of the line.
        sine: Sine of the direction of the line.
        x: x of the middle of the rectangle [m].
        y: y of the middle of the rectangle [m].
        along_cosine: Cosine of the direction of the rectangle.
        along_sine: Sine of the direction of the rectangle.
        half: Half its length [m].
        width: Half its width [m].
    """
    forward, left = x * along_cosine + y * along_sine, y * along_cosine - x * along_sine
    ahead = cosine * along_cosine + sine * along_sine
    aside = sine * along_cosine - cosine * along_sine
    per_ahead = 1.0 / (ahead if abs(ahead) > _TINY else _TINY)
    per_aside = 1.0 / (aside if abs(aside) > _TINY else _TINY)
    middle, reach = forward * per_ahead, (half + _THIN) * abs(per_ahead)
    across, breadth = left * per_aside, (width + _THIN) * abs(per_aside)
    return max(middle - reach, across - breadth), min(middle + reach, across + breadth)


@kernel
def ray(world: World, agent: int, cosine: float, sine: float, most: float, lane: int) -> float:
    """Return the distance to obstacles and other HAVs' bodies in a direction from the truck [m].

    It is at most ``most`` [m]. The direction is (1, 0) forward, (0, 1) to the left.
    """
    to_obstacle = _to_obstacles(world.place, world, agent, cosine, sine, lane)
    return min(to_obstacle, _to_havs(world, agent, cosine, sine, most, lane), most)


@generic
def _to_obstacles(place, world, agent, cosine, sine, lane):
    """Return the distance [m] of the nearest obstacle in a direction of the truck frame, or inf."""


@_to_obstacles.register(Plane)
def _endless(place, world, agent, cosine, sine, lane):
    return math.inf


@_to_obstacles.register(Obstacles)
def _to_nearest_segment(place, world, agent, cosine, sine, lane):
    nearest = math.inf
    for number in range(place.count[lane]):
        x, y, half_x, half_y = seen_segment(place, world, agent, number, lane)
        nearest = min(nearest, to_segment(cosine, sine, x, y, half_x, half_y))
    return nearest


@kernel
def seen_segment(place, world, agent, number, lane):
    """Return a segment in the truck's frame: its middle, and the vector to one end [m]."""
    state = world.state
    x, y, cosine, sine, half, _ = segment_of(place, number, lane)
    forward, left = into_truck_frame(
        state, agent, lane, x - state.x[agent, lane], y - state.y[agent, lane]
    )
    half_forward, half_left = into_truck_frame(state, agent, lane, half * cosine, half * sine)
    return forward, left, half_forward, half_left


@kernel
def seen_body(world, agent, other, unit, lane, front_x, front_y):
    """Return the body of a unit of another HAV in the truck's frame, given its front end [m]."""
    state = world.state
    x, y, cosine, sine, half, width = body_of(
        world.fleet.bodies, world, other, unit, lane, front_x, front_y
    )
    forward, left = into_truck_frame(
        state, agent, lane, x - state.x[agent, lane], y - state.y[agent, lane]
    )
    ahead, aside = into_truck_frame(state, agent, lane, cosine, sine)
    return forward, left, ahead, aside, half, width


@kernel
def _to_havs(world, agent, cosine, sine, most, lane):
    """Return the distance of the nearest other HAV in a direction of the truck's frame [m], or inf.

    HAVs that are farther than ``most`` [m] do not count.
    """
    nearest = math.inf
    for other in range(world.state.x.shape[0]):
        if other != agent and may_be_within(world, agent, other, most, lane):
            x, y = front_axle(world, other, lane)
            for unit in range(world.fleet.num_trailers[other, lane] + 1):
                body = seen_body(world, agent, other, unit, lane, x, y)
                nearest = min(nearest, ahead_of(*to_rectangle(cosine, sine, *body)))
                _, _, x, y = ends_behind(world, other, unit, lane, x, y)
    return nearest


@kernel
def may_be_within(world, agent, other, most, lane):
    """Return whether any point of another HAV may be within a distance of the own rear axle [m]."""
    dx = world.state.x[other, lane] - world.state.x[agent, lane]
    dy = world.state.y[other, lane] - world.state.y[agent, lane]
    within = most + reach_of(world.fleet.bodies, world.fleet, other, lane)
    return dx * dx + dy * dy <= within * within
