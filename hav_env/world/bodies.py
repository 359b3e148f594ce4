"""This module has the bodies of HAVs as lines, and selects code for bodies by their type.

With ``Lines`` the body of a HAV is the polygonal chain of its axles, as in the paper. Rectangles
are in ``hav_env.world.rectangle_bodies``.
"""

import math

from hav_env.compiled import fixed, generic, kernel, rare_kernel
from hav_env.maths.geometry import nearest_on_segment, segments_intersect
from hav_env.world.arrays import (
    BOX_HIGH,
    BOX_LEFT,
    BOX_LOW,
    BOX_RIGHT,
    FOOTPRINT,
    UNIT_FRONT_X,
    UNIT_FRONT_Y,
)
from hav_env.world.chain import ends_behind, front_axle
from hav_env.world.units.joints import unit_spans
from hav_env.world.units.parts import Lines


@generic
def unit_box(bodies, world, agent, unit, lane, x, y):
    """Return the box round the body of a unit, given its front end [m]; see ``find_box``.

    The box of a unit beyond the HAV's last one lies within the last one's, because no overhang is
    below 0.
    """


@generic
def bodies_meet(bodies, world, agent, other, lane):
    """Return whether the bodies of two HAVs have a point in common: an exact but slow test.

    ``enclose`` or ``enclose_in`` must have found the box of the second one.
    """


@generic
def nearest_on_bodies(bodies, world, agent, lane, x, y):
    """Return the point of the bodies of a HAV that is nearest to a position [m]."""


@generic
def front_end(bodies, world, agent, lane):
    """Return the middle of a HAV's front [m]: the truck's front axle or its overhang's end."""


@generic
def reach_of(bodies, fleet, agent, lane):
    """Return the radius [m] round the truck's rear axle that holds the whole HAV."""


@kernel
def find_box(bodies, world, agent, lane):
    """Return the box round the bodies of a HAV: least x, greatest x, likewise y [m]."""
    x, y = front_axle(world, agent, lane)
    box = x, x, y, y
    for unit in range(world.fleet.num_trailers[agent, lane] + 1):
        box = widened(box, unit_box(bodies, world, agent, unit, lane, x, y))
        _, _, x, y = ends_behind(world, agent, unit, lane, x, y)
    return box


@kernel
def enclose(world, agent):
    """Find the boxes of a HAV in every lane of a block, for ``box_at``."""
    front = world.state.ahead
    for lane in range(world.lanes):
        x, y = front_axle(world, agent, lane)
        front[UNIT_FRONT_X, lane], front[UNIT_FRONT_Y, lane] = x, y
        _put_box(world, agent, lane, (x, x, y, y))
    for number in range(world.units):
        unit = fixed(number)
        for lane in range(world.lanes):
            x, y = front[UNIT_FRONT_X, lane], front[UNIT_FRONT_Y, lane]
            of_unit = unit_box(world.fleet.bodies, world, agent, unit, lane, x, y)
            _put_box(world, agent, lane, widened(box_at(world, agent, lane), of_unit))
            _, _, x, y = ends_behind(world, agent, unit, lane, x, y)
            front[UNIT_FRONT_X, lane], front[UNIT_FRONT_Y, lane] = x, y


@kernel
def enclose_in(world, agent, lane):
    """Find the box of a HAV in one lane, for ``box_at``."""
    _put_box(world, agent, lane, find_box(world.fleet.bodies, world, agent, lane))


@kernel
def _put_box(world, agent, lane, found):
    box = world.nearby.box
    box[agent, BOX_LEFT, lane], box[agent, BOX_RIGHT, lane] = found[0], found[1]
    box[agent, BOX_LOW, lane], box[agent, BOX_HIGH, lane] = found[2], found[3]


@kernel
def box_at(world, agent, lane):
    """Return the box of a HAV that ``enclose`` or ``enclose_in`` has found."""
    box = world.nearby.box
    left, right = box[agent, BOX_LEFT, lane], box[agent, BOX_RIGHT, lane]
    return left, right, box[agent, BOX_LOW, lane], box[agent, BOX_HIGH, lane]


@unit_box.register(Lines)
def _box_of_line(bodies, world, agent, unit, lane, x, y):
    """The line reaches from the front end to the unit's end."""
    to_x, to_y, _, _ = ends_behind(world, agent, unit, lane, x, y)
    return min(x, to_x), max(x, to_x), min(y, to_y), max(y, to_y)


@bodies_meet.register(Lines)
def _lines_meet(bodies, world, agent, other, lane):
    return _chains_meet(world, agent, other, lane)


@rare_kernel
def _chains_meet(world, agent, other, lane):
    ax, ay = front_axle(world, agent, lane)
    box = box_at(world, other, lane)
    for unit in range(world.fleet.num_trailers[agent, lane] + 1):
        bx, by, next_x, next_y = ends_behind(world, agent, unit, lane, ax, ay)
        if not boxes_overlap((min(ax, bx), max(ax, bx), min(ay, by), max(ay, by)), box):
            ax, ay = next_x, next_y
            continue
        cx, cy = front_axle(world, other, lane)
        for other_unit in range(world.fleet.num_trailers[other, lane] + 1):
            dx, dy, behind_x, behind_y = ends_behind(world, other, other_unit, lane, cx, cy)
            if segments_intersect(ax, ay, bx, by, cx, cy, dx, dy):
                return True
            cx, cy = behind_x, behind_y
        ax, ay = next_x, next_y
    return False


@nearest_on_bodies.register(Lines)
def _nearest_on_lines(bodies, world, agent, lane, x, y):
    ax, ay = front_axle(world, agent, lane)
    least, nearest_x, nearest_y = math.inf, ax, ay
    for unit in range(world.fleet.num_trailers[agent, lane] + 1):
        line, _ = unit_spans(world.fleet.joints, world.fleet, agent, unit, lane)
        back_x, back_y = (
            -world.state.cosine[agent, unit, lane],
            -world.state.sine[agent, unit, lane],
        )
        px, py = nearest_on_segment(ax, ay, back_x, back_y, line, x, y)
        squared = (px - x) * (px - x) + (py - y) * (py - y)
        if squared < least:
            least, nearest_x, nearest_y = squared, px, py
        _, _, ax, ay = ends_behind(world, agent, unit, lane, ax, ay)
    return nearest_x, nearest_y


@front_end.register(Lines)
def _front_of_line(bodies, world, agent, lane):
    return front_axle(world, agent, lane)


@reach_of.register(Lines)
def _reach_of_lines(bodies, fleet, agent, lane):
    """The paper's footprint covers the trailers; a truck may be longer than all of them."""
    return max(fleet.radius[agent, FOOTPRINT, lane], fleet.length[agent, 0, lane])


@kernel
def widened(one, other):
    """Return the box round two boxes, each as ``find_box`` returns it."""
    left, right, low, high = one
    other_left, other_right, other_low, other_high = other
    return (
        min(left, other_left),
        max(right, other_right),
        min(low, other_low),
        max(high, other_high),
    )


@kernel
def boxes_overlap(one, other):
    """Return whether two boxes, as ``find_box`` returns them, have a point in common."""
    left, right, low, high = one
    other_left, other_right, other_low, other_high = other
    apart = (right < other_left) | (other_right < left) | (high < other_low) | (other_high < low)
    return not apart
