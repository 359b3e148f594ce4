"""This module detects collisions: potential ones of footprints, actual ones of chains."""

import math

from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.geometry import nearest_on_segment, segments_intersect
from hav_env.world.arrays import FOOTPRINT
from hav_env.world.chain import axle_behind, front_axle

# more than rounding moves the axles of chains, even 1e13 m from the origin [m]
AXLE_ROUNDING = 0.1


@kernel
def collision_distance(fleet, agent, other, lane):
    """Return d_ih = d_i + d_h [m], the sum of two footprint radii."""
    return fleet.radius[agent, FOOTPRINT, lane] + fleet.radius[other, FOOTPRINT, lane]


@kernel
def potential_collision(task, world, agent, other, lane):
    """Tell whether the footprint circles of two HAVs overlap, eq. (potential-collision).

    The task may put the circles elsewhere and widen them; the text does not.
    """
    dx, dy = offset_between(world, agent, other, task.potential_center, lane)
    trucks = world.fleet.length[agent, 0, lane] + world.fleet.length[other, 0, lane]
    limit = collision_distance(world.fleet, agent, other, lane)
    return math.sqrt(dx * dx + dy * dy) <= limit + task.potential_truck_share * trucks


@kernel
def offset_between(world, agent, other, share, lane):
    """Return x and y [m] from a point of one truck to the same point of another.

    The points lie a share of the truck's length ahead of its rear axle.
    """
    state, length = world.state, world.fleet.length
    own, others = share * length[agent, 0, lane], share * length[other, 0, lane]
    dx = state.x[other, lane] - state.x[agent, lane]
    dy = state.y[other, lane] - state.y[agent, lane]
    dx += others * state.cosine[other, 0, lane] - own * state.cosine[agent, 0, lane]
    dy += others * state.sine[other, 0, lane] - own * state.sine[agent, 0, lane]
    return dx, dy


@kernel
def reach(fleet, agent, lane):
    """Return the radius [m] round the truck's rear axle that holds the whole HAV.

    The paper's footprint holds the trailers; a truck may be longer than all of them.
    """
    return max(fleet.radius[agent, FOOTPRINT, lane], fleet.length[agent, 0, lane])


@kernel
def circle_radius(task, fleet, agent, lane):
    """Return the radius [m] round the truck's rear axle that holds its circle of the task."""
    share = task.potential_center + task.potential_truck_share
    return fleet.radius[agent, FOOTPRINT, lane] + share * fleet.length[agent, 0, lane]


@kernel
def squared_distance(world, agent, other, lane):
    """Return the squared distance [m^2] between the rear axles of two trucks."""
    dx = world.state.x[other, lane] - world.state.x[agent, lane]
    dy = world.state.y[other, lane] - world.state.y[agent, lane]
    return dx * dx + dy * dy


@kernel
def within(squared, limit):
    """Tell whether a distance, given its square [m^2], is at most a limit [m], at least 0."""
    return squared <= limit * limit


@kernel
def box_of(world, agent, lane):
    """Return the box round the chain of axles of a HAV: least x, greatest x, likewise y [m]."""
    x, y = front_axle(world, agent, lane)
    left, right, low, high = x, x, y, y
    for unit in range(world.fleet.num_trailers[agent, lane] + 1):
        x, y = axle_behind(world, agent, unit, lane, x, y)
        left, right, low, high = min(left, x), max(right, x), min(low, y), max(high, y)
    return left, right, low, high


@kernel
def boxes_overlap(one, other):
    """Tell whether two boxes, as ``box_of`` returns them, have a point in common."""
    left, right, low, high = one
    other_left, other_right, other_low, other_high = other
    apart = (right < other_left) | (other_right < left) | (high < other_low) | (other_high < low)
    return not apart


@rare_kernel
def actual_collision(world, agent, other, lane):
    """Tell whether the chains of axles of two HAVs have a point in common, eq. (collision).

    Exact and slow: for HAVs whose boxes overlap.
    """
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


@kernel
def nearest_on_chain(world, agent, lane, x, y):
    """Return the point of the chain of axles of a HAV that is nearest to a place [m]."""
    ax, ay = front_axle(world, agent, lane)
    least, nearest_x, nearest_y = math.inf, ax, ay
    for unit in range(world.fleet.num_trailers[agent, lane] + 1):
        length = world.fleet.length[agent, unit, lane]
        back_x, back_y = (
            -world.state.cosine[agent, unit, lane],
            -world.state.sine[agent, unit, lane],
        )
        px, py = nearest_on_segment(ax, ay, back_x, back_y, length, x, y)
        squared = (px - x) * (px - x) + (py - y) * (py - y)
        if squared < least:
            least, nearest_x, nearest_y = squared, px, py
        ax, ay = axle_behind(world, agent, unit, lane, ax, ay)
    return nearest_x, nearest_y


@kernel
def front_gap(world, agent, other, lane):
    """Return the distance [m] from the truck's front axle to the chain of another HAV."""
    x, y = front_axle(world, agent, lane)
    px, py = nearest_on_chain(world, other, lane, x, y)
    return math.sqrt((px - x) * (px - x) + (py - y) * (py - y))
