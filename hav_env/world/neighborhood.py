"""This module finds the neighbours of each HAV within sensing range.

Every HAV has a circle round its truck's rear axle. Its radius is the sum of the HAV's reach and
half the sensing range, or more if the task has wider circles for potential collisions. Two HAVs
whose circles do not overlap neither sense each other nor collide.

In small worlds, all pairs of HAVs are compared in every step, in lanes, and no list is kept. In
larger swarms, a list of candidates persists between steps: the pairs whose circles, widened by a
margin, overlapped when the list was made. The list is valid while the circle of every HAV lies
within its widened circle of that time. The rule holds whatever has moved the HAVs, and whichever
world is in the lane.

In a large swarm, the cells of a grid limit the pairs that are compared for the list.
"""

from hav_env.compiled import fixed, kernel, rare_kernel
from hav_env.compiled.precision import either
from hav_env.maths.elementary import floor
from hav_env.world.arrays import (
    BUCKET,
    CENTER_X,
    CENTER_Y,
    CLOSE,
    COLUMN,
    FEW,
    HANDFUL,
    HIGHER,
    LOWER,
    NEXT,
    RADIUS,
    ROW,
)
from hav_env.world.collision import AXLE_ROUNDING, circle_radius, reach, squared_distance, within

# share of the longest radius of a world: wider lists hold more candidates, narrower ones are valid
# for fewer steps
_MARGIN = 0.1
# slightly wider, because rounding may separate circles that just touch: in each precision
_WIDER = 1.0 + 1e-9, 1.0 + 1e-6


@kernel
def as_place(number):
    """Return a HAV's 16-bit number as an array index, whose sign compiled code need not test."""
    return int(number & 0x7FFF)


@kernel
def find_nearby(task, world):
    """List, for every HAV, the others in sensing range, in ascending order.

    A HAV is in range if its distance is at most both reaches plus the sensing range.
    """
    num_havs = world.state.x.shape[0]
    for agent in range(num_havs):
        for lane in range(world.lanes):
            world.nearby.count[agent, lane] = 0
    if num_havs <= HANDFUL:
        _compare_all(task, world)
    else:
        _compare_candidates(task, world)


@kernel
def _compare_all(task, world):
    """Compare all pairs of HAVs in a small world, each pair in all lanes at once."""
    num_havs = world.state.x.shape[0]
    for number in range(num_havs):
        for second in range(number + 1, num_havs):
            agent, other = fixed(number), fixed(second)
            for lane in range(world.lanes):
                near = 1 if in_range(task, world, agent, other, lane) else 0
                _append(world, agent, other, lane, near)
                _append(world, other, agent, lane, near)


@kernel
def _compare_candidates(task, world):
    """Compare the pairs on the list of candidates of each lane; renew the list if necessary."""
    _check_candidates(task, world)
    for lane in range(world.lanes):
        if world.nearby.num_pairs[lane] < 0:
            _list_candidates(task, world, lane)
    for lane in range(world.lanes):
        pair = world.nearby.pair[world.first + lane]
        for place in range(world.nearby.num_pairs[lane]):
            agent, other = as_place(pair[place, LOWER]), as_place(pair[place, HIGHER])
            # pairs come in ascending order, so each list is in ascending order
            near = 1 if in_range(task, world, agent, other, lane) else 0
            _append(world, agent, other, lane, near)
            _append(world, other, agent, lane, near)
            pair[place, CLOSE] = 1 if may_touch(task, world, agent, other, lane) else 0


@kernel
def may_touch(task, world, agent, other, lane):
    """Return whether two HAVs, or their circles of the task, are so near that they may touch.

    If collisions between steps count, all HAVs that sense each other may have touched.
    """
    reaches = reach(world.fleet, agent, lane) + reach(world.fleet, other, lane)
    circles = circle_radius(task, world.fleet, agent, lane)
    circles += circle_radius(task, world.fleet, other, lane)
    squared = squared_distance(world, agent, other, lane)
    near = within(squared, max(reaches, circles) + AXLE_ROUNDING)
    sensed = within(squared, reaches + task.sensing_range)
    return near | ((task.continuous_collisions != 0) & sensed)


@kernel
def in_range(task, world, agent, other, lane):
    """Return whether two HAVs are in sensing range of each other."""
    reaches = reach(world.fleet, agent, lane) + reach(world.fleet, other, lane)
    return within(squared_distance(world, agent, other, lane), reaches + task.sensing_range)


@kernel
def _append(world, agent, other, lane, near):
    """Write a HAV after the neighbours of another; it counts as one of them if ``near`` is 1.

    The processor would often mispredict a branch here.
    """
    place = as_place(world.nearby.count[agent, lane])
    world.nearby.index[world.first + lane, agent, place] = other
    world.nearby.count[agent, lane] = place + near


@kernel
def _radius(task, world, agent, lane):
    """Return the radius [m] of the circle of a HAV, for sensing and for contact."""
    sensed = reach(world.fleet, agent, lane) + 0.5 * task.sensing_range
    return max(sensed, circle_radius(task, world.fleet, agent, lane))


