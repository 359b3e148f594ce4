"""This module observes the routes ahead of a HAV, Dubins paths or guided, as columns."""

import math

from hav_env.compiled import fixed, generic, kernel, single
from hav_env.maths.dubins import shortest_path_towards, turns
from hav_env.maths.elementary import atan2_positive
from hav_env.observation.columns import Column, places_of, scale_distance
from hav_env.observation.scratch import (
    APPROACH_FORWARD,
    APPROACH_LEFT,
    DRIVABLE_RADIUS,
    FIRST,
    GOAL_COSINE,
    GOAL_FORWARD,
    GOAL_HEADING,
    GOAL_LEFT,
    GOAL_SINE,
    HELD_CURVATURE,
    LENGTH,
    STABLE_RADIUS,
    STEERING_MAX,
    TO_APPROACH,
    TO_GOAL,
    TURN,
    WHEELBASE,
)
from hav_env.world.place.guidance import PLAN_HELD_CURVATURE, Dubins, OnFeasible
from hav_env.world.sensing import (
    drivable_radius,
    goal_direction,
    goal_pose,
    limits,
    route_ahead,
    stable_radius,
    unit_length,
)

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
_STRAIGHT = 1e-6  # [1/m], a curvature that is none
_STEERED = 1.0  # [m], length of the path over which the steering is averaged


@kernel
def _path_towards(forward, left, heading, cosine, sine, radius):
    """Return side and length of the first segment, and the length of the Dubins path [m]."""
    word, first, second, third = shortest_path_towards(forward, left, heading, cosine, sine, radius)
    side, _, _ = turns(word)
    return side, first, first + second + third


@kernel
def steering_along(wheelbase, radius, steering_max):
    """Return the steering that follows a circle, as a share of the maximum: at most 1.

    Args:
        wheelbase: Wheelbase of the truck [m], float32 like all arguments.
        radius: Radius of the circle of its rear axle [m].
        steering_max: Largest steering angle of the truck [rad].
    """
    return min(atan2_positive(wheelbase, radius) / steering_max, 1.0)


@kernel
def _steering_at_first(side, first, steering):
    """Return the steering that follows a path, with less weight for a short first segment."""
    return side * min(first * (1.0 / _STEERED), 1.0) * steering


@kernel
def plan_route(world, agent, scratch, remaining):
    """Find the shortest Dubins paths to the goal and to the approach point.

    The circles of the first path have the radius ``drivable_radius``, so the HAV can follow it.
    Those of the second path have the radius R_min, as AVOID-JACK plans it. If the guidance of the
    worlds knows a route, both paths are that route.

    Args:
        world: Block of worlds.
        agent: Index of the HAV.
        scratch: A ``Scratch``, whose rows TURN .. STEERING_MAX are written.
        remaining: (N, W) length of the path to the goal [m]; row ``agent`` is written.
    """
    rows = scratch.rows
    for lane in range(world.lanes):
        forward, left, heading = goal_pose(world, agent, lane)
        cosine, sine = goal_direction(world, agent, lane)
        rows[GOAL_FORWARD, lane], rows[GOAL_LEFT, lane] = forward, left
        rows[GOAL_HEADING, lane] = heading
        rows[GOAL_COSINE, lane], rows[GOAL_SINE, lane] = cosine, sine
    for lane in range(world.lanes):
        rows[DRIVABLE_RADIUS, lane] = drivable_radius(world, agent, lane)
        rows[STABLE_RADIUS, lane] = stable_radius(world, agent, lane)
        rows[WHEELBASE, lane] = unit_length(world, agent, 0, lane)
        _, rows[STEERING_MAX, lane], _ = limits(world, agent, lane)
    for lane in range(world.lanes):
        before = single(rows[WHEELBASE, lane])
        forward, left = single(rows[GOAL_FORWARD, lane]), single(rows[GOAL_LEFT, lane])
        rows[APPROACH_FORWARD, lane] = forward - before * single(rows[GOAL_COSINE, lane])
        rows[APPROACH_LEFT, lane] = left - before * single(rows[GOAL_SINE, lane])
    _find_path(world, rows, GOAL_FORWARD, GOAL_LEFT, DRIVABLE_RADIUS, TO_GOAL)
    _find_path(world, rows, APPROACH_FORWARD, APPROACH_LEFT, STABLE_RADIUS, TO_APPROACH)
    _write_route(world.guidance, world, agent, rows)
    for lane in range(world.lanes):
        remaining[agent, lane] = rows[TO_GOAL + LENGTH, lane]


