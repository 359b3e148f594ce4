"""What a HAV sees of its nearest neighbours."""

import math

from hav_env.compiled import fixed, kernel
from hav_env.maths.geometry import clip
from hav_env.observation.layout import (
    CHAIN,
    CLEARANCE,
    FRONTS,
    NEAR,
    NEAREST,
    OTHER_FOOTPRINT,
    PLACE,
    PRESENT,
    RELATIVE_HEADING,
    SPEED_UNIT,
    TINY,
    TRUCK,
    UNITS,
    scale_distance,
    scale_length,
    write_direction,
    write_place,
)
from hav_env.world.sensing import (
    neighbor_articulation,
    neighbor_before_front,
    neighbor_distance,
    neighbor_footprint,
    neighbor_front_gap,
    neighbor_heading_direction,
    neighbor_length,
    neighbor_nearest_point,
    neighbor_position,
    neighbor_speed,
    neighbor_trailers,
    num_neighbors,
    own_footprint,
)


@kernel
def observe_neighbors(observation, world, agent, columns):
    """Write the columns of the K nearest neighbours, nearest first; zeros where there are fewer.

    Who they are differs from lane to lane, so one lane after the other is looked at; what takes
    roots and logarithms is then worked out for all lanes at once.
    """
    joints = world.state.heading.shape[1] - 1
    fronts = CHAIN + (3 * joints if observation.chains else 0)
    size = fronts + (len(FRONTS) if observation.fronts else 0)
    first = UNITS + 1 + 3 * joints
    for number in range(first, first + size * observation.neighbors):
        column = fixed(number)
        for lane in range(world.lanes):
            columns[column, lane] = 0.0
    for lane in range(world.lanes):
        nearest, least = -1, -math.inf
        for rank in range(min(observation.neighbors, num_neighbors(world, agent, lane))):
            nearest, least = _next_nearest(world, agent, lane, nearest, least)
            column = first + size * rank
            _look_at_neighbor(world, agent, nearest, least, columns, column, lane)
            if observation.chains:
                _observe_chain(world, agent, nearest, columns, column + CHAIN, lane)
            if observation.fronts:
                _observe_fronts(world, agent, nearest, columns, column + fronts, lane)
    for rank in range(observation.neighbors):
        _scale_neighbor(world, columns, fixed(first + size * rank))


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
def _look_at_neighbor(world, agent, k, gap, columns, column, lane):
    """Write a neighbour's columns in metres: places as forward and left, distances as they are."""
    columns[column + PRESENT, lane] = 1.0
    forward, left = neighbor_position(world, agent, k, lane)
    columns[column + PLACE + 1, lane], columns[column + PLACE + 2, lane] = forward, left
    cosine, sine = neighbor_heading_direction(world, agent, k, lane)
    write_direction(columns, column + RELATIVE_HEADING, lane, cosine, sine)
    columns[column + OTHER_FOOTPRINT, lane] = neighbor_footprint(world, agent, k, lane)
    columns[column + CLEARANCE, lane] = gap
    columns[column + TRUCK, lane] = neighbor_length(world, agent, k, 0, lane)
    forward, left = neighbor_nearest_point(world, agent, k, lane)
    columns[column + NEAREST + 1, lane], columns[column + NEAREST + 2, lane] = forward, left


@kernel
def _scale_neighbor(world, columns, column):
    """Turn metres into what a row holds; zeros stay zeros."""
    for lane in range(world.lanes):
        forward, left = columns[column + PLACE + 1, lane], columns[column + PLACE + 2, lane]
        write_place(columns, column + PLACE, lane, forward, left)
    for lane in range(world.lanes):
        forward, left = columns[column + NEAREST + 1, lane], columns[column + NEAREST + 2, lane]
        write_place(columns, column + NEAREST, lane, forward, left)
    for lane in range(world.lanes):
        gap = columns[column + CLEARANCE, lane]
        scaled = scale_distance(abs(gap))
        columns[column + CLEARANCE, lane] = -scaled if gap < 0.0 else scaled
        footprint = columns[column + OTHER_FOOTPRINT, lane]
        columns[column + OTHER_FOOTPRINT, lane] = scale_distance(footprint)
        columns[column + TRUCK, lane] = scale_length(columns[column + TRUCK, lane])


@kernel
def _observe_chain(world, agent, k, columns, column, lane):
    joints = world.state.heading.shape[1] - 1
    for joint in range(1, neighbor_trailers(world, agent, k, lane) + 1):
        place = column + joint - 1
        cosine, sine = neighbor_articulation(world, agent, k, joint, lane)
        columns[place, lane] = scale_length(neighbor_length(world, agent, k, joint, lane))
        columns[place + joints, lane] = clip(cosine, -1.0, 1.0)
        columns[place + 2 * joints, lane] = clip(sine, -1.0, 1.0)


@kernel
def _observe_fronts(world, agent, k, columns, column, lane):
    """Write speed and nearness: 0 from 10 m on, 1 where they touch; with it, in which direction."""
    columns[column, lane] = min(neighbor_speed(world, agent, k, lane) * (1.0 / SPEED_UNIT), 1.0)
    forward, left = neighbor_before_front(world, agent, k, lane)
    distance = math.sqrt(forward * forward + left * left)
    nearness = max(0.0, 1.0 - distance * (1.0 / NEAR))
    share = nearness / max(distance, TINY)
    columns[column + 1, lane] = nearness
    columns[column + 2, lane] = share * forward
    columns[column + 3, lane] = share * left
    exposed = neighbor_front_gap(world, agent, k, lane)
    columns[column + 4, lane] = max(0.0, 1.0 - exposed * (1.0 / NEAR))
