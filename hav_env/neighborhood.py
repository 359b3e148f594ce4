"""Who is within sensing range of whom, without looking at all pairs of a large swarm."""

from hav_env.collision import reach
from hav_env.compiled import kernel
from hav_env.elementary import floor
from hav_env.world import BUCKET, COLUMN, NEXT, ROW, truck_distance

FEW = 16  # HAVs up to which looking at all pairs is quicker than a grid


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
                if _in_range(task, world, agent, other, lane):
                    _append(world.nearby, agent, other, lane)
                    _append(world.nearby, other, agent, lane)


@kernel
def _search_grid(task, world, lane):
    _fill_buckets(task, world, lane)
    for agent in range(world.state.x.shape[0]):
        column, row = world.nearby.grid[COLUMN, agent, lane], world.nearby.grid[ROW, agent, lane]
        for across in range(-1, 2):
            for along in range(-1, 2):
                _search_cell(task, world, agent, column + across, row + along, lane)
        _sort(world.nearby, agent, lane)


@kernel
def _in_range(task, world, agent, other, lane):
    reaches = reach(world.fleet, agent, lane) + reach(world.fleet, other, lane)
    return truck_distance(world.state, agent, other, lane) <= reaches + task.sensing_range


@kernel
def _append(nearby, agent, other, lane):
    nearby.index[agent, nearby.count[agent, lane], lane] = other
    nearby.count[agent, lane] += 1


@kernel
def _bucket_of(grid, column, row):
    # two odd primes spread neighbouring cells; the number of buckets is a power of two
    return (column * 73856093 ^ row * 19349663) & (grid.shape[1] - 1)


@kernel
def _fill_buckets(task, world, lane):
    grid, num_havs = world.nearby.grid, world.state.x.shape[0]
    longest = 0.0
    for agent in range(num_havs):
        longest = max(longest, reach(world.fleet, agent, lane))
    # a little larger, for two HAVs just one cell apart may be rounded into cells two apart
    size = (2.0 * longest + task.sensing_range) * (1.0 + 1e-9)
    for bucket in range(grid.shape[1]):
        grid[BUCKET, bucket, lane] = -1
    for agent in range(num_havs):
        column = int(floor(world.state.x[agent, lane] / size))
        row = int(floor(world.state.y[agent, lane] / size))
        bucket = _bucket_of(grid, column, row)
        grid[COLUMN, agent, lane] = column
        grid[ROW, agent, lane] = row
        grid[NEXT, agent, lane] = grid[BUCKET, bucket, lane]
        grid[BUCKET, bucket, lane] = agent


@kernel
def _search_cell(task, world, agent, column, row, lane):
    grid = world.nearby.grid
    other = grid[BUCKET, _bucket_of(grid, column, row), lane]
    while other >= 0:
        same_cell = grid[COLUMN, other, lane] == column and grid[ROW, other, lane] == row
        if same_cell and other != agent and _in_range(task, world, agent, other, lane):
            _append(world.nearby, agent, other, lane)
        other = grid[NEXT, other, lane]


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
