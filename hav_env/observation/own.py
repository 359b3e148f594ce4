"""This module observes the HAV itself: the columns of its limits, its goal, its units."""

import math

from hav_env.compiled import fixed, kernel
from hav_env.maths.elementary import atan2
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
from hav_env.world.sensing import (
    articulation_direction,
    drivable_radius,
    goal_direction,
    goal_pose,
    goals_left,
    limits,
    num_trailers,
    own_footprint,
    stable_radius,
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
JOINT = direction_columns("articulation")  # of each joint
_OWN_AT, _JOINT_AT = places_of(ITSELF), places_of(JOINT)


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
    """Return how many columns the units have."""
    return max_trailers + 1 + len(_JOINT_AT) * max_trailers


@kernel
def observe_itself(world, agent, columns, units):
    """Write the columns of the HAV, of its goal and of its units.

    Args:
        world: a block.
        agent: which HAV.
        columns: (D, W) to be written.
        units: the first column of the units.
    """
    num_units, per_goal = world.state.heading.shape[1], 1.0 / world.goals.shape[1]
    joints = num_units - 1
    for lane in range(world.lanes):
        speed, steering, articulation = limits(world, agent, lane)
        columns[_OWN_AT.waits, lane] = 1.0 if waits(world, agent, lane) else 0.0
        columns[_OWN_AT.goals_left, lane] = goals_left(world, agent, lane) * per_goal
        columns[_OWN_AT.speed_max, lane] = min(speed * (1.0 / SPEED_UNIT), 1.0)
        columns[_OWN_AT.steering_max, lane] = steering * (2.0 / math.pi)
        columns[_OWN_AT.articulation_max, lane] = articulation * (1.0 / math.pi)
    for lane in range(world.lanes):
        columns[_OWN_AT.largest_articulation, lane] = 0.0
        columns[_OWN_AT.stable_radius, lane] = scale_distance(stable_radius(world, agent, lane))
        steepest = steering_along(world, agent, drivable_radius(world, agent, lane), lane)
        columns[_OWN_AT.drivable_steering, lane] = steepest
        columns[_OWN_AT.footprint_radius, lane] = scale_distance(own_footprint(world, agent, lane))
    for lane in range(world.lanes):
        forward, left, _ = goal_pose(world, agent, lane)
        cosine, sine = goal_direction(world, agent, lane)
        before = unit_length(world, agent, 0, lane)
        ahead, aside = forward - before * cosine, left - before * sine
        write_place(columns, _OWN_AT.goal_distance, lane, forward, left)
        write_direction(columns, _OWN_AT.goal_heading_cosine, lane, cosine, sine)
        write_place(columns, _OWN_AT.approach_distance, lane, ahead, aside)
    for number in range(num_units):
        unit = fixed(number)
        for lane in range(world.lanes):
            present = unit <= num_trailers(world, agent, lane)
            length = scale_length(unit_length(world, agent, unit, lane))
            columns[units + unit, lane] = length if present else 0.0
    for number in range(1, num_units):
        joint = fixed(number)
        first = units + num_units + joint - 1
        cosines = first + _JOINT_AT.articulation_cosine * joints
        sines = first + _JOINT_AT.articulation_sine * joints
        for lane in range(world.lanes):
            present = joint <= num_trailers(world, agent, lane)
            cosine, sine = articulation_direction(world, agent, joint, lane)
            bend = atan2(sine, cosine) / limits(world, agent, lane)[2] if present else 0.0
            largest = columns[_OWN_AT.largest_articulation, lane]
            larger = abs(bend) > abs(largest)
            columns[_OWN_AT.largest_articulation, lane] = (
                clip(bend, -1.0, 1.0) if larger else largest
            )
            columns[cosines, lane] = clip(cosine, -1.0, 1.0) if present else 0.0
            columns[sines, lane] = clip(sine, -1.0, 1.0) if present else 0.0
