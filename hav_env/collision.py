"""Footprints and chains: whether HAVs could touch, and whether they do."""

from hav_env.compiled import kernel
from hav_env.geometry import segments_intersect
from hav_env.world import FOOTPRINT, truck_distance


@kernel
def collision_distance(fleet, agent, other, lane):
    """Return d_ih = d_i + d_h [m], the sum of two footprint radii."""
    return fleet.radius[agent, FOOTPRINT, lane] + fleet.radius[other, FOOTPRINT, lane]


@kernel
def potential_collision(world, agent, other, lane):
    """Tell whether the footprint circles of two HAVs overlap, eq. (potential-collision)."""
    distance = truck_distance(world.state, agent, other, lane)
    return distance <= collision_distance(world.fleet, agent, other, lane)


@kernel
def reach(fleet, agent, lane):
    """Return the radius [m] round the truck's rear axle that holds the whole HAV.

    The paper's footprint holds the trailers; a truck may be longer than all of them.
    """
    return max(fleet.radius[agent, FOOTPRINT, lane], fleet.length[agent, 0, lane])


@kernel
def within_reach(world, agent, other, lane):
    """Tell whether two HAVs are near enough to touch, whichever way they bend."""
    reaches = reach(world.fleet, agent, lane) + reach(world.fleet, other, lane)
    return truck_distance(world.state, agent, other, lane) <= reaches


@kernel
def axle_behind(world, agent, unit, lane, x, y):
    """Return the position [m] of a unit's rear end, given that of its front end."""
    length = world.fleet.length[agent, unit, lane]
    return (
        x - length * world.state.cosine[agent, unit, lane],
        y - length * world.state.sine[agent, unit, lane],
    )


@kernel
def front_axle(world, agent, lane):
    """Return the position [m] of the truck's front axle, where the chain begins."""
    length = world.fleet.length[agent, 0, lane]
    return (
        world.state.x[agent, lane] + length * world.state.cosine[agent, 0, lane],
        world.state.y[agent, lane] + length * world.state.sine[agent, 0, lane],
    )


@kernel
def _box(world, agent, lane):
    x, y = front_axle(world, agent, lane)
    left, right, low, high = x, x, y, y
    for unit in range(world.fleet.num_trailers[agent, lane] + 1):
        x, y = axle_behind(world, agent, unit, lane, x, y)
        left, right, low, high = min(left, x), max(right, x), min(low, y), max(high, y)
    return left, right, low, high


@kernel
def actual_collision(world, agent, other, lane):
    """Tell whether the chains of axles of two HAVs have a point in common, eq. (collision)."""
    if not within_reach(world, agent, other, lane):
        return False
    left, right, low, high = _box(world, agent, lane)
    other_left, other_right, other_low, other_high = _box(world, other, lane)
    if right < other_left or other_right < left or high < other_low or other_high < low:
        return False
    ax, ay = front_axle(world, agent, lane)
    for unit in range(world.fleet.num_trailers[agent, lane] + 1):
        bx, by = axle_behind(world, agent, unit, lane, ax, ay)
        cx, cy = front_axle(world, other, lane)
        for other_unit in range(world.fleet.num_trailers[other, lane] + 1):
            dx, dy = axle_behind(world, other, other_unit, lane, cx, cy)
            if segments_intersect(ax, ay, bx, by, cx, cy, dx, dy):
                return True
            cx, cy = dx, dy
        ax, ay = bx, by
    return False
