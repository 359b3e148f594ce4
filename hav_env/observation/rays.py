"""This module observes rays like those of a lidar: distances to obstacles and to other HAVs.

A ray begins at the truck's rear axle. In all lanes at once, the kernels find the sector of
directions in which a segment may shorten rays. They pack the answers, whether a sector has rays,
into bits of integers: it takes less time to find the next bit than to compare lane by lane. Each
lane whose sector has rays casts these, a whole vector of them at a time.
"""

from hav_env.compiled import (
    TILE_SIDE,
    VECTOR,
    fixed,
    generic,
    kernel,
    lanes_from,
    local_array,
    local_singles,
    lowest_bit,
    rare_kernel,
    single,
    transpose_tile,
)
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import TWO_PI
from hav_env.observation.sectors import RAY_MASK, SECTORS, sector_of, unpack_sector, with_rays
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

# of a segment in the truck's frame: its middle, the vector from there to one end, and the radius of
# the circle round it [m]; the sector of a segment or a body; the lanes of bodies of even units and
# of odd ones
(
    _SEEN_X,
    _SEEN_Y,
    _SEEN_HALF_X,
    _SEEN_HALF_Y,
    _SEEN_RADIUS,
    _SEEN_SECTOR,
    _SEEN_LANE,
    _ODD_LANE,
    _SEEN_ROWS,
) = range(9)
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
_LANE_MASK = 0xFF  # compiled code then knows that a lane is not negative


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
def _turn_on(ray, steps, rays):
    """Return the index of the ray so many steps after a ray, at most a whole turn."""
    ray += steps
    return (ray - rays if ray >= rays else ray) & RAY_MASK


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
        for start in range(0, world.lanes, SECTORS):
            bits = with_rays(seen[_SEEN_SECTOR], start, world.lanes)
            while bits != 0:
                lane = (start + lowest_bit(bits)) & _LANE_MASK
                bits &= bits - 1
                _cast_at_segment(observation, lane, directions, lengths, seen)


@kernel
def _cast_at_segment(observation, lane, directions, lengths, seen):
    """Shorten the rays of a lane that meet the segment at hand."""
    segment = (
        *(seen[_SEEN_X, lane], seen[_SEEN_Y, lane]),
        *(seen[_SEEN_HALF_X, lane], seen[_SEEN_HALF_Y, lane]),
    )
    sector = int(seen[_SEEN_SECTOR, lane])
    across = sector > 0
    ray, left = unpack_sector(abs(sector))
    while left > 0:
        towards, length = lanes_from(directions, ray), lanes_from(lengths, ray)
        if across:
            for i in range(VECTOR):
                met = across_segment(towards[0, i], towards[1, i], *segment)
                length[lane, i] = min(length[lane, i], met)
        else:
            for i in range(VECTOR):
                met = to_segment(towards[0, i], towards[1, i], *segment)
                length[lane, i] = min(length[lane, i], met)
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
        sector = sector_of(rays, most, x, y, radius)
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
    listed, unit = 0, 0
    for start in range(0, world.lanes, SECTORS):
        bits = with_rays(seen[_SEEN_SECTOR], start, world.lanes)
        while bits != 0:
            lane = (start + lowest_bit(bits)) & _LANE_MASK
            bits &= bits - 1
            seen[_SEEN_LANE, listed] = lane
            body[_BODY_FRONT_X, listed], body[_BODY_FRONT_Y, listed] = front_axle(
                world, other, lane
            )
            listed += 1
    while listed > 0:
        own = _SEEN_LANE + (unit & 1)
        pulling = _look_at_body(observation, world, agent, other, unit, listed, seen, body)
        for start in range(0, listed, SECTORS):
            bits = with_rays(seen[_SEEN_SECTOR], start, listed)
            while bits != 0:
                k = (start + lowest_bit(bits)) & _LANE_MASK
                bits &= bits - 1
                lane = int(seen[own, k]) & _LANE_MASK
                _cast_at_body(observation, lane, k, directions, lengths, seen, body)
        listed, unit = pulling, unit + 1


@kernel
def _cast_at_body(observation, lane, place, directions, lengths, seen, body):
    """Shorten the rays of a lane that meet the body in a place of the rows."""
    rectangle = (
        *(body[_BODY_X, place], body[_BODY_Y, place], body[_BODY_COSINE, place]),
        *(body[_BODY_SINE, place], body[_BODY_HALF, place], body[_BODY_WIDTH, place]),
    )
    ray, left = unpack_sector(int(seen[_SEEN_SECTOR, place]))
    while left > 0:
        towards, length = lanes_from(directions, ray), lanes_from(lengths, ray)
        for i in range(_RAYS_AT_BODY):
            inside = to_rectangle(float(towards[0, i]), float(towards[1, i]), *rectangle)
            length[lane, i] = min(length[lane, i], single(ahead_of(*inside)))
        ray, left = _turn_on(ray, _RAYS_AT_BODY, observation.rays), left - _RAYS_AT_BODY


@kernel
def _look_at_body(observation, world, agent, other, unit, listed, seen, body):
    """Write the bodies of a unit and their sectors for the listed lanes.

    Returns:
        Number of lanes in which the HAV has a unit behind: they are listed for that unit.
    """
    rays, most, pulling = single(observation.rays), single(observation.ray_range), 0
    own, behind = _SEEN_LANE + (unit & 1), _ODD_LANE - (unit & 1)
    for k in range(listed):
        lane = int(seen[own, k]) & _LANE_MASK
        x, y = body[_BODY_FRONT_X, k], body[_BODY_FRONT_Y, k]
        found = seen_body(world, agent, other, unit, lane, x, y)
        body[_BODY_X, k], body[_BODY_Y, k] = found[0], found[1]
        body[_BODY_COSINE, k], body[_BODY_SINE, k] = found[2], found[3]
        body[_BODY_HALF, k], body[_BODY_WIDTH, k] = found[4], found[5]
        _, _, x, y = ends_behind(world, other, unit, lane, x, y)
        body[_BODY_FRONT_X, pulling], body[_BODY_FRONT_Y, pulling] = x, y
        seen[behind, pulling] = lane
        pulling += 1 if unit < world.fleet.num_trailers[other, lane] else 0
    for k in range(listed):
        half, width = single(body[_BODY_HALF, k]), single(body[_BODY_WIDTH, k])
        x, y = single(body[_BODY_X, k]), single(body[_BODY_Y, k])
        seen[_SEEN_SECTOR, k] = sector_of(rays, most, x, y, half + width)
    return pulling
