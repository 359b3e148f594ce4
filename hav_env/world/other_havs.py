"""This module tells where another HAV is, as seen from a HAV's truck: its place, heading, chain.

The other HAV is given by its number; ``hav_env.world.sensing`` finds it in the list of neighbours.
"""

import math

from hav_env.compiled import fixed, kernel
from hav_env.maths.geometry import nearest_on_segment
from hav_env.world.arrays import into_truck_frame
from hav_env.world.chain import axle_behind, front_axle

# front end of the unit at hand, nearest point so far [m]; its squared distance [m^2]
FRONT_X, FRONT_Y, NEAREST_X, NEAREST_Y, LEAST_SQUARED, CHAIN_ROWS = range(6)


@kernel
def place_of(world, agent, other, lane):
    """Return where the truck's rear axle of another HAV is: forward [m], left [m]."""
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


@kernel
def find_nearest_points(world, agent, other, chain):
    """Find in all lanes where the chain of another HAV is nearest to the own rear axle.

    In one lane ``nearest_on_chain`` does the same, with a loop over the units inside.

    Args:
        world: a block.
        agent: which HAV.
        other: which other HAV, the same in all lanes.
        chain: (CHAIN_ROWS, L) scratch; rows NEAREST_X and NEAREST_Y become the point, seen from the
            truck: forward [m], left [m].
    """
    state = world.state
    for lane in range(world.lanes):
        x, y = front_axle(world, other, lane)
        chain[FRONT_X, lane] = chain[NEAREST_X, lane] = x
        chain[FRONT_Y, lane] = chain[NEAREST_Y, lane] = y
        chain[LEAST_SQUARED, lane] = math.inf
    for number in range(state.heading.shape[1]):  # the block's loops may end where the own HAV does
        unit = fixed(number)
        for lane in range(world.lanes):
            x, y = state.x[agent, lane], state.y[agent, lane]
            ax, ay = chain[FRONT_X, lane], chain[FRONT_Y, lane]
            # beyond the last unit the segment is a point that was looked at before
            bx, by = axle_behind(world, other, unit, lane, ax, ay)
            present = unit <= world.fleet.num_trailers[other, lane]
            length = world.fleet.length[other, unit, lane] if present else 0.0
            back_x, back_y = -state.cosine[other, unit, lane], -state.sine[other, unit, lane]
            px, py = nearest_on_segment(ax, ay, back_x, back_y, length, x, y)
            squared = (px - x) * (px - x) + (py - y) * (py - y)
            least = chain[LEAST_SQUARED, lane]
            nearer = squared < least
            chain[NEAREST_X, lane] = px if nearer else chain[NEAREST_X, lane]
            chain[NEAREST_Y, lane] = py if nearer else chain[NEAREST_Y, lane]
            chain[LEAST_SQUARED, lane] = squared if nearer else least
            chain[FRONT_X, lane], chain[FRONT_Y, lane] = bx, by
    for lane in range(world.lanes):
        dx = chain[NEAREST_X, lane] - state.x[agent, lane]
        dy = chain[NEAREST_Y, lane] - state.y[agent, lane]
        forward, left = into_truck_frame(state, agent, lane, dx, dy)
        chain[NEAREST_X, lane], chain[NEAREST_Y, lane] = forward, left
