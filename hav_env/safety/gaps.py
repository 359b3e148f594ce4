"""This module measures gaps between the bodies of two HAVs, up to a largest gap of interest."""

import math

from hav_env.compiled import generic, kernel, rare_kernel
from hav_env.maths.geometry import squared_gap
from hav_env.maths.rectangles import rectangle_gap
from hav_env.world.bodies import find_box
from hav_env.world.chain import ends_behind, front_axle
from hav_env.world.collision import AXLE_ROUNDING
from hav_env.world.rectangle_bodies import rectangle_of
from hav_env.world.units.parts import Lines, Outlines


@generic
def boxes_apart(bodies, world, agent, other, lane, gap):
    """Return whether boxes round two HAVs show that ``gap_of_bodies`` is at least a gap [m]."""


@boxes_apart.register(Lines)
def _boxes_of_lines_apart(bodies, world, agent, other, lane, gap):
    """Add the rounding of axles, so that the gap of no two units may be less."""
    return _boxes_clear(world, agent, other, lane, gap + AXLE_ROUNDING)


@boxes_apart.register(Outlines)
def _rectangles_not_apart(bodies, world, agent, other, lane, gap):
    return False  # gaps of rectangles may be less than the distance


@kernel
def _boxes_clear(world, agent, other, lane, gap):
    left, right, low, high = find_box(world.fleet.bodies, world, agent, lane)
    box = find_box(world.fleet.bodies, world, other, lane)
    return not _boxes_nearer(left, low, right, high, box[0], box[2], box[1], box[3], gap * gap)


@generic
def gap_of_bodies(bodies, world, agent, other, lane, most):
    """Return the gap between the bodies of two HAVs [m], or ``most`` where it is larger.

    The gap is at most their distance, and above zero only if they have no point in common.
    """


@gap_of_bodies.register(Lines)
def _gap_of_lines(bodies, world, agent, other, lane, most):
    return _gap_of_chains(world, agent, other, lane, most)


@gap_of_bodies.register(Outlines)
def _gap_of_outlines(bodies, world, agent, other, lane, most):
    return _gap_of_rectangles(bodies, world, agent, other, lane, most)


@rare_kernel
def _gap_of_chains(world, agent, other, lane, most):
    least = most * most
    left, right, low, high = find_box(world.fleet.bodies, world, other, lane)
    ax, ay = front_axle(world, agent, lane)
    for unit in range(world.fleet.num_trailers[agent, lane] + 1):
        bx, by, next_x, next_y = ends_behind(world, agent, unit, lane, ax, ay)
        cx, cy = front_axle(world, other, lane)
        # no unit of the other HAV is nearer than the box round them all, not even by rounding:
        # differences of lesser numbers are not greater
        near = _boxes_nearer(ax, ay, bx, by, left, low, right, high, least)
        for other_unit in range(world.fleet.num_trailers[other, lane] + 1 if near else 0):
            dx, dy, behind_x, behind_y = ends_behind(world, other, other_unit, lane, cx, cy)
            if _boxes_nearer(ax, ay, bx, by, cx, cy, dx, dy, least):
                least = min(least, squared_gap(ax, ay, bx, by, cx, cy, dx, dy))
            cx, cy = behind_x, behind_y
        ax, ay = next_x, next_y
    return math.sqrt(least)


@kernel
def _boxes_nearer(ax, ay, bx, by, cx, cy, dx, dy, squared):
    """Return whether the boxes round two segments are nearer than a distance, given its square."""
    across = max(min(ax, bx) - max(cx, dx), min(cx, dx) - max(ax, bx), 0.0)
    along = max(min(ay, by) - max(cy, dy), min(cy, dy) - max(ay, by), 0.0)
    return across * across + along * along < squared


@rare_kernel
def _gap_of_rectangles(bodies, world, agent, other, lane, most):
    least = most
    x, y = front_axle(world, agent, lane)
    for unit in range(world.fleet.num_trailers[agent, lane] + 1):
        own = rectangle_of(bodies, world, agent, unit, lane, x, y)
        to_x, to_y = front_axle(world, other, lane)
        for to in range(world.fleet.num_trailers[other, lane] + 1):
            theirs = rectangle_of(bodies, world, other, to, lane, to_x, to_y)
            if _middles_nearer(own, theirs, least):
                least = min(least, rectangle_gap(own, theirs))
            _, _, to_x, to_y = ends_behind(world, other, to, lane, to_x, to_y)
        _, _, x, y = ends_behind(world, agent, unit, lane, x, y)
    return max(least, 0.0)


@kernel
def _middles_nearer(one, other, gap):
    """Return whether two rectangles may be nearer than a gap [m], by the circles round them."""
    dx, dy = other[0] - one[0], other[1] - one[1]
    near = one[4] + one[5] + other[4] + other[5] + max(gap, 0.0)
    return dx * dx + dy * dy < near * near
