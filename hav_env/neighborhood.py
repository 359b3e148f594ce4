"""Who is within sensing range of whom, without looking at all pairs of a large swarm."""

import math

from hav_env.collision import reach
from hav_env.compiled import kernel, world_kernel
from hav_env.world import BUCKET, COLUMN, NEXT, ROW, truck_distance

FEW = 16  # HAVs up to which looking at all pairs is quicker than a grid


@world_kernel
def find_nearby(task, world):
    """List for every HAV the others in sensing range, in ascending order.

    In range is who is at most both reaches and the sensing range away. A large swarm is sorted
    into buckets by the square cells of a grid; nobody in range is beyond the next cell.
    """
    num_havs = world.state.x.shape[0]
    if num_havs <= FEW:
        for agent in range(num_havs):
            world.nearby.count[agent] = 0
        for agent in range(num_havs):
            for other in range(agent + 1, num_havs):
                if _in_range(task, world, agent, other):
                    _append(world.nearby, agent, other)
                    _append(world.nearby, other, agent)
        return
    _fill_buckets(task, world)
    for agent in range(num_havs):
        world.nearby.count[agent] = 0
        column, row = world.nearby.grid[COLUMN, agent], world.nearby.grid[ROW, agent]
        for across in range(-1, 2):
            for along in range(-1, 2):
                _search_cell(task, world, agent, column + across, row + along)
        _sort(world.nearby.index, agent, world.nearby.count[agent])


@world_kernel
def _in_range(task, world, agent, other):
    limit = reach(world.fleet, agent) + reach(world.fleet, other) + task.sensing_range
    return truck_distance(world.state, agent, other) <= limit


@world_kernel
def _append(nearby, agent, other):
    nearby.index[agent, nearby.count[agent]] = other
    nearby.count[agent] += 1


@kernel
def _bucket_of(grid, column, row):
    # two odd primes spread neighbouring cells; the number of buckets is a power of two
    return (column * 73856093 ^ row * 19349663) & (grid.shape[1] - 1)


@world_kernel
def _fill_buckets(task, world):
    grid, num_havs = world.nearby.grid, world.state.x.shape[0]
    longest = 0.0
    for agent in range(num_havs):
        longest = max(longest, reach(world.fleet, agent))
    # a little larger, for two HAVs just one cell apart may be rounded into cells two apart
    size = (2.0 * longest + task.sensing_range) * (1.0 + 1e-9)
    for bucket in range(grid.shape[1]):
        grid[BUCKET, bucket] = -1
    for agent in range(num_havs):
        column = math.floor(world.state.x[agent] / size)
        row = math.floor(world.state.y[agent] / size)
        bucket = _bucket_of(grid, column, row)
        grid[COLUMN, agent] = column
        grid[ROW, agent] = row
        grid[NEXT, agent] = grid[BUCKET, bucket]
        grid[BUCKET, bucket] = agent


@world_kernel
def _search_cell(task, world, agent, column, row):
    grid = world.nearby.grid
    other = grid[BUCKET, _bucket_of(grid, column, row)]
    while other >= 0:
        same_cell = grid[COLUMN, other] == column and grid[ROW, other] == row
        if same_cell and other != agent and _in_range(task, world, agent, other):
            _append(world.nearby, agent, other)
        other = grid[NEXT, other]


@kernel
def _sort(index, agent, count):
    for last in range(1, count):
        other = index[agent, last]
        slot = last
        while slot > 0 and index[agent, slot - 1] > other:
            index[agent, slot] = index[agent, slot - 1]
            slot -= 1
        index[agent, slot] = other
