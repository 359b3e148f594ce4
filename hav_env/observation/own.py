"""This module observes the HAV itself: the columns of its limits, its goal, its units."""

import math

from hav_env.compiled import fixed, kernel, single
from hav_env.maths.geometry import clip
from hav_env.observation.columns import (
    SPEED_UNIT,
    Column,
    direction_columns,
    length_column,
    place_columns,
    places_of,
    scale_distance,
    scale_length,
    write_direction,
    write_place,
)
from hav_env.observation.route import steering_along
from hav_env.observation.scratch import (
    APPROACH_FORWARD,
    APPROACH_LEFT,
    DRIVABLE_RADIUS,
    GOAL_COSINE,
    GOAL_FORWARD,
    GOAL_LEFT,
    GOAL_SINE,
    STABLE_RADIUS,
    STEERING_MAX,
    WHEELBASE,
)
from hav_env.world.sensing import (
    articulation,
    articulation_direction,
    goals_left,
    limits,
    num_trailers,
    own_footprint,
    own_speed,
    own_steering,
    unit_length,
    waits,
)

ITSELF = (
    Column("waits"),
    Column("goals_left"),
    Column("speed_max"),
    Column("steering_max"),
    Column("articulation_max"),
    Column("stable_radius"),
    Column("drivable_steering"),
    Column("footprint_radius"),
    Column("largest_articulation", low=-1.0),
    *place_columns("goal_"),
    *direction_columns("goal_heading"),
    *place_columns("approach_"),
)
JOINT = direction_columns("articulation")  # columns of each joint
MOTION = (Column("speed"), Column("steering", low=-1.0))
_OWN_AT, _JOINT_AT, _MOTION_AT = places_of(ITSELF), places_of(JOINT), places_of(MOTION)


def unit_columns(max_trailers: int) -> list[Column]:
    """Return the columns of the units: the lengths, then column by column those of the joints."""
    lengths = [length_column(f"length_{unit}") for unit in range(max_trailers + 1)]
    return lengths + joint_columns(JOINT, max_trailers)


def joint_columns(group: tuple[Column, ...], max_trailers: int) -> list[Column]:
    """Return the columns of a group for all joints, one column after the other."""
    joints = range(1, max_trailers + 1)
    return [column._replace(name=f"{column.name}_{j}") for column in group for j in joints]


@kernel
def count_unit_columns(max_trailers):
    """Return the number of columns of the units."""
    return max_trailers + 1 + len(_JOINT_AT) * max_trailers


@kernel
def _share_of(bend, limit):
    """Return an articulation as a share of its limit, clipped to [-1, 1]."""
    return clip(bend / limit, -1.0, 1.0)


@kernel
def observe_itself(world, agent, scratch, columns, units):
    """Write the columns of the HAV, of its goal and of its units.

    Args:
        world: Block of worlds.
        agent: Index of the HAV.
        scratch: Scratch rows as ``plan_route`` left them.
        columns: (D, L) columns to write.
        units: First column of the units.
    """
    num_units, per_goal, rows = (
        world.state.heading.shape[1],
        1.0 / world.goals.shape[1],
        scratch.rows,
    )
    for lane in range(world.lanes):
        speed, steering, articulation = limits(world, agent, lane)
        columns[_OWN_AT.waits, lane] = 1.0 if waits(world, agent, lane) else 0.0
        columns[_OWN_AT.goals_left, lane] = goals_left(world, agent, lane) * per_goal
        columns[_OWN_AT.speed_max, lane] = min(speed * (1.0 / SPEED_UNIT), 1.0)
        columns[_OWN_AT.steering_max, lane] = steering * (2.0 / math.pi)
        columns[_OWN_AT.articulation_max, lane] = articulation * (1.0 / math.pi)
    for lane in range(world.lanes):
        columns[_OWN_AT.footprint_radius, lane] = own_footprint(world, agent, lane)
        columns[_OWN_AT.largest_articulation, lane] = 0.0
    for lane in range(world.lanes):
        stable, wheelbase = single(rows[STABLE_RADIUS, lane]), single(rows[WHEELBASE, lane])
        footprint = single(columns[_OWN_AT.footprint_radius, lane])
        columns[_OWN_AT.stable_radius, lane] = scale_distance(stable)
        columns[_OWN_AT.footprint_radius, lane] = scale_distance(footprint)
        columns[_OWN_AT.drivable_steering, lane] = steering_along(
            wheelbase, single(rows[DRIVABLE_RADIUS, lane]), single(rows[STEERING_MAX, lane])
        )
    for lane in range(world.lanes):
        forward, left = single(rows[GOAL_FORWARD, lane]), single(rows[GOAL_LEFT, lane])
        write_place(columns, _OWN_AT.goal_distance, lane, forward, left)
        cosine, sine = rows[GOAL_COSINE, lane], rows[GOAL_SINE, lane]
        write_direction(columns, _OWN_AT.goal_heading_cosine, lane, cosine, sine)
    for lane in range(world.lanes):
        forward, left = single(rows[APPROACH_FORWARD, lane]), single(rows[APPROACH_LEFT, lane])
        write_place(columns, _OWN_AT.approach_distance, lane, forward, left)
    for number in range(num_units):
        unit = fixed(number)
        for lane in range(world.lanes):
            present = unit <= num_trailers(world, agent, lane)
            length = scale_length(single(unit_length(world, agent, unit, lane)))
            columns[units + unit, lane] = length if present else 0.0
    _observe_joints(world, agent, columns, units + num_units)


@kernel
def _observe_joints(world, agent, columns, first):
    """Write the columns of the joints, from column ``first`` on, and the largest articulation."""
    joints = world.state.heading.shape[1] - 1
    for number in range(1, joints + 1):
        joint = fixed(number)
        cosines = first + joint - 1 + _JOINT_AT.articulation_cosine * joints
        sines = first + joint - 1 + _JOINT_AT.articulation_sine * joints
        for lane in range(world.lanes):
            present = joint <= num_trailers(world, agent, lane)
            cosine, sine = articulation_direction(world, agent, joint, lane)
            columns[cosines, lane] = clip(cosine, -1.0, 1.0) if present else 0.0
            columns[sines, lane] = clip(sine, -1.0, 1.0) if present else 0.0
        for lane in range(world.lanes):
            present = joint <= num_trailers(world, agent, lane)
            bend = single(articulation(world, agent, joint, lane) if present else 0.0)
            largest = single(columns[_OWN_AT.largest_articulation, lane])
            larger = abs(bend) > abs(largest)
            columns[_OWN_AT.largest_articulation, lane] = bend if larger else largest
    for lane in range(world.lanes):
        _, _, limit = limits(world, agent, lane)
        largest = single(columns[_OWN_AT.largest_articulation, lane])
        columns[_OWN_AT.largest_articulation, lane] = _share_of(largest, single(limit))


@kernel
def observe_motion(world, agent, columns, first):
    """Write speed and steering as shares of the limits, from column ``first`` on."""
    for lane in range(world.lanes):
        speed, steering, _ = limits(world, agent, lane)
        share = own_speed(world, agent, lane) / speed
        columns[first + _MOTION_AT.speed, lane] = min(share, 1.0)
        turn = own_steering(world, agent, lane) / steering
        columns[first + _MOTION_AT.steering, lane] = clip(turn, -1.0, 1.0)
