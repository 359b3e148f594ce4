"""This module is the Dubins pursuit, the paper's Algorithm 1 as a policy.

It is goal attraction alone, and ignores trailers and neighbours. Where the guidance has a route, it
keeps to the route instead.
"""

from typing import NamedTuple

from hav_env.compiled import kernel
from hav_env.maths.dubins import shortest_path_towards, turns
from hav_env.maths.elementary import atan2
from hav_env.maths.geometry import clip
from hav_env.models.quantities import Distance, Factor
from hav_env.policies.interface import act
from hav_env.world.sensing import (
    goal_direction,
    goal_pose,
    limits,
    route_ahead,
    stable_radius,
    unit_length,
)


class DubinsPursuit(NamedTuple):
    """Follow the shortest Dubins path, or a route, without regard to trailers and other HAVs."""

    close_factor: Factor = 3.5
    """Distance in truck lengths that counts as "close to goal"; see ``AvoidJack.close_factor``."""
    straight_below: Distance = 1e-3
    """Length [m] below which a first turn counts as none; see ``AvoidJack.straight_below``."""


@act.register(DubinsPursuit)
def pursue(policy, memory, world, agent, lane):
    """Drive at full speed along the route of the guidance, or else along the goal attraction."""
    speed, steering_max, _ = limits(world, agent, lane)
    known, _, _, curvature, _ = route_ahead(world, agent, lane)
    if known:
        return speed, steering_along(world, agent, lane, curvature)
    side = goal_attraction(policy.close_factor, policy.straight_below, world, agent, lane)
    return speed, side * steering_max


@kernel
def steering_along(world, agent, lane, curvature):
    """Return the steering angle [rad] within the limit that follows a curvature [1/m]."""
    _, steering_max, _ = limits(world, agent, lane)
    wanted = atan2(curvature * unit_length(world, agent, 0, lane), 1.0)
    return clip(wanted, -steering_max, steering_max)


@kernel
def goal_attraction(close_factor, straight_below, world, agent, lane):
    """Return the side to which the path to the goal starts, Algorithm (goal_attraction).

    Far from the goal the path leads to the approach point P^A, one truck length before the goal,
    eq. (18), with the radius R_min; close to it to the goal itself, with the truck's
    length as radius.

    Returns:
        1.0 for left, -1.0 for right, 0.0 for straight ahead.
    """
    forward, left, heading = goal_pose(world, agent, lane)
    cosine, sine = goal_direction(world, agent, lane)
    truck = unit_length(world, agent, 0, lane)
    close = forward * forward + left * left < close_factor * truck * (close_factor * truck)
    before = 0.0 if close else truck
    radius = truck if close else stable_radius(world, agent, lane)
    word, first, second, third = shortest_path_towards(
        forward - before * cosine, left - before * sine, heading, cosine, sine, radius
    )
    return first_side(straight_below, word, first, second, third)


@kernel
def first_side(straight_below, word, first, second, third):
    """Return the side of the first segment [m] of a Dubins path that is not negligible."""
    sides = turns(word)
    side = sides[2] if third >= straight_below else 0.0
    side = sides[1] if second >= straight_below else side
    return sides[0] if first >= straight_below else side
