"""Footprints and chains: whether HAVs could touch, and whether they do."""

from hav_env.compiled import kernel, world_kernel
from hav_env.geometry import segments_intersect
from hav_env.world import FOOTPRINT, truck_distance


@kernel
def collision_distance(fleet, agent, other):
    """Return d_ih = d_i + d_h [m], the sum of two footprint radii."""
    return fleet.radius[agent, FOOTPRINT] + fleet.radius[other, FOOTPRINT]


@world_kernel
def potential_collision(world, agent, other):
    """Tell whether the footprint circles of two HAVs overlap, eq. (potential-collision)."""
    return truck_distance(world.state, agent, other) <= collision_distance(
        world.fleet, agent, other
    )


@kernel
def reach(fleet, agent):
    """Return the radius [m] round the truck's rear axle that holds the whole HAV.

    The paper's footprint holds the trailers; a truck may be longer than all of them.
    """
    return max(fleet.radius[agent, FOOTPRINT], fleet.length[agent, 0])


@world_kernel
def axle_behind(world, agent, unit, x, y):
    """Return the position [m] of a unit's rear end, given that of its front end."""
    length = world.fleet.length[agent, unit]
    return (
        x - length * world.state.cosine[agent, unit],
        y - length * world.state.sine[agent, unit],
    )


@world_kernel
def front_axle(world, agent):
    """Return the position [m] of the truck's front axle, where the chain begins."""
    length = world.fleet.length[agent, 0]
    return (
        world.state.x[agent] + length * world.state.cosine[agent, 0],
        world.state.y[agent] + length * world.state.sine[agent, 0],
    )


@world_kernel
def _box(world, agent):
    x, y = front_axle(world, agent)
    left, right, low, high = x, x, y, y
    for unit in range(world.fleet.num_trailers[agent] + 1):
        x, y = axle_behind(world, agent, unit, x, y)
        left, right, low, high = min(left, x), max(right, x), min(low, y), max(high, y)
    return left, right, low, high


@world_kernel
def actual_collision(world, agent, other):
    """Tell whether the chains of axles of two HAVs have a point in common, eq. (collision)."""
    if truck_distance(world.state, agent, other) > reach(world.fleet, agent) + reach(
        world.fleet, other
    ):
        return False
    left, right, low, high = _box(world, agent)
    other_left, other_right, other_low, other_high = _box(world, other)
    if right < other_left or other_right < left or high < other_low or other_high < low:
        return False
    ax, ay = front_axle(world, agent)
    for unit in range(world.fleet.num_trailers[agent] + 1):
        bx, by = axle_behind(world, agent, unit, ax, ay)
        cx, cy = front_axle(world, other)
        for other_unit in range(world.fleet.num_trailers[other] + 1):
            dx, dy = axle_behind(world, other, other_unit, cx, cy)
            if segments_intersect(ax, ay, bx, by, cx, cy, dx, dy):
                return True
            cx, cy = dx, dy
        ax, ay = bx, by
    return False
