"""This module observes rays like those of a lidar: distances to obstacles and to other HAVs.

A ray begins at the truck's rear axle. In all lanes at once, the kernels find the sector of
directions in which a segment may shorten rays. Then each lane whose sector has rays casts these, a
whole vector of them at a time.
"""

import math

from hav_env.compiled import (
    TILE_SIDE,
    VECTOR,
    fixed,
    generic,
    kernel,
    local_array,
    local_singles,
    rare_kernel,
    single,
    transpose_tile,
)
from hav_env.maths.elementary import nearest_whole, sincos
from hav_env.maths.geometry import TURNS_PER_RADIAN, TWO_PI
from hav_env.observation.columns import TINY_DISTANCE
from hav_env.world.chain import ends_behind, front_axle
from hav_env.world.lanes import APART, OBSERVED_LANES
from hav_env.world.obstacles.rays import (
    across_segment,
    ahead_of,
    may_be_within,
    may_lie_along,
    seen_body,
    seen_segment,
    to_rectangle,
    to_segment,
)
from hav_env.world.place.segments import HALF_LENGTH, Obstacles, Plane

# of a segment or a body in the truck's frame: its middle, the vector from there to one end, and the
# radius of the circle round it [m]; its sector, see ``_sector``; the lanes with sectors
_SEEN_X, _SEEN_Y, _SEEN_HALF_X, _SEEN_HALF_Y, _SEEN_RADIUS, _SEEN_SECTOR, _SEEN_LANE, _SEEN_ROWS = (
    range(8)
)
# front end of the unit at hand [m]; its body, see ``seen_body``
(
    _BODY_FRONT_X,
    _BODY_FRONT_Y,
    _BODY_X,
    _BODY_Y,
    _BODY_COSINE,
    _BODY_SINE,
    _BODY_HALF,
    _BODY_WIDTH,
    _BODY_ROWS,
) = range(9)
_DIRECTIONS = 2  # rows: cosine and sine of each ray
_RAYS_AT_BODY = 8  # rays that are cast at a body together: doubles of a vector
_WIDER_SECTOR = 2e-3  # [rad], more than the errors of the polynomial and of single precision
_TO_DIAGONAL = 0.29289  # at most 1 - 1 / sqrt(2)
_TO_QUARTER = 0.5 * math.pi - 1.0 + 1e-6  # at least the arcsine of 1 less 1
_SQUARES_SLACK = 1.0 + 1e-5  # more than single precision rounds squares of distances
_PER_COUNT = 256.0  # a sector is a number: its first ray plus this times its number of rays
_RAY_BITS, _RAY_MASK = 8, 0xFF


@kernel
def rays_towards(rays, x, y, radius):
    """Return the first ray that may meet a circle, given its middle [m], and the ray count.

    The other rays follow counter-clockwise, ray 0 after the last one. The kernel never leaves out a
    ray that meets the circle, and may add one at either side.

    With t = small / large, the distance of the middle is large * sqrt(1 + t^2). The function 1 /
    sqrt(1 + z) is convex, so it is below its chord from z = 0 to 1. The arcsine of a share, over
    that share, is convex in the square of the share, so it is below its chord too. The polynomial
    is within 7e-4 rad of the arctangent of t.
    """
    small, large = min(abs(x), abs(y)), max(abs(x), abs(y))
    per_large = 1.0 / max(large, TINY_DISTANCE)
    t = small * per_large
    z = t * t
    share = min(radius * per_large * (1.0 - _TO_DIAGONAL * z), 1.0)
    half = share + _TO_QUARTER * share * (share * share) + _WIDER_SECTOR
    angle = t * (0.995354 + z * (0.079331 * z - 0.288679))
    angle = 0.5 * math.pi - angle if abs(y) > abs(x) else angle
    angle = math.pi - angle if x < 0.0 else angle
    angle = -angle if y < 0.0 else angle
    per_step = rays * TURNS_PER_RADIAN
    first = nearest_whole((angle - half) * per_step)
    count = min(nearest_whole((angle + half) * per_step) - first + 1.0, rays)
    inside = share == 1.0
    first = first + rays if first < 0.0 else first
    return 0.0 if inside else first, rays if inside else count


@kernel
def _sector(rays, most, x, y, radius):
    """Return the rays that may meet a circle within a range [m] as one number, 0 for none."""
    within = most + radius
    near = x * x + y * y <= within * within * _SQUARES_SLACK
    first, count = rays_towards(rays, x, y, radius)
    return first + count * _PER_COUNT if near & (count > 0.0) else 0.0


