"""This module guides HAVs on routes along lattices, from the best node nearby to the goal.

A truck is never exactly in the pose of a node. So its route begins in the pose of a node nearby,
and the truck steers to the route. From there on the route is exact, and ends in the goal. A new
route begins when the truck is too far off its route, or has driven past the goal.
"""

import math

from hav_env.compiled import kernel, rare_kernel
from hav_env.guidance.lattice import OFFSETS, LatticeTable
from hav_env.guidance.search import IN_SIGHT, UNREACHED
from hav_env.guidance.segments import (
    NEGLIGIBLE,
    begin_direct,
    begin_segment,
    end_of_segment,
    is_at_end,
    is_past,
    note_progress,
)
from hav_env.maths.elementary import floor, sincos
from hav_env.maths.geometry import TWO_PI, into_frame, wrap
from hav_env.world.arrays import HEADING, X, Y
from hav_env.world.place.guidance import (
    BENT,
    NO_TABLE,
    REST,
    ROUTE_DIRECT,
    ROUTE_KNOWN,
    OnLattices,
    begin_route,
    follow_route,
)
from hav_env.world.sensing import drivable_radius

_ROUNDED = 1e-5  # share of a radius
_JOINED = 0.1  # [m], greatest distance between the end of a segment and its node
_MOST_OFF = 2.5  # cells beside the route: beyond, a new route begins
_MOST_ASKEW = 1.3  # [rad] off the route: beyond, a new route begins
_ASIDE, _TURNED = 3.0, 2.0  # penalty of a node: metres for a metre aside; radii for a radian
_MOST_ENDS = 16  # segments that may end in one step


@kernel
def table_at(lattices, t):
    """Return one of the lattices."""
    return LatticeTable(
        lattices.length[t],
        lattices.side[t],
        lattices.steps[t],
        lattices.offset[t],
        lattices.goal[t],
        lattices.radius[t],
        lattices.grid,
    )


@kernel
def _node_pose(table, i, j, k):
    """Return the pose of a node (x, y [m], heading [rad]) and the length from there [m]."""
    grid = table.grid
    scale = grid.cell / OFFSETS
    dx, dy = table.offset[i, j, k, 0] * scale, table.offset[i, j, k, 1] * scale
    heading = table.goal[2] + k * (TWO_PI / table.length.shape[2])
    sine, cosine = sincos(heading)
    x, y = grid.x + (j + 0.5) * grid.cell + dx, grid.y + (i + 0.5) * grid.cell + dy
    return (x, y, heading), table.length[i, j, k] - (dx * cosine + dy * sine)


@rare_kernel
def _nearest_node(table, x, y, heading, aside):
    """Return row, column and heading of the node to begin with from a pose; -1 first if none.

    The node minimizes the length to the goal plus ``aside`` metres for each metre beside the truck,
    plus a penalty for its difference in heading.
    """
    rows, columns, headings = table.length.shape
    u, v = (x - table.grid.x) / table.grid.cell - 0.5, (y - table.grid.y) / table.grid.cell - 0.5
    turned = (heading - table.goal[2]) * (headings / TWO_PI)
    first_j, first_i, first_k = int(floor(u)) - 1, int(floor(v)) - 1, int(floor(turned)) - 1
    sine, cosine = sincos(heading)
    least, row, column, direction = math.inf, -1, -1, -1
    for i in range(max(first_i, 0), min(first_i + 4, rows)):
        for j in range(max(first_j, 0), min(first_j + 4, columns)):
            for step in range(first_k, first_k + 4):
                k = step % headings
                if table.side[i, j, k] == UNREACHED:
                    continue
                pose, length = _node_pose(table, i, j, k)
                ahead, left = into_frame(pose[0] - x, pose[1] - y, cosine, sine)
                cost = length + ahead + aside * abs(left)
                cost += _TURNED * table.radius * abs(wrap(pose[2] - heading))
                cost += 2.0 * max(abs(ahead) - table.grid.cell, 0.0)
                if cost < least:
                    least, row, column, direction = cost, i, j, k
    return row, column, direction


@rare_kernel
def _node_at(table, pose):
    """Return the node of a pose, as ``_nearest_node`` does; -1 first if there is none."""
    rows, columns, headings = table.length.shape
    grid = table.grid
    j, i = int(floor((pose[0] - grid.x) / grid.cell)), int(floor((pose[1] - grid.y) / grid.cell))
    turned = (pose[2] - table.goal[2]) * (headings / TWO_PI)
    k = int(floor(turned + 0.5)) % headings
    for row in range(max(i - 1, 0), min(i + 2, rows)):
        for column in range(max(j - 1, 0), min(j + 2, columns)):
            if table.side[row, column, k] != UNREACHED:
                there, _ = _node_pose(table, row, column, k)
                if abs(there[0] - pose[0]) + abs(there[1] - pose[1]) < _JOINED:
                    return row, column, k
    return -1, -1, -1


