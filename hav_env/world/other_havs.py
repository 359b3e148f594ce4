"""This module describes another HAV in the frame of a HAV's truck: position, heading, bodies.

The caller passes the index of the other HAV; ``hav_env.world.sensing`` finds it in the list of
neighbours.
"""

import math

from hav_env.compiled import fixed, generic, kernel
from hav_env.maths.geometry import nearest_on_segment
from hav_env.maths.rectangles import nearest_on_rectangle
from hav_env.world.arrays import into_truck_frame
from hav_env.world.chain import ends_behind, front_axle
from hav_env.world.rectangle_bodies import rectangle_of
from hav_env.world.units.joints import unit_spans
from hav_env.world.units.parts import Lines, Outlines

# front end of the unit at hand, nearest point so far [m]; its squared distance [m^2]
FRONT_X, FRONT_Y, NEAREST_X, NEAREST_Y, LEAST_SQUARED, CHAIN_ROWS = range(6)


@kernel
def place_of(world, agent, other, lane):
    """Return the position of another truck's rear axle: forward [m], left [m]."""
    state = world.state
    dx = state.x[other, lane] - state.x[agent, lane]
    dy = state.y[other, lane] - state.y[agent, lane]
    return into_truck_frame(state, agent, lane, dx, dy)


@kernel
def direction_of(world, agent, other, lane):
    """Return cosine and sine of another truck's heading relative to the own truck's."""
    state = world.state
    cosine, sine = state.cosine[other, 0, lane], state.sine[other, 0, lane]
    return into_truck_frame(state, agent, lane, cosine, sine)


@generic
def nearest_on_unit(bodies, world, agent, unit, lane, front_x, front_y, x, y):
    """Return the point of a unit's body that is nearest to a position [m], given its front end.

    Beyond the HAV's last unit it is the front end, which is a point of the last unit.
    """


@nearest_on_unit.register(Lines)
def _nearest_on_line(bodies, world, agent, unit, lane, front_x, front_y, x, y):
    line, _ = unit_spans(world.fleet.joints, world.fleet, agent, unit, lane)
    back_x, back_y = -world.state.cosine[agent, unit, lane], -world.state.sine[agent, unit, lane]
    return nearest_on_segment(front_x, front_y, back_x, back_y, line, x, y)


@nearest_on_unit.register(Outlines)
def _nearest_on_rectangle_of(bodies, world, agent, unit, lane, front_x, front_y, x, y):
    rectangle = rectangle_of(bodies, world, agent, unit, lane, front_x, front_y)
    return nearest_on_rectangle(rectangle, x, y)


@kernel
def find_nearest_points(world, agent, other, chain):
    """Find, in all lanes, the point of another HAV's bodies that is nearest to the own rear axle.

    In one lane ``nearest_on_bodies`` computes the same, with a loop over the units inside.

    Args:
        world: Block of worlds.
        agent: Index of the HAV.
        other: Index of the other HAV, the same in all lanes.
        chain: (CHAIN_ROWS, L) scratch; rows NEAREST_X and NEAREST_Y become the point in the truck's
            frame: forward [m], left [m].
    """
    state, bodies = world.state, world.fleet.bodies
    for lane in range(world.lanes):
        x, y = front_axle(world, other, lane)
        chain[FRONT_X, lane] = chain[NEAREST_X, lane] = x
        chain[FRONT_Y, lane] = chain[NEAREST_Y, lane] = y
        chain[LEAST_SQUARED, lane] = math.inf
    # the block's loops may end at the last unit of the own HAV
    for number in range(state.heading.shape[1]):
        unit = fixed(number)
        for lane in range(world.lanes):
            x, y = state.x[agent, lane], state.y[agent, lane]
            ax, ay = chain[FRONT_X, lane], chain[FRONT_Y, lane]
            px, py = nearest_on_unit(bodies, world, other, unit, lane, ax, ay, x, y)
            squared = (px - x) * (px - x) + (py - y) * (py - y)
            least = chain[LEAST_SQUARED, lane]
            nearer = squared < least
            chain[NEAREST_X, lane] = px if nearer else chain[NEAREST_X, lane]
            chain[NEAREST_Y, lane] = py if nearer else chain[NEAREST_Y, lane]
            chain[LEAST_SQUARED, lane] = squared if nearer else least
            _, _, front_x, front_y = ends_behind(world, other, unit, lane, ax, ay)
            chain[FRONT_X, lane], chain[FRONT_Y, lane] = front_x, front_y
    for lane in range(world.lanes):
        dx = chain[NEAREST_X, lane] - state.x[agent, lane]
        dy = chain[NEAREST_Y, lane] - state.y[agent, lane]
        forward, left = into_truck_frame(state, agent, lane, dx, dy)
        chain[NEAREST_X, lane], chain[NEAREST_Y, lane] = forward, left
