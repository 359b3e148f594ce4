"""This module measures the free space of a HAV among the present chains of others.

Its results only rank slots: none of the filter's theorems depends on them.
"""

import math

from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import point_segment_squared
from hav_env.safety.gaps import gap_of_bodies
from hav_env.world.chain import ends_behind, front_axle
from hav_env.world.collision import reach, squared_distance, within
from hav_env.world.sensing import (
    drivable_radius,
    neighbor_id,
    num_neighbors,
    unit_length,
    waits,
)

# positions of the front that are tested along a path
LOOKS = 8


@rare_kernel
def gap_to_others(world, agent, most):
    """Return the gap to the nearest chain of another HAV [m], or ``most`` if it is larger."""
    own, least = reach(world.fleet, agent, 0), most
    for k in range(num_neighbors(world, agent, 0)):
        other = neighbor_id(world, agent, k, 0)
        limit = own + reach(world.fleet, other, 0) + least
        if within(squared_distance(world, agent, other, 0), limit):
            least = gap_of_bodies(world.fleet.bodies, world, agent, other, 0, least)
    return least


@kernel
def near_others(world, agent, distance):
    """Return whether another HAV's reach is within a distance [m] of the own reach."""
    own = reach(world.fleet, agent, 0)
    for k in range(num_neighbors(world, agent, 0)):
        other = neighbor_id(world, agent, k, 0)
        limit = own + reach(world.fleet, other, 0) + distance
        if within(squared_distance(world, agent, other, 0), limit):
            return True
    return False


@rare_kernel
def near_chain(policy, world, other, x, y, distance):
    """Return whether the chain of a HAV, or the path just ahead of it, is near a point [m]."""
    fx, fy = front_axle(world, other, 0)
    ahead = 0.0 if waits(world, other, 0) else policy.ahead
    ax = fx + ahead * world.state.cosine[other, 0, 0]
    ay = fy + ahead * world.state.sine[other, 0, 0]
    least = distance * distance
    if point_segment_squared(x, y, ax, ay, fx, fy) < least:
        return True
    ax, ay = fx, fy
    for unit in range(world.fleet.num_trailers[other, 0] + 1):
        bx, by, nx, ny = ends_behind(world, other, unit, 0, ax, ay)
        if point_segment_squared(x, y, ax, ay, bx, by) < least:
            return True
        ax, ay = nx, ny
    return False


@kernel
def is_free(policy, world, agent, x, y, distance):
    """Return whether the chains of all others are farther than a distance from a point [m]."""
    for k in range(num_neighbors(world, agent, 0)):
        other = neighbor_id(world, agent, k, 0)
        dx, dy = world.state.x[other, 0] - x, world.state.y[other, 0] - y
        limit = distance + policy.ahead + reach(world.fleet, other, 0)
        may_be_near = within(dx * dx + dy * dy, limit)
        if may_be_near and near_chain(policy, world, other, x, y, distance):
            return False
    return True


@rare_kernel
def circles(policy, world, agent, side, keep):
    """Return whether the disc of the HAV's circle on a side is free of the other HAVs now."""
    radius = policy.widening * drivable_radius(world, agent, 0)
    cosine, sine = world.state.cosine[agent, 0, 0], world.state.sine[agent, 0, 0]
    x = world.state.x[agent, 0] - side * radius * sine
    y = world.state.y[agent, 0] + side * radius * cosine
    truck = unit_length(world, agent, 0, 0)
    return is_free(policy, world, agent, x, y, math.sqrt(radius * radius + truck * truck) + keep)


@rare_kernel
def free_way(policy, world, agent, turned, keep):
    """Return how far the truck's front can move with a steering before another is near [m]."""
    sine, cosine = sincos(turned)
    truck = unit_length(world, agent, 0, 0)
    x, y = front_axle(world, agent, 0)
    # the front axle moves along the wheels, on a circle of the truck's length over the sine
    fc, fs = world.state.cosine[agent, 0, 0], world.state.sine[agent, 0, 0]
    cx, cy = fc * cosine - fs * sine, fs * cosine + fc * sine
    step = policy.look / LOOKS
    ts, tc = sincos(0.5 * step * sine / truck)
    for count in range(LOOKS):
        cx, cy = cx * tc - cy * ts, cy * tc + cx * ts
        x, y = x + step * cx, y + step * cy
        cx, cy = cx * tc - cy * ts, cy * tc + cx * ts
        if not is_free(policy, world, agent, x, y, max(keep, 0.5 * step)):
            return count * step
    return policy.look
