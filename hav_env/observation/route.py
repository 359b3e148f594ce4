"""This module observes the Dubins paths ahead of a HAV: the columns that describe them."""

from hav_env.compiled import fixed, in_single, kernel, single
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
    LENGTH,
    STABLE_RADIUS,
    STEERING_MAX,
    TO_APPROACH,
    TO_GOAL,
    TURN,
    WHEELBASE,
)
from hav_env.world.sensing import (
    drivable_radius,
    goal_direction,
    goal_pose,
    limits,
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
_STEERED = 1.0  # [m], the beginning of a path whose steering is told


@in_single
@kernel
def _path_towards(forward, left, heading, cosine, sine, radius):
    """Return side of the first segment, its length and that of the whole Dubins path [m]."""
    word, first, second, third = shortest_path_towards(forward, left, heading, cosine, sine, radius)
    side, _, _ = turns(word)
    return side, first, first + second + third


@in_single
@kernel
def steering_along(wheelbase, radius, steering_max):
    """Return the steering that keeps to a circle, as a share of what the wheels allow: at most 1.

    Args:
        wheelbase: of the truck [m], float32 as all arguments are.
        radius: of the circle of its rear axle [m].
        steering_max: its steepest steering [rad].
    """
    return min(atan2_positive(wheelbase, radius) / steering_max, 1.0)


@in_single
@kernel
def _steering_at_first(side, first, steering):
    """Return the steering that follows a path; that of a short first segment counts less."""
    return side * min(first * (1.0 / _STEERED), 1.0) * steering


@kernel
def plan_route(world, agent, scratch, remaining):
    """Find the shortest Dubins paths to the goal and to the approach point.

    The circles of the first are those of ``drivable_radius``, so that it can be followed; those of
    the second have the radius R_min, as AVOID-JACK plans it.

    Args:
        world: a block.
        agent: which HAV.
        scratch: a ``Scratch``, whose rows TURN .. STEERING_MAX are written.
        remaining: (N, W), the length of the path to the goal [m]; row ``agent`` is written.
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
    for lane in range(world.lanes):
        remaining[agent, lane] = rows[TO_GOAL + LENGTH, lane]


@kernel
def _find_path(world, rows, forward, left, radius, to):
    """Write the rows of one path, from ``to`` on, given the rows of its end and its circles."""
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
        world: a block.
        scratch: as ``plan_route`` left it.
        columns: (D, L) to be written.
        first: the first column of the paths.
    """
    _describe_path(world, scratch.rows, TO_GOAL, DRIVABLE_RADIUS, columns, fixed(first))
    second = fixed(first + len(_ROUTE_AT))
    _describe_path(world, scratch.rows, TO_APPROACH, STABLE_RADIUS, columns, second)


@kernel
def _describe_path(world, rows, to, radius, columns, column):
    """Write the columns of one path, given its rows and that of its circles."""
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