@kernel
def _begin_at(table, route, agent, lane, node, pose):
    """Begin the segment after a node; if the node is direct, the Dubins path from a pose."""
    i, j, k = node
    side = table.side[i, j, k]
    if side == IN_SIGHT:
        begin_direct(route, agent, lane, pose, table.goal, table.radius)
        return
    there, length = _node_pose(table, i, j, k)
    stays = table.steps[i, j, k] * (table.radius * TWO_PI / table.length.shape[2])
    begin_segment(route, agent, lane, there, side * 1.0, stays, max(length - stays, 0.0))
    route[agent, BENT, lane], route[agent, ROUTE_DIRECT, lane] = table.radius, 0.0


@kernel
def _begin_here(guidance, world, agent, lane):
    """Begin the route in the best node near the truck, if there is one."""
    t, route, state = guidance.table[agent, lane], guidance.route, world.state
    route[agent, ROUTE_KNOWN, lane] = 0.0
    if t == NO_TABLE:
        return
    table = table_at(guidance.lattices, t)
    pose = state.x[agent, lane], state.y[agent, lane], state.heading[agent, 0, lane]
    node = _nearest_node(table, *pose, _ASIDE)
    if node[0] >= 0:
        _begin_at(table, route, agent, lane, node, pose)
        note_progress(route, agent, lane, *pose)


@begin_route.register(OnLattices)
@rare_kernel
def begin_on_lattice(guidance, world, agent, lane):
    """Find the lattice of a HAV's goal and radius; begin a route near the truck."""
    lattices, goal = guidance.lattices, world.state.goal
    radius = drivable_radius(world, agent, lane) * lattices.widening
    found, tightest = NO_TABLE, math.inf
    for t in range(lattices.radius.shape[0]):
        same = lattices.goal[t, 0] == goal[agent, X, lane]
        same = same and lattices.goal[t, 1] == goal[agent, Y, lane]
        same = same and lattices.goal[t, 2] == goal[agent, HEADING, lane]
        wide = lattices.radius[t] >= radius * (1.0 - _ROUNDED)
        if same and wide and lattices.radius[t] < tightest:
            found, tightest = t, lattices.radius[t]
    guidance.table[agent, lane] = found
    _begin_here(guidance, world, agent, lane)


@follow_route.register(OnLattices)
@kernel
def follow_on_lattices(guidance, world, agent):
    """Update the progress of HAVs; begin new routes for those that left theirs."""
    for lane in range(world.lanes):
        if not world.state.waiting[agent, lane]:
            _follow(guidance, world, agent, lane)


@rare_kernel
def _follow(guidance, world, agent, lane):
    route, state, t = guidance.route, world.state, guidance.table[agent, lane]
    if t == NO_TABLE:
        return
    if route[agent, ROUTE_KNOWN, lane] == 0.0:
        _begin_here(guidance, world, agent, lane)
        return
    table = table_at(guidance.lattices, t)
    pose = state.x[agent, lane], state.y[agent, lane], state.heading[agent, 0, lane]
    off, turned = note_progress(route, agent, lane, *pose)
    for _ in range(_MOST_ENDS):
        if not is_at_end(route, agent, lane) or route[agent, REST, lane] < NEGLIGIBLE:
            break
        there = end_of_segment(route, agent, lane)
        if route[agent, ROUTE_DIRECT, lane] != 0.0:
            begin_direct(route, agent, lane, there, table.goal, table.radius)
        else:
            node = _node_at(table, there)
            if node[0] < 0:
                _begin_here(guidance, world, agent, lane)
                return
            _begin_at(table, route, agent, lane, node, there)
        off, turned = note_progress(route, agent, lane, *pose)
    if _is_lost(route, agent, lane, table.grid.cell, off, turned):
        _begin_here(guidance, world, agent, lane)


@kernel
def _is_lost(route, agent, lane, cell, off, turned):
    """Return whether a truck has left its route, or driven past the goal."""
    past = is_past(route, agent, lane)
    return past or abs(off) > _MOST_OFF * cell or abs(turned) > _MOST_ASKEW