@generic
def _write_route(guidance, world, agent, rows):
    """Write the rows of both paths if there is a route; the second ends one truck earlier."""


@_write_route.register(Dubins)
def _keep_paths(guidance, world, agent, rows):
    pass


@_write_route.otherwise
@kernel
def _write_known(guidance, world, agent, rows):
    for lane in range(world.lanes):
        known, side, stays, curvature, left = route_ahead(world, agent, lane)
        rows[HELD_CURVATURE, lane] = curvature if known else math.nan
        if known:
            for to in (TO_GOAL, TO_APPROACH):
                rows[to + TURN, lane], rows[to + FIRST, lane] = side, stays
            rows[TO_GOAL + LENGTH, lane] = left
            rows[TO_APPROACH + LENGTH, lane] = max(left - rows[WHEELBASE, lane], 0.0)


@_write_route.register(OnFeasible)
def _write_feasible(guidance, world, agent, rows):
    _write_known(guidance, world, agent, rows)
    for lane in range(world.lanes):
        rows[HELD_CURVATURE, lane] = guidance.plan[agent, PLAN_HELD_CURVATURE, lane]


@kernel
def _find_path(world, rows, forward, left, radius, to):
    """Write the rows of one path, from row ``to`` on, given the rows of its end and its circles."""
    for lane in range(world.lanes):
        side, first, length = _path_towards(
            single(rows[forward, lane]),
            single(rows[left, lane]),
            single(rows[GOAL_HEADING, lane]),
            single(rows[GOAL_COSINE, lane]),
            single(rows[GOAL_SINE, lane]),
            single(rows[radius, lane]),
        )
        rows[to + TURN, lane] = side
        rows[to + FIRST, lane] = first
        rows[to + LENGTH, lane] = length


@kernel
def observe_route(world, scratch, columns, first):
    """Write the columns of both paths.

    Args:
        world: Block of worlds.
        scratch: Scratch rows as ``plan_route`` left them.
        columns: (D, L) columns to write.
        first: First column of the paths.
    """
    _describe_path(world, scratch.rows, TO_GOAL, DRIVABLE_RADIUS, columns, fixed(first))
    second = fixed(first + len(_ROUTE_AT))
    _describe_path(world, scratch.rows, TO_APPROACH, STABLE_RADIUS, columns, second)
    _describe_steering(world.guidance, world, scratch.rows, columns, fixed(first))
    _describe_steering(world.guidance, world, scratch.rows, columns, second)


@generic
def _describe_steering(guidance, world, rows, columns, column):
    """Write the steering that keeps to a route, from column ``column`` on, where there is one."""


@_describe_steering.register(Dubins)
def _keep_steering(guidance, world, rows, columns, column):
    pass


@_describe_steering.otherwise
@kernel
def _steer_along_route(guidance, world, rows, columns, column):
    for lane in range(world.lanes):
        curvature = single(rows[HELD_CURVATURE, lane])
        steering = steering_along(
            single(rows[WHEELBASE, lane]),
            1.0 / max(abs(curvature), single(_STRAIGHT)),
            single(rows[STEERING_MAX, lane]),
        )
        steering = steering if curvature > 0.0 else -steering
        of_path = columns[column + _ROUTE_AT.steering, lane]
        known = not math.isnan(curvature)
        columns[column + _ROUTE_AT.steering, lane] = steering if known else of_path


@kernel
def _describe_path(world, rows, to, radius, columns, column):
    """Write the columns of one path, given its rows and the row of its radius."""
    for lane in range(world.lanes):
        side, length = single(rows[to + TURN, lane]), single(rows[to + FIRST, lane])
        whole = single(rows[to + LENGTH, lane])
        columns[column + _ROUTE_AT.turn, lane] = side
        columns[column + _ROUTE_AT.first, lane] = scale_distance(length)
        columns[column + _ROUTE_AT.whole, lane] = scale_distance(whole)
        steering = steering_along(
            single(rows[WHEELBASE, lane]),
            single(rows[radius, lane]),
            single(rows[STEERING_MAX, lane]),
        )
        columns[column + _ROUTE_AT.steering, lane] = _steering_at_first(side, length, steering)
