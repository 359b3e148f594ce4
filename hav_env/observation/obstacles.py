"""This module observes obstacles: their nearest points, and rays like those of a lidar.

Rays also see the bodies of other HAVs. Points and rays begin at the truck's rear axle.
"""

import math

from hav_env.compiled import fixed, generic, in_single, kernel, single
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import TWO_PI
from hav_env.observation.columns import Column, place_columns, places_of, write_place
from hav_env.observation.scratch import (
    POINT_FORWARD,
    POINT_LEFT,
    POINT_SQUARED,
    SEEN_ALONG_X,
    SEEN_ALONG_Y,
    SEEN_HALF,
    SEEN_WIDTH,
    SEEN_X,
    SEEN_Y,
)
from hav_env.world.chain import ends_behind, front_axle
from hav_env.world.obstacles.nearest import obstacle_point
from hav_env.world.obstacles.rays import (
    ahead_of,
    may_be_within,
    seen_body,
    seen_segment,
    to_rectangle,
    to_segment,
)
from hav_env.world.other_havs import FRONT_X, FRONT_Y
from hav_env.world.place.segments import Obstacles, Plane

POINT_COLUMNS = (Column("present"), *place_columns(""))
_AT = places_of(POINT_COLUMNS)
OBSTACLE_SIZE = len(POINT_COLUMNS)
_NOBODY_SQUARED = 1e20  # [m^2], farther than any segment is but those that a world does not have

_to_segment, _to_rectangle = in_single(to_segment), in_single(to_rectangle)
_ahead_of = in_single(ahead_of)


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
    """Write the nearest points of the K nearest segments, nearest first; zeros if there are fewer.

    Args:
        place: of the block.
        observation: settled for the number of HAVs.
        world: a block.
        agent: which HAV.
        scratch: a ``Scratch``.
        columns: (D, L) to be written.
        first: the first column of the obstacles.
    """


@observe_obstacles.register(Plane)
def _see_nothing(place, observation, world, agent, scratch, columns, first):
    for number in range(first, first + OBSTACLE_SIZE * observation.obstacles):
        column = fixed(number)
        for lane in range(world.lanes):
            columns[column, lane] = 0.0


@observe_obstacles.register(Obstacles)
def _see_nearest(place, observation, world, agent, scratch, columns, first):
    last = fixed(first + OBSTACLE_SIZE * (observation.obstacles - 1) + _AT.distance)
    for rank in range(observation.obstacles):
        column = fixed(first + OBSTACLE_SIZE * rank)
        for lane in range(world.lanes):
            columns[column + _AT.distance, lane] = math.inf
            columns[column + _AT.bearing_cosine, lane] = 0.0
            columns[column + _AT.bearing_sine, lane] = 0.0
    for segment in range(_most_segments(place, world)):
        nearer = _look_at_segment(world, agent, fixed(segment), scratch.rows, columns[last])
        if nearer > 0:
            for rank in range(observation.obstacles):
                column = fixed(first + OBSTACLE_SIZE * rank)
                _sort_in(world, scratch.rows, columns, column)
    for rank in range(observation.obstacles):
        column = fixed(first + OBSTACLE_SIZE * rank)
        for lane in range(world.lanes):
            present = columns[column + _AT.distance, lane] < single(_NOBODY_SQUARED)
            forward = single(columns[column + _AT.bearing_cosine, lane])
            left = single(columns[column + _AT.bearing_sine, lane])
            columns[column + _AT.present, lane] = 1.0 if present else 0.0
            write_place(columns, column + _AT.distance, lane, forward, left)


@kernel
def _most_segments(place, world):
    """Return how many segments there are in any lane, at most."""
    most = 0
    for lane in range(world.lanes):
        most = max(most, place.count[lane])
    return most


@kernel
def _look_at_segment(world, agent, segment, rows, farthest):
    """Write where a segment is nearest; return in how many lanes it is nearer than the farthest."""
    nearer = 0
    for lane in range(world.lanes):
        forward, left = obstacle_point(world, agent, segment, lane)
        rows[POINT_FORWARD, lane], rows[POINT_LEFT, lane] = forward, left
        rows[POINT_SQUARED, lane] = forward * forward + left * left
    for lane in range(world.lanes):
        nearer += rows[POINT_SQUARED, lane] < farthest[lane]
    return nearer


@kernel
def _sort_in(world, rows, columns, column):
    """Put the point at hand into a rank where it is nearer than the one there, and take that one.

    Of equally near ones the first stays.
    """
    for lane in range(world.lanes):
        squared, kept = rows[POINT_SQUARED, lane], columns[column + _AT.distance, lane]
        nearer = squared < kept
        columns[column + _AT.distance, lane] = squared if nearer else kept
        rows[POINT_SQUARED, lane] = kept if nearer else squared
        forward, other = rows[POINT_FORWARD, lane], columns[column + _AT.bearing_cosine, lane]
        columns[column + _AT.bearing_cosine, lane] = forward if nearer else other
        rows[POINT_FORWARD, lane] = other if nearer else forward
        left, other = rows[POINT_LEFT, lane], columns[column + _AT.bearing_sine, lane]
        columns[column + _AT.bearing_sine, lane] = left if nearer else other
        rows[POINT_LEFT, lane] = other if nearer else left


