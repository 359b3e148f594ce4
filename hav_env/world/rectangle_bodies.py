"""This module has the bodies of HAVs as rectangles, one for each unit, with width and overhangs.

A line is a rectangle without width (``body_of``).
"""

import math

from hav_env.compiled import generic, kernel, rare_kernel
from hav_env.maths.rectangles import (
    may_overlap,
    nearest_on_rectangle,
    rectangle_box,
    rectangle_gap,
)
from hav_env.world.bodies import (
    bodies_meet,
    box_at,
    boxes_overlap,
    front_end,
    nearest_on_bodies,
    reach_of,
    unit_box,
)
from hav_env.world.chain import ends_behind, front_axle
from hav_env.world.units.joints import unit_spans
from hav_env.world.units.parts import FRONT, HALF_WIDTH, REAR, Lines, Outlines


@kernel
def rectangle_of(bodies, world, agent, unit, lane, x, y):
    """Return the body of a unit, given its front end [m], as ``hav_env.maths.rectangles`` takes it.

    A unit beyond the HAV's last is a point: its front end, at the last axle.
    """
    present = unit <= world.fleet.num_trailers[agent, lane]
    length = world.fleet.length[agent, unit, lane] if present else 0.0
    ahead = bodies.shape[agent, unit, FRONT, lane] if present else 0.0
    behind = length + (bodies.shape[agent, unit, REAR, lane] if present else 0.0)
    width = bodies.shape[agent, unit, HALF_WIDTH, lane] if present else 0.0
    cosine, sine = world.state.cosine[agent, unit, lane], world.state.sine[agent, unit, lane]
    middle, half = 0.5 * (ahead - behind), 0.5 * (ahead + behind)
    return x + middle * cosine, y + middle * sine, cosine, sine, half, width


@unit_box.register(Outlines)
def _box_of_rectangle(bodies, world, agent, unit, lane, x, y):
    return rectangle_box(rectangle_of(bodies, world, agent, unit, lane, x, y))


@bodies_meet.register(Outlines)
def _rectangles_meet(bodies, world, agent, other, lane):
    return _any_rectangles_meet(bodies, world, agent, other, lane)


@rare_kernel
def _any_rectangles_meet(bodies, world, agent, other, lane):
    x, y = front_axle(world, agent, lane)
    box = box_at(world, other, lane)
    for unit in range(world.fleet.num_trailers[agent, lane] + 1):
        own = rectangle_of(bodies, world, agent, unit, lane, x, y)
        near = boxes_overlap(rectangle_box(own), box)
        if near and _meets_any_of(bodies, world, own, other, lane):
            return True
        _, _, x, y = ends_behind(world, agent, unit, lane, x, y)
    return False


@kernel
def _meets_any_of(bodies, world, rectangle, other, lane):
    """Return whether a rectangle has a point in common with the bodies of a HAV."""
    x, y = front_axle(world, other, lane)
    for unit in range(world.fleet.num_trailers[other, lane] + 1):
        body = rectangle_of(bodies, world, other, unit, lane, x, y)
        if may_overlap(rectangle, body) and rectangle_gap(rectangle, body) <= 0.0:
            return True
        _, _, x, y = ends_behind(world, other, unit, lane, x, y)
    return False


@nearest_on_bodies.register(Outlines)
def _nearest_on_rectangles(bodies, world, agent, lane, x, y):
    front_x, front_y = front_axle(world, agent, lane)
    least, nearest_x, nearest_y = math.inf, front_x, front_y
    for unit in range(world.fleet.num_trailers[agent, lane] + 1):
        rectangle = rectangle_of(bodies, world, agent, unit, lane, front_x, front_y)
        px, py = nearest_on_rectangle(rectangle, x, y)
        squared = (px - x) * (px - x) + (py - y) * (py - y)
        if squared < least:
            least, nearest_x, nearest_y = squared, px, py
        _, _, front_x, front_y = ends_behind(world, agent, unit, lane, front_x, front_y)
    return nearest_x, nearest_y


@front_end.register(Outlines)
def _front_of_rectangle(bodies, world, agent, lane):
    x, y = front_axle(world, agent, lane)
    ahead = bodies.shape[agent, 0, FRONT, lane]
    cosine, sine = world.state.cosine[agent, 0, lane], world.state.sine[agent, 0, lane]
    return x + ahead * cosine, y + ahead * sine


@reach_of.register(Outlines)
def _reach_of_rectangles(bodies, fleet, agent, lane):
    return bodies.reach[agent, lane]


@generic
def body_of(bodies, world, agent, unit, lane, x, y):
    """Return the body of a unit as a rectangle, given its front end [m]; see ``rectangle_of``."""


@body_of.register(Outlines)
def _rectangle_itself(bodies, world, agent, unit, lane, x, y):
    return rectangle_of(bodies, world, agent, unit, lane, x, y)


@body_of.register(Lines)
def _line_as_rectangle(bodies, world, agent, unit, lane, x, y):
    line, _ = unit_spans(world.fleet.joints, world.fleet, agent, unit, lane)
    cosine, sine = world.state.cosine[agent, unit, lane], world.state.sine[agent, unit, lane]
    half = 0.5 * line
    return x - half * cosine, y - half * sine, cosine, sine, half, 0.0


@generic
def margin_of(bodies, agent, unit, lane):
    """Return the largest distance [m] of the body of a unit from the line between its ends."""


@margin_of.register(Lines)
def _no_margin(bodies, agent, unit, lane):
    return 0.0


@margin_of.register(Outlines)
def _margin_of_rectangle(bodies, agent, unit, lane):
    shape = bodies.shape
    overhang = max(shape[agent, unit, FRONT, lane], shape[agent, unit, REAR, lane])
    return shape[agent, unit, HALF_WIDTH, lane] + overhang
