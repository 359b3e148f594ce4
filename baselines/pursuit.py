"""Goal attraction alone: the paper's Algorithm 1 as a policy, blind to trailers and neighbours."""

import math
from typing import NamedTuple

from baselines.policy import act, check_parameters, require_at_least
from hav_env.compiled import kernel, world_kernel
from hav_env.dubins import TURNS, shortest_path_towards
from hav_env.sensing import goal_pose, limits, stable_radius, unit_length


class DubinsPursuit(NamedTuple):
    """Follow the shortest Dubins path to the goal; no regard for trailers and other HAVs."""

    close_factor: float = 3.5
    """"Close to goal" means within this many truck lengths; see ``AvoidJack.close_factor``."""
    straight_below: float = 1e-3
    """A first turn shorter than this counts as none [m]; see ``AvoidJack.straight_below``."""


@check_parameters.register
def _(policy: DubinsPursuit, scenario) -> None:
    require_at_least(policy, 0.0, ("close_factor", "straight_below"))


@act.register(DubinsPursuit)
def pursue(policy, memory, world, agent):
    """Drive at full speed along the goal attraction."""
    speed, steering_max, _ = limits(world, agent)
    side = goal_attraction(policy.close_factor, policy.straight_below, world, agent)
    return speed, side * steering_max


@world_kernel
def goal_attraction(close_factor, straight_below, world, agent):
    """Return the side to which the path to the goal starts, Algorithm (goal_attraction).

    Far from the goal the path leads to the approach point P^A, one truck length before the goal,
    eq. (approach-point), with the radius R_min; close to it to the goal itself, with the truck's
    length as radius.

    Returns:
        1.0 for left, -1.0 for right, 0.0 for straight ahead.
    """
    forward, left, heading = goal_pose(world, agent)
    truck = unit_length(world, agent, 0)
    close = close_factor * truck
    radius = truck
    cosine, sine = math.cos(heading), math.sin(heading)
    if forward * forward + left * left >= close * close:
        forward -= truck * cosine
        left -= truck * sine
        radius = stable_radius(world, agent)
    word, first, second, third = shortest_path_towards(forward, left, heading, cosine, sine, radius)
    return first_side(straight_below, word, first, second, third)


@kernel
def first_side(straight_below, word, first, second, third):
    """Return the side of the first segment [m] of a Dubins path that is not negligible."""
    turns = TURNS[word]
    if first >= straight_below:
        return float(turns[0])
    if second >= straight_below:
        return float(turns[1])
    return float(turns[2]) if third >= straight_below else 0.0