@rare_kernel
def observe_rays(observation, world, agent, columns, first):
    """Write the distance at which each ray meets something, as a share of the range of the rays.

    Args:
        observation: Observation settings, as ``settle`` returns them.
        world: Block of at most ``OBSERVED_LANES`` worlds.
        agent: Index of the HAV.
        columns: (D, L) columns to write.
        first: First column of the rays.
    """
    directions = local_singles(_DIRECTIONS, APART)
    lengths = local_singles(OBSERVED_LANES, APART)  # of rays, lane by lane [m]
    seen, body = local_singles(_SEEN_ROWS, APART), local_array(1, _BODY_ROWS, APART)[0]
    rays, most = observation.rays, single(observation.ray_range)
    for ray in range(rays):
        sine, cosine = sincos(TWO_PI * ray / rays)
        directions[0, ray], directions[1, ray] = cosine, sine
    for ray in range(VECTOR):  # a vector may reach beyond the last ray, to the first ones
        for part in range(_DIRECTIONS):
            directions[part, rays + ray] = directions[part, ray % rays]
    for lane in range(world.lanes):
        for ray in range(rays + VECTOR):
            lengths[lane, ray] = most
    _cast_at_obstacles(world.place, observation, world, agent, directions, lengths, seen)
    for other in range(world.state.x.shape[0]):
        if other != agent:
            _cast_at_hav(observation, world, agent, other, directions, lengths, seen, body)
    for lane in range(world.lanes):
        for ray in range(rays + VECTOR - 1, rays - 1, -1):
            lengths[lane, ray - rays] = min(lengths[lane, ray - rays], lengths[lane, ray])
    _write_lengths(rays, world.lanes, lengths, columns, first)
    per_range = single(1.0 / observation.ray_range)
    for number in range(rays):
        column = fixed(first + number)
        for lane in range(world.lanes):
            columns[column, lane] = min(columns[column, lane] * per_range, single(1.0))


@kernel
def _write_lengths(rays, lanes, lengths, columns, first):
    """Write columns[first + ray, lane] = lengths[lane, ray], tile by tile where possible."""
    whole = lanes // TILE_SIDE * TILE_SIDE if rays >= TILE_SIDE else 0
    last = rays - TILE_SIDE  # the last tile may overlap the one before
    for lane in range(0, whole, TILE_SIDE):
        for ray in range(0, last, TILE_SIDE):
            transpose_tile(lengths, lane, ray, columns, first + ray, lane)
        transpose_tile(lengths, lane, last, columns, first + last, lane)
    for lane in range(whole, lanes):
        for ray in range(rays):
            columns[first + ray, lane] = lengths[lane, ray]


@kernel
def _list_lanes(lanes, seen):
    """List the lanes with a sector; return their number."""
    listed = 0
    for lane in range(lanes):
        seen[_SEEN_LANE, listed] = lane
        listed += 1 if seen[_SEEN_SECTOR, lane] != 0.0 else 0
    return listed


@kernel
def _turn_on(ray, steps, rays):
    """Return the index of the ray so many steps after a ray, at most a whole turn."""
    ray += steps
    return (ray - rays if ray >= rays else ray) & _RAY_MASK


@generic
def _cast_at_obstacles(place, observation, world, agent, directions, lengths, seen):
    """Shorten the rays that meet obstacles."""


@_cast_at_obstacles.register(Plane)
def _cast_at_nothing(place, observation, world, agent, directions, lengths, seen):
    pass


@_cast_at_obstacles.register(Obstacles)
def _cast_at_segments(place, observation, world, agent, directions, lengths, seen):
    most = 0
    for lane in range(world.lanes):
        most = max(most, place.count[lane])
    for number in range(most):
        _look_at_segment(place, observation, world, agent, fixed(number), seen)
        for k in range(_list_lanes(world.lanes, seen)):
            lane = int(seen[_SEEN_LANE, k]) & _RAY_MASK
            segment = (
                seen[_SEEN_X, lane],
                seen[_SEEN_Y, lane],
                seen[_SEEN_HALF_X, lane],
                seen[_SEEN_HALF_Y, lane],
            )
            sector = int(seen[_SEEN_SECTOR, lane])
            across, sector = sector > 0, abs(sector)
            ray, left = sector & _RAY_MASK, sector >> _RAY_BITS
            while left > 0:
                cosine = directions[0, ray : ray + VECTOR]
                sine = directions[1, ray : ray + VECTOR]
                length = lengths[lane, ray : ray + VECTOR]
                if across:
                    for i in range(VECTOR):
                        met = across_segment(cosine[i], sine[i], *segment)
                        length[i] = min(length[i], met)
                else:
                    for i in range(VECTOR):
                        met = to_segment(cosine[i], sine[i], *segment)
                        length[i] = min(length[i], met)
                ray, left = _turn_on(ray, VECTOR, observation.rays), left - VECTOR


