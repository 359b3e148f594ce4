"""This module observes obstacles: their nearest points, and rays like those of a lidar.

Rays also see the bodies of other HAVs. Points and rays begin at the truck's rear axle.
"""

import math

from hav_env.compiled import fixed, generic, kernel, single
from hav_env.maths.elementary import atan2, floor, sincos, sqrt
from hav_env.maths.geometry import TURNS_PER_RADIAN, TWO_PI, clip, into_frame
from hav_env.observation.columns import TINY_DISTANCE, Column, place_columns, places_of, write_place
from hav_env.observation.scratch import (
    FIRST_RAY,
    RAY_COSINE,
    RAY_COUNT,
    RAY_SINE,
    SEEN_HALF_X,
    SEEN_HALF_Y,
    SEEN_NUMBER,
    SEEN_SQUARED,
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
from hav_env.world.place.segments import Obstacles, Plane, segment_of

POINT_COLUMNS = (Column("present"), *place_columns(""))
_AT = places_of(POINT_COLUMNS)
OBSTACLE_SIZE = len(POINT_COLUMNS)
_ABSENT_SQUARED = 1e20  # [m^2]: all segments are nearer than that, absent segments are farther
_WIDER = 1e-3  # [rad], more than the single-precision error of an angle


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


@kernel
def observe_rays(observation, world, agent, scratch, columns, first):
    """Write the distance at which each ray meets something, as a share of the range of the rays.

    Args:
        observation: Observation settings, as ``settle`` returns them.
        world: Block of worlds.
        agent: Index of the HAV.
        scratch: Scratch rows, a ``Scratch``.
        columns: (D, L) columns to write.
        first: First column of the rays.
    """
    most = single(observation.ray_range)
    for number in range(observation.rays):
        column = fixed(first + number)
        sine, cosine = sincos(TWO_PI * number / observation.rays)
        scratch.rows[RAY_COSINE, number], scratch.rows[RAY_SINE, number] = cosine, sine
        for lane in range(world.lanes):
            columns[column, lane] = most
    _cast_at_obstacles(world.place, observation, world, agent, scratch.rows, columns, first)
    for other in range(world.state.x.shape[0]):
        for lane in range(world.lanes):
            near = may_be_within(world, agent, other, observation.ray_range, lane)
            if near and other != agent:
                _cast_at_hav(observation, world, agent, other, scratch.rows, columns, first, lane)
    per_range = single(1.0 / observation.ray_range)
    for number in range(observation.rays):
        column = fixed(first + number)
        for lane in range(world.lanes):
            columns[column, lane] = min(columns[column, lane] * per_range, single(1.0))


@kernel
def rays_towards(rays, x, y, radius):
    """Return the first ray that may meet a circle, given its middle [m], and the ray count.

    The index of the first ray may be below 0: rays count from forward in either direction.
    """
    distance = sqrt(x * x + y * y)
    # the arcsine of a share from 0 to 1 is at most that share of a quarter turn
    share = min(radius / max(distance, TINY_DISTANCE), 1.0)
    half = 0.5 * math.pi * share + _WIDER
    per_step = rays * TURNS_PER_RADIAN
    angle = atan2(y, x)
    first = floor((angle - half) * per_step) + 1.0
    count = min(floor((angle + half) * per_step) - first + 1.0, rays)
    inside = share == 1.0
    return 0.0 if inside else first, rays if inside else count


@generic
def _cast_at_obstacles(place, observation, world, agent, rows, columns, first):
    """Shorten the rays that meet obstacles."""


@_cast_at_obstacles.register(Plane)
def _cast_at_nothing(place, observation, world, agent, rows, columns, first):
    pass


@_cast_at_obstacles.register(Obstacles)
def _cast_at_segments(place, observation, world, agent, rows, columns, first):
    """Find the rays that may meet a segment in all lanes, then cast them."""
    rays = observation.rays
    for number in range(_most_segments(place, world)):
        _look_at_segment(place, observation, world, agent, fixed(number), rows)
        for lane in range(world.lanes):
            count = int(rows[RAY_COUNT, lane])
            ray = (int(rows[FIRST_RAY, lane]) + rays) % rays
            for _ in range(count):
                met = to_segment(
                    rows[RAY_COSINE, ray],
                    rows[RAY_SINE, ray],
                    rows[SEEN_X, lane],
                    rows[SEEN_Y, lane],
                    rows[SEEN_HALF_X, lane],
                    rows[SEEN_HALF_Y, lane],
                )
                columns[first + ray, lane] = min(columns[first + ray, lane], met)
                ray = ray + 1 if ray + 1 < rays else 0


@kernel
def _look_at_segment(place, observation, world, agent, number, rows):
    """Write a segment in the truck's frame and the rays that may meet it: none out of range."""
    squared_range = single(observation.ray_range * observation.ray_range)
    _measure_segment(place, world, agent, number, rows)
    for lane in range(world.lanes):
        x, y, half_x, half_y = seen_segment(place, world, agent, number, lane)
        rows[SEEN_X, lane], rows[SEEN_Y, lane] = x, y
        rows[SEEN_HALF_X, lane], rows[SEEN_HALF_Y, lane] = half_x, half_y
    for lane in range(world.lanes):
        half_x, half_y = rows[SEEN_HALF_X, lane], rows[SEEN_HALF_Y, lane]
        ray, count = rays_towards(
            single(observation.rays),
            rows[SEEN_X, lane],
            rows[SEEN_Y, lane],
            sqrt(half_x * half_x + half_y * half_y),
        )
        within = rows[SEEN_SQUARED, lane] <= squared_range
        rows[FIRST_RAY, lane] = ray
        rows[RAY_COUNT, lane] = count if within else 0.0


@kernel
def _cast_at_hav(observation, world, agent, other, rows, columns, first, lane):
    """Shorten the rays that meet the bodies of another HAV."""
    front_x, front_y = front_axle(world, other, lane)
    for unit in range(world.fleet.num_trailers[other, lane] + 1):
        body = seen_body(world, agent, other, unit, lane, front_x, front_y)
        x, y, _, _, half, width = body
        radius = sqrt(half * half + width * width)
        ahead, count = rays_towards(float(observation.rays), x, y, radius)
        ray = (int(ahead) + observation.rays) % observation.rays
        for _ in range(int(count)):
            cosine, sine = float(rows[RAY_COSINE, ray]), float(rows[RAY_SINE, ray])
            met = single(ahead_of(*to_rectangle(cosine, sine, *body)))
            columns[first + ray, lane] = min(columns[first + ray, lane], met)
            ray = ray + 1 if ray + 1 < observation.rays else 0
        _, _, front_x, front_y = ends_behind(world, other, unit, lane, front_x, front_y)
