"""This module detects collisions continuously, between steps.

Each axle moves at constant speed from its position before a step to its position after it. Two
links meet when an end of one passes through the other, which is a root of a quadratic of time.
"""

import math

from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import sqrt
from hav_env.maths.geometry import segments_intersect
from hav_env.world.bodies import box_at, widened
from hav_env.world.chain import ends_behind, front_axle
from hav_env.world.collision import AXLE_ROUNDING, reach, squared_distance, within


@rare_kernel
def _passes(p, q, a, to_p, to_q, to_a):
    """Return whether a moving point passes through a moving segment p-q.

    Points are pairs (x, y) [m] before and after. Twice the area of the triangle of the three points
    is a quadratic in time. The point passes at a root at which it is between both ends.
    """
    ux, uy = q[0] - p[0], q[1] - p[1]
    vx, vy = a[0] - p[0], a[1] - p[1]
    du_x, du_y = to_q[0] - to_p[0] - ux, to_q[1] - to_p[1] - uy
    dv_x, dv_y = to_a[0] - to_p[0] - vx, to_a[1] - to_p[1] - vy
    constant = ux * vy - uy * vx
    linear = ux * dv_y - uy * dv_x + du_x * vy - du_y * vx
    quadratic = du_x * dv_y - du_y * dv_x
    root = linear * linear - 4.0 * quadratic * constant
    if root < 0.0:
        return False
    # this form loses no digits if the quadratic part is small
    part = -0.5 * (linear + math.copysign(sqrt(root), linear))
    first = part / quadratic if quadratic != 0.0 else math.inf
    second = constant / part if part != 0.0 else math.inf
    return _is_between(first, ux, uy, vx, vy, du_x, du_y, dv_x, dv_y) or _is_between(
        second, ux, uy, vx, vy, du_x, du_y, dv_x, dv_y
    )


@kernel
def _is_between(share, ux, uy, vx, vy, du_x, du_y, dv_x, dv_y):
    """Return whether v is beside the segment from the origin to u at a time from 0 to 1."""
    if not 0.0 <= share <= 1.0:
        return False
    ux, uy, vx, vy = ux + share * du_x, uy + share * du_y, vx + share * dv_x, vy + share * dv_y
    along, squared = ux * vx + uy * vy, ux * ux + uy * uy
    return squared > 0.0 and 0.0 <= along <= squared


@rare_kernel
def moving_segments_meet(a, b, c, d, to_a, to_b, to_c, to_d):
    """Return whether the segments a-b and c-d have a point in common at any time of a step.

    Args:
        a: One end of the first segment before the step (x, y) [m]. Each end moves straight, at
            constant speed.
        b: Other end of the first segment.
        c: One end of the second segment.
        d: Other end of the second segment.
        to_a: End a after the step.
        to_b: End b after the step.
        to_c: End c after the step.
        to_d: End d after the step.
    """
    return (
        segments_intersect(*to_a, *to_b, *to_c, *to_d)
        or _passes(a, b, c, to_a, to_b, to_c)
        or _passes(a, b, d, to_a, to_b, to_d)
        or _passes(c, d, a, to_c, to_d, to_a)
        or _passes(c, d, b, to_c, to_d, to_b)
    )


@kernel
def note_axles(world, agent):
    """Record the axles of a HAV before the next step, in every lane of a block."""
    were = world.nearby.were
    for lane in range(world.lanes):
        x, y = front_axle(world, agent, lane)
        were[agent, 0, lane], were[agent, 1, lane] = x, y
    for unit in range(world.units):
        for lane in range(world.lanes):
            x, y = were[agent, 2 * unit, lane], were[agent, 2 * unit + 1, lane]
            x, y, _, _ = ends_behind(world, agent, unit, lane, x, y)
            were[agent, 2 * unit + 2, lane], were[agent, 2 * unit + 3, lane] = x, y


@kernel
def _was(world, agent, axle, lane):
    """Return the position of an axle before the step [m]."""
    were = world.nearby.were
    return were[agent, 2 * axle, lane], were[agent, 2 * axle + 1, lane]


@kernel
def may_meet(world, agent, other, lane):
    """Return whether two HAVs are so near that their chains may have met since the step before."""
    limit = AXLE_ROUNDING
    for hav in (agent, other):
        x, y = _was(world, hav, 1, lane)
        way_x, way_y = world.state.x[hav, lane] - x, world.state.y[hav, lane] - y
        limit += reach(world.fleet, hav, lane) + sqrt(way_x * way_x + way_y * way_y)
    return within(squared_distance(world, agent, other, lane), limit)


@kernel
def box_of_way(world, agent, lane):
    """Return the box round the chain of a HAV and the positions of its axles before the step.

    ``enclose`` has found the box of the chain.
    """
    box = box_at(world, agent, lane)
    for axle in range(world.fleet.num_trailers[agent, lane] + 2):
        x, y = _was(world, agent, axle, lane)
        box = widened(box, (x, x, y, y))
    return box


@rare_kernel
def collision_between(world, agent, other, lane):
    """Return whether the chains of two HAVs meet now or have met since the step before."""
    a, to_a = _was(world, agent, 0, lane), front_axle(world, agent, lane)
    for unit in range(world.fleet.num_trailers[agent, lane] + 1):
        b, to_b = _was(world, agent, unit + 1, lane), _end_of(world, agent, unit, lane, to_a)
        c, to_c = _was(world, other, 0, lane), front_axle(world, other, lane)
        for other_unit in range(world.fleet.num_trailers[other, lane] + 1):
            d = _was(world, other, other_unit + 1, lane)
            to_d = _end_of(world, other, other_unit, lane, to_c)
            if moving_segments_meet(a, b, c, d, to_a, to_b, to_c, to_d):
                return True
            c, to_c = d, to_d
        a, to_a = b, to_b
    return False


@rare_kernel
def passes_segment(world, agent, segment, lane):
    """Return whether the chain of a HAV meets a segment now or has met it since the step before.

    Args:
        world: Block of worlds.
        agent: Index of the HAV.
        segment: Middle [m], cosine, sine, half length [m], 0, as rectangles have it.
        lane: Index of the world.
    """
    x, y, cosine, sine, half, _ = segment
    c, d = (x - half * cosine, y - half * sine), (x + half * cosine, y + half * sine)
    a, to_a = _was(world, agent, 0, lane), front_axle(world, agent, lane)
    for unit in range(world.fleet.num_trailers[agent, lane] + 1):
        b, to_b = _was(world, agent, unit + 1, lane), _end_of(world, agent, unit, lane, to_a)
        if moving_segments_meet(a, b, c, d, to_a, to_b, c, d):
            return True
        a, to_a = b, to_b
    return False


@kernel
def _end_of(world, agent, unit, lane, front):
    """Return the axle of a unit, given its front end [m]."""
    x, y, _, _ = ends_behind(world, agent, unit, lane, *front)
    return x, y
