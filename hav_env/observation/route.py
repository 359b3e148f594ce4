"""This module observes the Dubins paths ahead of a HAV: the columns that describe them."""

from hav_env.compiled import fixed, kernel
from hav_env.maths.dubins import shortest_path_towards, turns
from hav_env.maths.elementary import atan2_positive
from hav_env.observation.columns import Column, places_of, scale_distance
from hav_env.world.sensing import (
    drivable_radius,
    goal_direction,
    goal_pose,
    limits,
    stable_radius,
    unit_length,
)

# of a path: side of its first segment, length of that segment and of the whole path [m]
TURN, FIRST, LENGTH = range(3)
TO_GOAL, TO_APPROACH, ROUTE_SIZE = 0, 3, 6
PATH_COLUMNS = (
    Column("turn", low=-1.0),
    Column("first"),
    Column("whole"),
    Column("steering", low=-1.0),
)
ROUTE = tuple(
    column._replace(name=f"{end}_path_{column.name}")
    for end in ("goal", "approach")
    for column in PATH_COLUMNS
)
_ROUTE_AT = places_of(PATH_COLUMNS)
_STEERED = 1.0  # [m], the beginning of a path whose steering is told


@kernel
def plan_route(world, agent, route, remaining):
    """Find the shortest Dubins paths to the goal and to the approach point.

    The circles of the first are those of ``drivable_radius``, so that it can be followed; those of
    the second have the radius R_min, as AVOID-JACK plans it.

    Args:
        world: a block.
        agent: which HAV.
        route: (N, ROUTE_SIZE, W), of which row ``agent`` is written in every lane of the block.
        remaining: (N, W), the length of the path to the goal [m], likewise.
    """
    for place in range(2):
        to = fixed(TO_APPROACH * place)
        for lane in range(world.lanes):
            before = place * unit_length(world, agent, 0, lane)
            forward, left, heading = goal_pose(world, agent, lane)
            cosine, sine = goal_direction(world, agent, lane)
            word, first, second, third = shortest_path_towards(
                forward - before * cosine,
                left - before * sine,
                heading,
                cosine,
                sine,
                _radius(world, agent, place, lane),
            )
            side, _, _ = turns(word)
            route[agent, to + TURN, lane] = side
            route[agent, to + FIRST, lane] = first
            route[agent, to + LENGTH, lane] = first + second + third
    for lane in range(world.lanes):
        remaining[agent, lane] = route[agent, TO_GOAL + LENGTH, lane]


@kernel
def observe_route(world, agent, route, columns, first):
    """Write the columns of both paths.

    Args:
        world: a block.
        agent: which HAV.
        route: (N, ROUTE_SIZE, W) as ``plan_route`` left it.
        columns: (D, W) to be written.
        first: the first column of the paths.
    """
    for place in range(2):
        to, column = fixed(TO_APPROACH * place), fixed(first + len(_ROUTE_AT) * place)
        for lane in range(world.lanes):
            side, length = route[agent, to + TURN, lane], route[agent, to + FIRST, lane]
            columns[column + _ROUTE_AT.turn, lane] = side
            columns[column + _ROUTE_AT.first, lane] = scale_distance(length)
            columns[column + _ROUTE_AT.whole, lane] = scale_distance(
                route[agent, to + LENGTH, lane]
            )
            share = side * min(length * (1.0 / _STEERED), 1.0)
            radius = _radius(world, agent, place, lane)
            steering = share * steering_along(world, agent, radius, lane)
            columns[column + _ROUTE_AT.steering, lane] = steering


@kernel
def _radius(world, agent, place, lane):
    """Return the radius of the circles [m] of the path to the goal, or to the point before it."""
    stable, drivable = stable_radius(world, agent, lane), drivable_radius(world, agent, lane)
    return drivable if place == 0 else stable


@kernel
def steering_along(world, agent, radius, lane):
    """Return the steering that keeps to a circle, as a share of what the wheels allow: at most 1.

    Args:
        world: a block.
        agent: which HAV.
        radius: of the circle of its rear axle [m].
        lane: which world.
    """
    _, steering_max, _ = limits(world, agent, lane)
    return min(atan2_positive(unit_length(world, agent, 0, lane), radius) / steering_max, 1.0)
