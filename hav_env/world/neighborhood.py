"""This module finds the neighbours of each HAV within sensing range.

In large swarms it searches the cells of a grid, not all pairs.
"""

from hav_env.compiled import kernel
from hav_env.maths.elementary import floor
from hav_env.world.arrays import BUCKET, COLUMN, FEW, NEXT, ROW
from hav_env.world.collision import reach


@kernel
def find_nearby(task, world):
    """List for every HAV the others in sensing range, in ascending order.

    In range is who is at most both reaches and the sensing range away. A large swarm is sorted
    into buckets by the square cells of a grid; nobody in range is beyond the next cell.
    """
    for agent in range(world.state.x.shape[0]):
        for lane in range(world.lanes):
            world.nearby.count[agent, lane] = 0
    if world.state.x.shape[0] <= FEW:
        _compare_all(task, world)
    else:
        for lane in range(world.lanes):
            _search_grid(task, world, lane)


@kernel
def _compare_all(task, world):
    for agent in range(world.state.x.shape[0]):
        for other in range(agent + 1, world.state.x.shape[0]):
            for lane in range(world.lanes):
                dx = world.state.x[other, lane] - world.state.x[agent, lane]
                dy = world.state.y[other, lane] - world.state.y[agent, lane]
                reaches = reach(world.fleet, agent, lane) + reach(world.fleet, other, lane)
                if _in_range(task, dx, dy, reaches):
                    _append(world.nearby, agent, other, lane)
                    _append(world.nearby, other, agent, lane)


@kernel
def _in_range(task, dx, dy, reaches):
    limit = reaches + task.sensing_range
    return dx * dx + dy * dy <= limit * limit


@kernel
def _append(nearby, agent, other, lane):
    nearby.index[agent, nearby.count[agent, lane], lane] = other
    nearby.count[agent, lane] += 1


@kernel
def _search_grid(task, world, lane):
    """Search one world.

    All lanes of a block use the same scratch. HAVs lie side by side there, as they do not in the
    arrays of the worlds.
    """
    grid, place = world.nearby.grid[world.first], world.nearby.place[world.first]
    num_havs = world.state.x.shape[0]
    for agent in range(num_havs):
        place[0, agent] = world.state.x[agent, lane]
        place[1, agent] = world.state.y[agent, lane]
        place[2, agent] = reach(world.fleet, agent, lane)
    _fill_buckets(task, grid, place)
    for agent in range(num_havs):
        for across in range(-1, 2):
            for along in range(-1, 2):
                column, row = grid[COLUMN, agent] + across, grid[ROW, agent] + along
                _search_cell(task, world.nearby, grid, place, agent, column, row, lane)
    for agent in range(num_havs):
        _sort(world.nearby, agent, lane)


@kernel
def _bucket_of(grid, column, row):
    # two odd primes spread neighbouring cells; the number of buckets is a power of two
    return (column * 73856093 ^ row * 19349663) & (grid.shape[1] - 1)


@kernel
def _fill_buckets(task, grid, place):
    num_havs = place.shape[1]
    longest = 0.0
    for agent in range(num_havs):
        longest = max(longest, place[2, agent])
    # a little larger, for two HAVs just one cell apart may be rounded into cells two apart
    size = (2.0 * longest + task.sensing_range) * (1.0 + 1e-9)
    for bucket in range(grid.shape[1]):
        grid[BUCKET, bucket] = -1
    for agent in range(num_havs):
        column = int(floor(place[0, agent] / size))
        row = int(floor(place[1, agent] / size))
        bucket = _bucket_of(grid, column, row)
        grid[COLUMN, agent] = column
        grid[ROW, agent] = row
        grid[NEXT, agent] = grid[BUCKET, bucket]
        grid[BUCKET, bucket] = agent


@kernel
def _search_cell(task, nearby, grid, place, agent, column, row, lane):
    """Look at the HAVs in one cell; a bucket holds them in descending order."""
    other = grid[BUCKET, _bucket_of(grid, column, row)]
    while other > agent:  # a pair is looked at once
        dx, dy = place[0, other] - place[0, agent], place[1, other] - place[1, agent]
        same_cell = grid[COLUMN, other] == column and grid[ROW, other] == row
        if same_cell and _in_range(task, dx, dy, place[2, agent] + place[2, other]):
            _append(nearby, agent, other, lane)
            _append(nearby, other, agent, lane)
        other = grid[NEXT, other]


@kernel
def _sort(nearby, agent, lane):
    index = nearby.index
    for last in range(1, nearby.count[agent, lane]):
        other = index[agent, last, lane]
        slot = last
        while slot > 0 and index[agent, slot - 1, lane] > other:
            index[agent, slot, lane] = index[agent, slot - 1, lane]
            slot -= 1
        index[agent, slot, lane] = other
