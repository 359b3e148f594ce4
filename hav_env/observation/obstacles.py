"""This module observes the points of obstacles that are nearest to the truck's rear axle."""

import math

from hav_env.compiled import fixed, generic, kernel, single
from hav_env.maths.geometry import clip, into_frame
from hav_env.observation.columns import Column, place_columns, places_of, write_place
from hav_env.observation.scratch import SEEN_NUMBER, SEEN_SQUARED
from hav_env.world.obstacles.nearest import obstacle_point
from hav_env.world.place.segments import Obstacles, Plane, segment_of

POINT_COLUMNS = (Column("present"), *place_columns(""))
_AT = places_of(POINT_COLUMNS)
OBSTACLE_SIZE = len(POINT_COLUMNS)
_ABSENT_SQUARED = 1e20  # [m^2]: all segments are nearer than that, absent segments are farther


def obstacle_columns(obstacles: int, rays: int) -> list[Column]:
    """Return the columns of the nearest points of obstacles, and of the rays."""
    found = [
        column._replace(name=f"obstacle_{k}_{column.name}")
        for k in range(obstacles)
        for column in POINT_COLUMNS
    ]
    return found + [Column(f"ray_{r}") for r in range(rays)]


@generic
def observe_obstacles(place, observation, world, agent, scratch, columns, first):
    """Write the nearest points of the K nearest segments, nearest first, then zeros.

    Args:
        place: Place of the block.
        observation: Observation settings, as ``settle`` returns them.
        world: Block of worlds.
        agent: Index of the HAV.
        scratch: Scratch rows, a ``Scratch``.
        columns: (D, L) columns to write.
        first: First column of the obstacles.
    """


@observe_obstacles.register(Plane)
def _see_nothing(place, observation, world, agent, scratch, columns, first):
    for number in range(first, first + OBSTACLE_SIZE * observation.obstacles):
        column = fixed(number)
        for lane in range(world.lanes):
            columns[column, lane] = 0.0


@observe_obstacles.register(Obstacles)
def _see_nearest(place, observation, world, agent, scratch, columns, first):
    """Sort segments by squared distance in all lanes, then describe the nearest ones."""
    for rank in range(observation.obstacles):
        column = fixed(first + OBSTACLE_SIZE * rank)
        for lane in range(world.lanes):
            columns[column + _AT.distance, lane] = math.inf
            columns[column + _AT.present, lane] = 0.0
    last = fixed(first + OBSTACLE_SIZE * (observation.obstacles - 1) + _AT.distance)
    for number in range(_most_segments(place, world)):
        _measure_segment(place, world, agent, fixed(number), scratch.rows)
        if _count_below(world, scratch.rows[SEEN_SQUARED], columns[last]) > 0:
            for rank in range(observation.obstacles):
                column = fixed(first + OBSTACLE_SIZE * rank)
                _sort_in(world, scratch.rows, columns, column)
    for rank in range(observation.obstacles):
        column = fixed(first + OBSTACLE_SIZE * rank)
        for lane in range(world.lanes):
            number = int(columns[column + _AT.present, lane])
            forward, left = obstacle_point(world, agent, number, lane)
            columns[column + _AT.bearing_cosine, lane] = forward
            columns[column + _AT.bearing_sine, lane] = left
        for lane in range(world.lanes):
            present = columns[column + _AT.distance, lane] < single(_ABSENT_SQUARED)
            forward = single(columns[column + _AT.bearing_cosine, lane])
            left = single(columns[column + _AT.bearing_sine, lane])
            columns[column + _AT.present, lane] = 1.0 if present else 0.0
            forward, left = forward if present else single(0.0), left if present else single(0.0)
            write_place(columns, column + _AT.distance, lane, forward, left)


@kernel
def _most_segments(place, world):
    """Return the largest number of segments in any lane."""
    most = 0
    for lane in range(world.lanes):
        most = max(most, place.count[lane])
    return most


@kernel
def _squared_distance(dx, dy, cosine, sine, half):
    """Return the squared distance [m^2] to a segment, given the position of its middle [m]."""
    along, across = into_frame(dx, dy, cosine, sine)
    beyond = along - clip(along, -half, half)
    return beyond * beyond + across * across


@kernel
def _measure_segment(place, world, agent, number, rows):
    """Write the squared distance of a segment from the HAV's rear axle, and the segment's index."""
    state = world.state
    for lane in range(world.lanes):
        x, y, cosine, sine, half, _ = segment_of(place, number, lane)
        dx, dy = single(x - state.x[agent, lane]), single(y - state.y[agent, lane])
        rows[SEEN_SQUARED, lane] = _squared_distance(
            dx, dy, single(cosine), single(sine), single(half)
        )
        rows[SEEN_NUMBER, lane] = number


@kernel
def _count_below(world, one, other):
    """Return the number of lanes in which one number is below another."""
    below = 0
    for lane in range(world.lanes):
        below += one[lane] < other[lane]
    return below


@kernel
def _sort_in(world, rows, columns, column):
    """Insert the segment at hand at a rank where it is nearer, and carry on the replaced one."""
    for lane in range(world.lanes):
        squared, kept = rows[SEEN_SQUARED, lane], columns[column + _AT.distance, lane]
        number, other = rows[SEEN_NUMBER, lane], columns[column + _AT.present, lane]
        nearer = squared < kept
        columns[column + _AT.distance, lane] = squared if nearer else kept
        rows[SEEN_SQUARED, lane] = kept if nearer else squared
        columns[column + _AT.present, lane] = number if nearer else other
        rows[SEEN_NUMBER, lane] = other if nearer else number