@kernel
def _look_at_segment(place, observation, world, agent, number, seen):
    """Write a segment in the truck's frame and its sector: below 0 if rays may lie along it."""
    rays, most = single(observation.rays), single(observation.ray_range)
    for lane in range(world.lanes):
        x, y, half_x, half_y = seen_segment(place, world, agent, number, lane)
        seen[_SEEN_X, lane], seen[_SEEN_Y, lane] = x, y
        seen[_SEEN_HALF_X, lane], seen[_SEEN_HALF_Y, lane] = half_x, half_y
        seen[_SEEN_RADIUS, lane] = place.segment[number, HALF_LENGTH, lane]
    for lane in range(world.lanes):
        x, y, radius = seen[_SEEN_X, lane], seen[_SEEN_Y, lane], seen[_SEEN_RADIUS, lane]
        sector = _sector(rays, most, x, y, radius)
        along = may_lie_along(x, y, seen[_SEEN_HALF_X, lane], seen[_SEEN_HALF_Y, lane], radius)
        seen[_SEEN_SECTOR, lane] = -sector if along else sector


@kernel
def _cast_at_hav(observation, world, agent, other, directions, lengths, seen, body):
    """Shorten the rays that meet the bodies of another HAV.

    Few lanes are near it. Their bodies are in the first places of the rows.
    """
    for lane in range(world.lanes):
        near = may_be_within(world, agent, other, observation.ray_range, lane)
        seen[_SEEN_SECTOR, lane] = 1.0 if near else 0.0
    listed = _list_lanes(world.lanes, seen)
    for k in range(listed):
        lane = int(seen[_SEEN_LANE, k])
        body[_BODY_FRONT_X, k], body[_BODY_FRONT_Y, k] = front_axle(world, other, lane)
    for unit in range(world.state.heading.shape[1]):
        listed = _look_at_body(observation, world, agent, other, unit, listed, seen, body)
        for k in range(listed):
            lane, sector = int(seen[_SEEN_LANE, k]) & _RAY_MASK, int(seen[_SEEN_SECTOR, k])
            rectangle = (
                *(body[_BODY_X, k], body[_BODY_Y, k], body[_BODY_COSINE, k], body[_BODY_SINE, k]),
                *(body[_BODY_HALF, k], body[_BODY_WIDTH, k]),
            )
            ray, left = sector & _RAY_MASK, sector >> _RAY_BITS
            while left > 0:
                cosine = directions[0, ray : ray + _RAYS_AT_BODY]
                sine = directions[1, ray : ray + _RAYS_AT_BODY]
                length = lengths[lane, ray : ray + _RAYS_AT_BODY]
                for i in range(_RAYS_AT_BODY):
                    inside = to_rectangle(float(cosine[i]), float(sine[i]), *rectangle)
                    length[i] = min(length[i], single(ahead_of(*inside)))
                ray, left = _turn_on(ray, _RAYS_AT_BODY, observation.rays), left - _RAYS_AT_BODY


@kernel
def _look_at_body(observation, world, agent, other, unit, listed, seen, body):
    """Write the bodies of a unit and their sectors for the listed lanes in which it exists.

    Returns:
        Number of lanes that remain on the list.
    """
    rays, most, remaining = single(observation.rays), single(observation.ray_range), 0
    for k in range(listed):
        lane = int(seen[_SEEN_LANE, k])
        x, y = body[_BODY_FRONT_X, k], body[_BODY_FRONT_Y, k]
        found = seen_body(world, agent, other, unit, lane, x, y)
        body[_BODY_X, remaining], body[_BODY_Y, remaining] = found[0], found[1]
        body[_BODY_COSINE, remaining], body[_BODY_SINE, remaining] = found[2], found[3]
        body[_BODY_HALF, remaining], body[_BODY_WIDTH, remaining] = found[4], found[5]
        _, _, x, y = ends_behind(world, other, unit, lane, x, y)
        body[_BODY_FRONT_X, remaining], body[_BODY_FRONT_Y, remaining] = x, y
        seen[_SEEN_LANE, remaining] = lane
        remaining += 1 if unit <= world.fleet.num_trailers[other, lane] else 0
    for k in range(remaining):
        half, width = single(body[_BODY_HALF, k]), single(body[_BODY_WIDTH, k])
        x, y = single(body[_BODY_X, k]), single(body[_BODY_Y, k])
        seen[_SEEN_SECTOR, k] = _sector(rays, most, x, y, half + width)
    return remaining
