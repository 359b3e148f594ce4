"""This module simulates HAVs along Dubins paths, as witnesses of free paths to goals.

The truck follows the path exactly. The trailers follow the kinematics of the general n-trailer
(``hav_env.vehicles.off_axle``), integrated over the driven path by the midpoint rule.
``meet_walls`` finds segments that are too near to a body on the path.
"""

from typing import NamedTuple

from hav_env.compiled import generic, kernel, rare_kernel
from hav_env.maths.dubins import pose_on_path, shortest_path
from hav_env.vehicles.off_axle import pull_unit
from hav_env.world.arrays import ARTICULATION, into_truck_frame, turn_unit
from hav_env.world.lanes import block_of
from hav_env.world.obstacles.collisions import add_motion, find_margin, gap_to_segment, note_posture
from hav_env.world.place.segments import MOST_MOVED, segment_of
from hav_env.world.sensing import drivable_radius
from hav_env.world.units.joints import hitch_offset, joint_limit

_STRIDE = 0.5  # [m] of the path, at most


class PlacedWalls(NamedTuple):
    """The segments of a world. A path ends at the first segment that is too near."""

    num_walls: int
    """Number of segments."""


@generic
def meet_walls(walls, world, agent, lane, margin):
    """Test the walls that a HAV may have come near to; return whether its path ends here.

    ``MOST_MOVED`` is the driven distance of the HAV. ``Obstacles.due`` is the distance at which a
    wall is tested again.

    Args:
        walls: walls to test; their type selects the kernel.
        world: a block whose place has obstacles.
        agent: number of the HAV.
        lane: number of the world.
        margin: least distance of bodies from walls [m].
    """


@meet_walls.register(PlacedWalls)
def _meet_placed_walls(walls, world, agent, lane, margin):
    place = world.place
    driven, due = place.driven[agent, MOST_MOVED, lane], place.due[world.first + lane]
    for number in range(walls.num_walls):
        if due[agent, number] <= driven:
            gap = gap_to_segment(world, agent, segment_of(place, number, lane), lane)
            if gap <= margin:
                return True
            due[agent, number] = driven + gap - margin
    return False


@kernel
def begin_way(world, agent, lane):
    """Reset the driven distance of a HAV at its pose."""
    world.place.driven[agent, MOST_MOVED, lane] = 0.0
    find_margin(world.place, world, agent, lane)


@rare_kernel
def drive_witness(walls, world, agent, lane, goal, widening, margin):
    """Drive a HAV from its pose to another one, past walls.

    Args:
        walls: see ``meet_walls``.
        world: a block whose place has obstacles.
        agent: number of the HAV; afterwards it is at the pose.
        lane: number of the world.
        goal: x [m], y [m] and heading [rad] of the truck's rear axle.
        widening: radius of the turns over the least steady radius of the HAV.
        margin: least distance of bodies from walls [m].

    Returns:
        Whether it arrived: no wall ended its path, and no articulation exceeded its limit.
    """
    state = world.state
    x, y, heading = state.x[agent, lane], state.y[agent, lane], state.heading[agent, 0, lane]
    forward, left = into_truck_frame(state, agent, lane, goal[0] - x, goal[1] - y)
    cosine, sine = state.cosine[agent, 0, lane], state.sine[agent, 0, lane]
    radius = widening * drivable_radius(world, agent, lane)
    word, first, second, third = shortest_path(forward, left, goal[2] - heading, radius)
    length = first + second + third
    steps = int(length / _STRIDE) + 1
    block = block_of(world, lane, 1, world.fleet.num_trailers[agent, lane] + 1)
    if meet_walls(walls, world, agent, lane, margin):
        return False
    for step in range(1, steps + 1):
        note_posture(block.place, block, agent)
        before = state.heading[agent, 0, lane]
        driven = length * step / steps
        ahead, aside, turned = pose_on_path(word, first, second, third, radius, driven)
        state.x[agent, lane] = x + ahead * cosine - aside * sine
        state.y[agent, lane] = y + ahead * sine + aside * cosine
        turn_unit(state, agent, 0, lane, heading + turned)
        if not _pull_trailers(world, agent, lane, before, length / steps):
            return False
        gone = world.place.driven[agent, MOST_MOVED, lane]
        add_motion(block.place, block, agent)
        # between two poses no point is farther from both than half of its motion
        between = 0.5 * (world.place.driven[agent, MOST_MOVED, lane] - gone)
        if meet_walls(walls, world, agent, lane, margin + between):
            return False
    return True


@kernel
def _pull_trailers(world, agent, lane, before, distance):
    """Move the trailers behind the truck, given its heading before it drove a distance [m].

    Returns whether all articulations are within their limits.
    """
    state, fleet, within = world.state, world.fleet, True
    turn = state.heading[agent, 0, lane] - before
    speed, rate, ahead = 1.0, turn / distance, before + 0.5 * turn  # halfway, for each metre
    usual = fleet.limit[agent, ARTICULATION, lane]
    for unit in range(1, fleet.num_trailers[agent, lane] + 1):
        own, length = state.heading[agent, unit, lane], fleet.length[agent, unit, lane]
        offset = hitch_offset(fleet.joints, agent, unit - 1, lane)
        speed, rate, ahead, heading = pull_unit(own, ahead, speed, rate, offset, length, distance)
        turn_unit(state, agent, unit, lane, heading)
        bend = state.heading[agent, unit, lane] - state.heading[agent, unit - 1, lane]
        within = within and abs(bend) < joint_limit(fleet.joints, usual, agent, unit, lane)
    return within
