"""This module observes a HAV's nearest neighbours: the columns that describe them."""

import math

from hav_env.compiled import fixed, kernel, single
from hav_env.maths.elementary import sqrt
from hav_env.maths.geometry import clip
from hav_env.observation.columns import (
    SPEED_UNIT,
    TINY_DISTANCE,
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
from hav_env.observation.own import JOINT, joint_columns
from hav_env.world.arrays import FEW
from hav_env.world.other_havs import (
    NEAREST_X,
    NEAREST_Y,
    direction_of,
    find_nearest_points,
    place_of,
)
from hav_env.world.sensing import (
    neighbor_articulation,
    neighbor_before_front,
    neighbor_distance,
    neighbor_footprint,
    neighbor_front_gap,
    neighbor_id,
    neighbor_length,
    neighbor_nearest_point,
    neighbor_speed,
    neighbor_trailers,
    num_neighbors,
    own_footprint,
    unit_length,
)

NEIGHBOR_COLUMNS = (
    Column("present"),
    *place_columns(""),
    *direction_columns("heading"),
    Column("footprint_radius"),
    Column("clearance", low=-1.0),
    length_column("truck_length"),
    *place_columns("chain_"),
)
CHAINS = (length_column("length"), *JOINT)  # columns of each trailer
FRONTS = (
    Column("speed"),
    Column("front_nearness"),
    Column("front_ahead", low=-1.0),
    Column("front_aside", low=-1.0),
    Column("exposed_nearness"),
)
_NEIGHBOR_AT, _CHAIN_AT, _FRONT_AT = (
    places_of(NEIGHBOR_COLUMNS),
    places_of(CHAINS),
    places_of(FRONTS),
)
_FRONT_RANGE = 10.0  # [m], range of nearness at the front of a truck


def neighbor_columns(chains: bool, fronts: bool, max_trailers: int) -> list[Column]:
    """Return the columns of one neighbour.

    Args:
        chains: Whether to add its trailers.
        fronts: Whether to add its speed, and the nearest points to the fronts of trucks.
        max_trailers: Largest number of trailers of any HAV.
    """
    chain = joint_columns(CHAINS, max_trailers) if chains else []
    return [*NEIGHBOR_COLUMNS, *chain, *(FRONTS if fronts else ())]


@kernel
def observe_neighbors(observation, world, agent, scratch, columns, first):
    """Write the columns of the K nearest neighbours, nearest first; zeros where there are fewer.

    The nearest neighbours differ between lanes, so the kernel first finds them lane by lane. It
    then describes each of them in all lanes at once.

    Args:
        observation: Observation settings, as ``settle`` returns them.
        world: Block of worlds.
        agent: Index of the HAV.
        scratch: Scratch rows, a ``Scratch``.
        columns: (D, L) columns to write.
        first: First column of the neighbours.
    """
    joints = world.state.heading.shape[1] - 1
    fronts = len(_NEIGHBOR_AT) + (len(_CHAIN_AT) * joints if observation.chains else 0)
    size = fronts + (len(_FRONT_AT) if observation.fronts else 0)
    for number in range(first, first + size * observation.neighbors):
        column = fixed(number)
        for lane in range(world.lanes):
            columns[column, lane] = 0.0
    few = world.state.x.shape[0] <= FEW
    for lane in range(world.lanes):
        nearest, least = -1, -math.inf
        for rank in range(min(observation.neighbors, num_neighbors(world, agent, lane))):
            nearest, least = _next_nearest(world, agent, lane, nearest, least)
            column = first + size * rank
            columns[column + _NEIGHBOR_AT.present, lane] = 1.0
            columns[column + _NEIGHBOR_AT.clearance, lane] = least
            # the HAV's number, until the kernel describes the HAV in all lanes at once
            other = neighbor_id(world, agent, nearest, lane)
            columns[column + _NEIGHBOR_AT.distance, lane] = other
            if not few:
                chain = neighbor_nearest_point(world, agent, nearest, lane)
                _look_at_hav(world, agent, other, chain, columns, column, lane)
            if observation.chains:
                _observe_chain(world, agent, nearest, columns, column + len(_NEIGHBOR_AT), lane)
            if observation.fronts:
                _observe_fronts(world, agent, nearest, columns, column + fronts, lane)
    if few:
        for other in range(world.state.x.shape[0]):
            _look_in_all_lanes(
                observation, world, agent, fixed(other), scratch.chain, columns, first, size
            )
    for rank in range(observation.neighbors):
        _scale_neighbor(world, columns, fixed(first + size * rank))


@kernel
def clearance(world, agent, k, lane):
    """Return the distance minus the collision distance [m]: below zero the footprints overlap."""
    collision_distance = own_footprint(world, agent, lane) + neighbor_footprint(
        world, agent, k, lane
    )
    return neighbor_distance(world, agent, k, lane) - collision_distance


@kernel
def _next_nearest(world, agent, lane, before, least):
    """Return the neighbour after a given one in the order of clearance, and its clearance [m].

    Neighbours with equal clearance come in the order of their indices.
    """
    found, smallest = -1, math.inf
    for k in range(num_neighbors(world, agent, lane)):
        gap = clearance(world, agent, k, lane)
        later = gap > least or (gap == least and k > before)
        if later and (gap < smallest or found < 0):
            found, smallest = k, gap
    return found, smallest


@kernel
def _look_in_all_lanes(observation, world, agent, other, chain, columns, first, size):
    """Write another HAV's columns in the lanes in which it is one of the nearest."""
    seen = 0
    for rank in range(observation.neighbors):
        seen += _count_seen(world, other, columns, fixed(first + size * rank))
    if seen == 0:
        return
    find_nearest_points(world, agent, other, chain)
    for rank in range(observation.neighbors):
        column = fixed(first + size * rank)
        if _count_seen(world, other, columns, column) > 0:
            for lane in range(world.lanes):
                nearest = chain[NEAREST_X, lane], chain[NEAREST_Y, lane]
                if _is_seen(columns, column, other, lane):
                    _look_at_hav(world, agent, other, nearest, columns, column, lane)


@kernel
def _is_seen(columns, column, other, lane):
    """Return whether a HAV is the neighbour whose columns begin at ``column``."""
    present = columns[column + _NEIGHBOR_AT.present, lane] > 0.0
    return present & (columns[column + _NEIGHBOR_AT.distance, lane] == other)


@kernel
def _count_seen(world, other, columns, column):
    """Return in how many lanes a HAV is the neighbour whose columns begin at ``column``."""
    seen = 0
    for lane in range(world.lanes):
        seen += _is_seen(columns, column, other, lane)
    return seen


@kernel
def _look_at_hav(world, agent, other, nearest, columns, column, lane):
    """Write columns in metres: positions as forward and left, distances without scaling."""
    forward, left = place_of(world, agent, other, lane)
    columns[column + _NEIGHBOR_AT.bearing_cosine, lane] = forward
    columns[column + _NEIGHBOR_AT.bearing_sine, lane] = left
    cosine, sine = direction_of(world, agent, other, lane)
    columns[column + _NEIGHBOR_AT.heading_cosine, lane] = cosine
    columns[column + _NEIGHBOR_AT.heading_sine, lane] = sine
    columns[column + _NEIGHBOR_AT.footprint_radius, lane] = own_footprint(world, other, lane)
    columns[column + _NEIGHBOR_AT.truck_length, lane] = unit_length(world, other, 0, lane)
    forward, left = nearest
    columns[column + _NEIGHBOR_AT.chain_bearing_cosine, lane] = forward
    columns[column + _NEIGHBOR_AT.chain_bearing_sine, lane] = left


@kernel
def _scale_signed(distance):
    """Scale a distance [m] that may be below zero."""
    scaled = scale_distance(abs(distance))
    return -scaled if distance < 0.0 else scaled


@kernel
def _scale_neighbor(world, columns, column):
    """Convert metres to scaled columns; zeros stay zeros."""
    for lane in range(world.lanes):
        forward = single(columns[column + _NEIGHBOR_AT.bearing_cosine, lane])
        left = single(columns[column + _NEIGHBOR_AT.bearing_sine, lane])
        write_place(columns, column + _NEIGHBOR_AT.distance, lane, forward, left)
        cosine = columns[column + _NEIGHBOR_AT.heading_cosine, lane]
        sine = columns[column + _NEIGHBOR_AT.heading_sine, lane]
        write_direction(columns, column + _NEIGHBOR_AT.heading_cosine, lane, cosine, sine)
    for lane in range(world.lanes):
        forward = single(columns[column + _NEIGHBOR_AT.chain_bearing_cosine, lane])
        left = single(columns[column + _NEIGHBOR_AT.chain_bearing_sine, lane])
        write_place(columns, column + _NEIGHBOR_AT.chain_distance, lane, forward, left)
    for lane in range(world.lanes):
        gap = single(columns[column + _NEIGHBOR_AT.clearance, lane])
        columns[column + _NEIGHBOR_AT.clearance, lane] = _scale_signed(gap)
        footprint = single(columns[column + _NEIGHBOR_AT.footprint_radius, lane])
        columns[column + _NEIGHBOR_AT.footprint_radius, lane] = scale_distance(footprint)
        truck = single(columns[column + _NEIGHBOR_AT.truck_length, lane])
        columns[column + _NEIGHBOR_AT.truck_length, lane] = scale_length(truck)


@kernel
def _observe_chain(world, agent, k, columns, column, lane):
    """Write the columns of a neighbour's trailers."""
    joints = world.state.heading.shape[1] - 1
    for joint in range(1, neighbor_trailers(world, agent, k, lane) + 1):
        first = column + joint - 1
        length = neighbor_length(world, agent, k, joint, lane)
        cosine, sine = neighbor_articulation(world, agent, k, joint, lane)
        columns[first + _CHAIN_AT.length * joints, lane] = scale_length(single(length))
        columns[first + _CHAIN_AT.articulation_cosine * joints, lane] = clip(cosine, -1.0, 1.0)
        columns[first + _CHAIN_AT.articulation_sine * joints, lane] = clip(sine, -1.0, 1.0)


@kernel
def _observe_fronts(world, agent, k, columns, column, lane):
    """Write speed, nearness (0 from 10 m on, 1 at contact) and direction of the nearest point."""
    speed = neighbor_speed(world, agent, k, lane)
    columns[column + _FRONT_AT.speed, lane] = min(speed * (1.0 / SPEED_UNIT), 1.0)
    forward, left = neighbor_before_front(world, agent, k, lane)
    distance = sqrt(forward * forward + left * left)
    nearness = max(0.0, 1.0 - distance * (1.0 / _FRONT_RANGE))
    share = nearness / max(distance, TINY_DISTANCE)
    columns[column + _FRONT_AT.front_nearness, lane] = nearness
    columns[column + _FRONT_AT.front_ahead, lane] = share * forward
    columns[column + _FRONT_AT.front_aside, lane] = share * left
    exposed = max(0.0, 1.0 - neighbor_front_gap(world, agent, k, lane) * (1.0 / _FRONT_RANGE))
    columns[column + _FRONT_AT.exposed_nearness, lane] = exposed