@kernel
def _check_candidates(task, world):
    """Set the number of candidates below 0 in lanes whose list is no longer valid."""
    state, circle, num_pairs = world.state, world.nearby.circle, world.nearby.num_pairs
    for agent in range(state.x.shape[0]):
        for lane in range(world.lanes):
            dx = state.x[agent, lane] - circle[agent, CENTER_X, lane]
            dy = state.y[agent, lane] - circle[agent, CENTER_Y, lane]
            room = circle[agent, RADIUS, lane] - _radius(task, world, agent, lane)
            # a position that is not a number is in no circle
            holds = (room >= 0.0) & (dx * dx + dy * dy <= room * room)
            num_pairs[lane] = num_pairs[lane] if holds else -1


@rare_kernel
def _list_candidates(task, world, lane):
    """List the candidates of one world anew, and the circles in which the list is valid."""
    state, circle = world.state, world.nearby.circle
    num_havs, longest = state.x.shape[0], 0.0
    for agent in range(num_havs):
        longest = max(longest, _radius(task, world, agent, lane))
    for agent in range(num_havs):
        circle[agent, CENTER_X, lane] = state.x[agent, lane]
        circle[agent, CENTER_Y, lane] = state.y[agent, lane]
        radius = _radius(task, world, agent, lane) + _MARGIN * longest
        circle[agent, RADIUS, lane] = radius
    world.nearby.num_pairs[lane] = 0
    if num_havs <= FEW:
        for agent in range(num_havs):
            for other in range(agent + 1, num_havs):
                _list_pair(world, agent, other, lane)
    else:
        _search_grid(world, (1.0 + _MARGIN) * longest, lane)


@kernel
def _list_pair(world, agent, other, lane):
    """Put a pair on the list if its widened circles overlap."""
    nearby = world.nearby
    circle, pair = nearby.circle, nearby.pair[world.first + lane]
    dx = circle[other, CENTER_X, lane] - circle[agent, CENTER_X, lane]
    dy = circle[other, CENTER_Y, lane] - circle[agent, CENTER_Y, lane]
    limit = (circle[agent, RADIUS, lane] + circle[other, RADIUS, lane]) * either(dx, *_WIDER)
    if dx * dx + dy * dy <= limit * limit:
        pair[nearby.num_pairs[lane], LOWER] = agent
        pair[nearby.num_pairs[lane], HIGHER] = other
        nearby.num_pairs[lane] += 1


@kernel
def _search_grid(world, longest, lane):
    """List the candidates of one world, sorted into buckets by the square cells of a grid.

    All lanes of a block use the same scratch. HAVs whose circles overlap are in the same cell or in
    neighbouring cells.
    """
    grid = world.nearby.grid[world.first]
    _fill_buckets(world, grid, longest, lane)
    for agent in range(world.state.x.shape[0]):
        begin = world.nearby.num_pairs[lane]
        for across in range(-1, 2):
            for along in range(-1, 2):
                column, row = grid[COLUMN, agent] + across, grid[ROW, agent] + along
                _search_cell(world, grid, agent, column, row, lane)
        _sort(world.nearby.pair[world.first + lane], begin, world.nearby.num_pairs[lane])


@kernel
def _bucket_of(grid, column, row):
    # two odd primes spread neighbouring cells. The number of buckets is a power of two; the bits
    # that it drops are dropped first, because products of far cells have more than 64
    bits = grid.shape[1] - 1
    return ((column & bits) * 73856093 ^ (row & bits) * 19349663) & bits


@kernel
def _fill_buckets(world, grid, longest, lane):
    # still slightly larger, because rounding may put two HAVs just one cell apart into cells two
    # apart
    size = 2.0 * longest * either(longest, *_WIDER) * either(longest, *_WIDER)
    for bucket in range(grid.shape[1]):
        grid[BUCKET, bucket] = -1
    for agent in range(world.state.x.shape[0]):
        column = int(floor(world.state.x[agent, lane] / size))
        row = int(floor(world.state.y[agent, lane] / size))
        bucket = _bucket_of(grid, column, row)
        grid[COLUMN, agent] = column
        grid[ROW, agent] = row
        grid[NEXT, agent] = grid[BUCKET, bucket]
        grid[BUCKET, bucket] = agent


@kernel
def _search_cell(world, grid, agent, column, row, lane):
    """Compare a HAV with the HAVs in one cell; a bucket holds them in descending order."""
    other = grid[BUCKET, _bucket_of(grid, column, row)]
    while other > agent:  # each pair is compared once
        if grid[COLUMN, other] == column and grid[ROW, other] == row:
            _list_pair(world, agent, other, lane)
        other = grid[NEXT, other]


@kernel
def _sort(pair, begin, end):
    """Sort pairs with the same first HAV by their second one."""
    for last in range(begin + 1, end):
        other, slot = pair[last, HIGHER], last
        while slot > begin and pair[slot - 1, HIGHER] > other:
            pair[slot, HIGHER] = pair[slot - 1, HIGHER]
            slot -= 1
        pair[slot, HIGHER] = other