@kernel
def observe_rays(observation, world, agent, scratch, columns, first):
    """Write how far it is to what each ray meets, as a share of the rays' range.

    Args:
        observation: settled for the number of HAVs.
        world: a block.
        agent: which HAV.
        scratch: a ``Scratch``.
        columns: (D, L) to be written.
        first: the first column of the rays.
    """
    most = single(observation.ray_range)
    for number in range(observation.rays):
        column = fixed(first + number)
        for lane in range(world.lanes):
            columns[column, lane] = most
    _cast_at_obstacles(world.place, observation, world, agent, scratch, columns, first)
    for other in range(world.state.x.shape[0]):
        if other != agent and _within(observation, world, agent, fixed(other)) > 0:
            _cast_at_hav(observation, world, agent, fixed(other), scratch, columns, first)
    per_range = single(1.0 / observation.ray_range)
    for number in range(observation.rays):
        column = fixed(first + number)
        for lane in range(world.lanes):
            columns[column, lane] = min(columns[column, lane] * per_range, single(1.0))


@kernel
def ray_direction(number, rays):
    """Return cosine and sine of the direction of a ray of so many, in the truck's frame."""
    sine, cosine = sincos(TWO_PI * number / rays)
    return cosine, sine


@generic
def _cast_at_obstacles(place, observation, world, agent, scratch, columns, first):
    """Shorten the rays that meet obstacles."""


@_cast_at_obstacles.register(Plane)
def _cast_at_nothing(place, observation, world, agent, scratch, columns, first):
    pass


@_cast_at_obstacles.register(Obstacles)
def _cast_at_segments(place, observation, world, agent, scratch, columns, first):
    rows, squared_range = scratch.rows, single(observation.ray_range * observation.ray_range)
    half = observation.rays // 2
    for number in range(_most_segments(place, world)):
        segment, within = fixed(number), 0
        for lane in range(world.lanes):
            forward, left = obstacle_point(world, agent, segment, lane)
            within += forward * forward + left * left <= squared_range
        if within == 0:
            continue
        for lane in range(world.lanes):
            x, y, half_x, half_y = seen_segment(place, world, agent, segment, lane)
            rows[SEEN_X, lane], rows[SEEN_Y, lane] = x, y
            rows[SEEN_ALONG_X, lane], rows[SEEN_ALONG_Y, lane] = half_x, half_y
        for ray in range(half):
            cosine, sine = ray_direction(ray, observation.rays)
            ahead, behind = fixed(first + ray), fixed(first + half + ray)
            for lane in range(world.lanes):
                length = _to_segment(
                    single(cosine),
                    single(sine),
                    rows[SEEN_X, lane],
                    rows[SEEN_Y, lane],
                    rows[SEEN_ALONG_X, lane],
                    rows[SEEN_ALONG_Y, lane],
                )
                columns[ahead, lane] = min(columns[ahead, lane], _ahead_of(length, length))
                columns[behind, lane] = min(columns[behind, lane], _ahead_of(-length, -length))


@kernel
def _within(observation, world, agent, other):
    """Return in how many lanes another HAV may be within the range of the rays."""
    within = 0
    for lane in range(world.lanes):
        within += may_be_within(world, agent, other, observation.ray_range, lane)
    return within


@kernel
def _cast_at_hav(observation, world, agent, other, scratch, columns, first):
    """Shorten the rays that meet the bodies of another HAV."""
    rows, chain, half = scratch.rows, scratch.chain, observation.rays // 2
    for lane in range(world.lanes):
        x, y = front_axle(world, other, lane)
        chain[FRONT_X, lane], chain[FRONT_Y, lane] = x, y
    for number in range(world.state.heading.shape[1]):
        unit = fixed(number)
        for lane in range(world.lanes):
            front_x, front_y = chain[FRONT_X, lane], chain[FRONT_Y, lane]
            x, y, along_x, along_y, length, width = seen_body(
                world, agent, other, unit, lane, front_x, front_y
            )
            rows[SEEN_X, lane], rows[SEEN_Y, lane] = x, y
            rows[SEEN_ALONG_X, lane], rows[SEEN_ALONG_Y, lane] = along_x, along_y
            rows[SEEN_HALF, lane], rows[SEEN_WIDTH, lane] = length, width
            _, _, front_x, front_y = ends_behind(world, other, unit, lane, front_x, front_y)
            chain[FRONT_X, lane], chain[FRONT_Y, lane] = front_x, front_y
        for ray in range(half):
            cosine, sine = ray_direction(ray, observation.rays)
            ahead, behind = fixed(first + ray), fixed(first + half + ray)
            for lane in range(world.lanes):
                near, far = _to_rectangle(
                    single(cosine),
                    single(sine),
                    rows[SEEN_X, lane],
                    rows[SEEN_Y, lane],
                    rows[SEEN_ALONG_X, lane],
                    rows[SEEN_ALONG_Y, lane],
                    rows[SEEN_HALF, lane],
                    rows[SEEN_WIDTH, lane],
                )
                columns[ahead, lane] = min(columns[ahead, lane], _ahead_of(near, far))
                columns[behind, lane] = min(columns[behind, lane], _ahead_of(-far, -near))
