"""What a HAV sees of itself: its units, its limits, its goal."""

import math

from hav_env.compiled import fixed, kernel
from hav_env.maths.elementary import atan2
from hav_env.maths.geometry import clip
from hav_env.observation.layout import (
    APPROACH,
    ARTICULATION_MAX,
    DRIVABLE,
    FOOTPRINT,
    GOAL,
    GOAL_HEADING,
    GOALS_LEFT,
    LARGEST,
    SPEED_MAX,
    SPEED_UNIT,
    STABLE,
    STEERING_MAX,
    UNITS,
    WAITS,
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


@kernel
def observe_itself(world, agent, columns):
    """Write the columns of the HAV, of its goal and of its units."""
    num_units, per_goal = world.state.heading.shape[1], 1.0 / world.goals.shape[1]
    for lane in range(world.lanes):
        speed, steering, articulation = limits(world, agent, lane)
        columns[WAITS, lane] = 1.0 if waits(world, agent, lane) else 0.0
        columns[GOALS_LEFT, lane] = goals_left(world, agent, lane) * per_goal
        columns[SPEED_MAX, lane] = min(speed * (1.0 / SPEED_UNIT), 1.0)
        columns[STEERING_MAX, lane] = steering * (2.0 / math.pi)
        columns[ARTICULATION_MAX, lane] = articulation * (1.0 / math.pi)
    for lane in range(world.lanes):
        columns[LARGEST, lane] = 0.0
        columns[STABLE, lane] = scale_distance(stable_radius(world, agent, lane))
        steepest = steering_along(world, agent, drivable_radius(world, agent, lane), lane)
        columns[DRIVABLE, lane] = steepest
        columns[FOOTPRINT, lane] = scale_distance(own_footprint(world, agent, lane))
    for lane in range(world.lanes):
        forward, left, _ = goal_pose(world, agent, lane)
        cosine, sine = goal_direction(world, agent, lane)
        before = unit_length(world, agent, 0, lane)
        write_place(columns, GOAL, lane, forward, left)
        write_direction(columns, GOAL_HEADING, lane, cosine, sine)
        write_place(columns, APPROACH, lane, forward - before * cosine, left - before * sine)
    for number in range(num_units):
        unit = fixed(number)
        for lane in range(world.lanes):
            present = unit <= num_trailers(world, agent, lane)
            length = scale_length(unit_length(world, agent, unit, lane))
            columns[UNITS + unit, lane] = length if present else 0.0
    for number in range(1, num_units):
        joint = fixed(number)
        cosines, sines = UNITS + num_units - 1 + joint, UNITS + 2 * (num_units - 1) + joint
        for lane in range(world.lanes):
            present = joint <= num_trailers(world, agent, lane)
            cosine, sine = articulation_direction(world, agent, joint, lane)
            bend = atan2(sine, cosine) / limits(world, agent, lane)[2] if present else 0.0
            larger = abs(bend) > abs(columns[LARGEST, lane])
            columns[LARGEST, lane] = clip(bend, -1.0, 1.0) if larger else columns[LARGEST, lane]
            columns[cosines, lane] = clip(cosine, -1.0, 1.0) if present else 0.0
            columns[sines, lane] = clip(sine, -1.0, 1.0) if present else 0.0
