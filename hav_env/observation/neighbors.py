"""What a HAV sees of its nearest neighbours."""

import math

from hav_env.compiled import kernel
from hav_env.geometry import clip
from hav_env.observation.layout import (
    CHAIN,
    CLEARANCE,
    NEAREST,
    OTHER_FOOTPRINT,
    PLACE,
    PRESENT,
    RELATIVE_HEADING,
    TRUCK,
    UNITS,
    scale_distance,
    scale_length,
    write_direction,
    write_place,
)
from hav_env.sensing import (
    neighbor_articulation,
    neighbor_distance,
    neighbor_footprint,
    neighbor_heading_direction,
    neighbor_length,
    neighbor_nearest_point,
    neighbor_position,
    neighbor_trailers,
    num_neighbors,
    own_footprint,
)


@kernel
def observe_neighbors(observation, world, agent, columns):
    """Write the columns of the K nearest neighbours, nearest first; zeros where there are fewer."""
    joints = world.state.heading.shape[1] - 1
    size = CHAIN + (3 * joints if observation.chains else 0)
    first = UNITS + 1 + 3 * joints
    for column in range(first, first + size * observation.neighbors):
        for lane in range(world.lanes):
            columns[column, lane] = 0.0
    for lane in range(world.lanes):
        nearest, least = -1, -math.inf
        for rank in range(min(observation.neighbors, num_neighbors(world, agent, lane))):
            nearest, least = _next_nearest(world, agent, lane, nearest, least)
            column = first + size * rank
            _observe_neighbor(world, agent, nearest, columns, column, lane)
            if observation.chains:
                _observe_chain(world, agent, nearest, columns, column + CHAIN, lane)


@kernel
def clearance(world, agent, k, lane):
    """Return the distance less the collision distance [m]: below zero the footprints overlap."""
    collision_distance = own_footprint(world, agent, lane) + neighbor_footprint(
        world, agent, k, lane
    )
    return neighbor_distance(world, agent, k, lane) - collision_distance


@kernel
def _next_nearest(world, agent, lane, before, least):
    """Return the neighbour that comes after one when sorted by clearance, and its clearance [m].

    Of equally near ones the first comes first.
    """
    found, smallest = -1, math.inf
    for k in range(num_neighbors(world, agent, lane)):
        gap = clearance(world, agent, k, lane)
        later = gap > least or (gap == least and k > before)
        if later and (gap < smallest or found < 0):
            found, smallest = k, gap
    return found, smallest


@kernel
def _observe_neighbor(world, agent, k, columns, column, lane):
    columns[column + PRESENT, lane] = 1.0
    forward, left = neighbor_position(world, agent, k, lane)
    write_place(columns, column + PLACE, lane, forward, left)
    cosine, sine = neighbor_heading_direction(world, agent, k, lane)
    write_direction(columns, column + RELATIVE_HEADING, lane, cosine, sine)
    columns[column + OTHER_FOOTPRINT, lane] = scale_distance(
        neighbor_footprint(world, agent, k, lane)
    )
    gap = clearance(world, agent, k, lane)
    scaled = scale_distance(abs(gap))
    columns[column + CLEARANCE, lane] = -scaled if gap < 0.0 else scaled
    columns[column + TRUCK, lane] = scale_length(neighbor_length(world, agent, k, 0, lane))
    forward, left = neighbor_nearest_point(world, agent, k, lane)
    write_place(columns, column + NEAREST, lane, forward, left)


@kernel
def _observe_chain(world, agent, k, columns, column, lane):
    joints = world.state.heading.shape[1] - 1
    for joint in range(1, neighbor_trailers(world, agent, k, lane) + 1):
        place = column + joint - 1
        cosine, sine = neighbor_articulation(world, agent, k, joint, lane)
        columns[place, lane] = scale_length(neighbor_length(world, agent, k, joint, lane))
        columns[place + joints, lane] = clip(cosine, -1.0, 1.0)
        columns[place + 2 * joints, lane] = clip(sine, -1.0, 1.0)
