"""This module simulates HAVs along Dubins paths: witnesses that their ways to goals are free.

The truck follows the path exactly. The trailers follow the kinematics of the general n-trailer
(``hav_env.vehicles.off_axle``), integrated over the driven path by the midpoint rule. A segment of
an obstacle that comes too near to a body on the way is refused.
"""

import math

from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.dubins import pose_on_path, shortest_path
from hav_env.maths.elementary import sincos
from hav_env.vehicles.off_axle import pull_of
from hav_env.world.arrays import ARTICULATION, into_truck_frame, turn_unit
from hav_env.world.lanes import block_of
from hav_env.world.obstacles.collisions import add_motion, gap_to_segment, note_posture
from hav_env.world.place.segments import MOST_MOVED, segment_of
from hav_env.world.sensing import drivable_radius
from hav_env.world.units.joints import hitch_offset, joint_limit

_STRIDE = 0.5  # [m] of the path, at most


@rare_kernel
def drive_witness(world, agent, lane, goal, widening, margin, count):
    """Drive a HAV from where it stands to a pose, and refuse segments that are too near.

    A segment is refused by NaN among what is due (``Obstacles.due``), for all HAVs. Those that are
    infinite there are not tested.

    Args:
        world: a block whose place has obstacles.
        agent: which HAV; it stands at the pose afterwards.
        lane: which world.
        goal: x [m], y [m] and heading [rad] of the truck's rear axle.
        widening: radius of the turns over the least that the HAV can drive for good.
        margin: least distance of bodies from segments [m].
        count: how many segments there are.

    Returns:
        The length of the path [m]; -1 when an articulation passes its limit.
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
    _refuse_near(world.place, world, agent, lane, margin, count)
    for step in range(1, steps + 1):
        note_posture(block.place, block, agent)
        before = state.heading[agent, 0, lane]
        driven = length * step / steps
        ahead, aside, turned = pose_on_path(word, first, second, third, radius, driven)
        state.x[agent, lane] = x + ahead * cosine - aside * sine
        state.y[agent, lane] = y + ahead * sine + aside * cosine
        turn_unit(state, agent, 0, lane, heading + turned)
        if not _pull_trailers(world, agent, lane, before, length / steps):
            return -1.0
        gone = world.place.driven[agent, MOST_MOVED, lane]
        add_motion(block.place, block, agent)
        # between two poses no point is farther from both than half of what it moved
        between = 0.5 * (world.place.driven[agent, MOST_MOVED, lane] - gone)
        _refuse_near(world.place, world, agent, lane, margin + between, count)
    return length


@kernel
def _pull_trailers(world, agent, lane, before, distance):
    """Let the trailers follow the truck, whose heading was another before it drove a distance [m].

    Returns whether all articulations are within their limits.
    """
    state, fleet, within = world.state, world.fleet, True
    turn = state.heading[agent, 0, lane] - before
    speed, rate, ahead = 1.0, turn / distance, before + 0.5 * turn  # halfway, for each metre
    usual = fleet.limit[agent, ARTICULATION, lane]
    for unit in range(1, fleet.num_trailers[agent, lane] + 1):
        own, length = state.heading[agent, unit, lane], fleet.length[agent, unit, lane]
        offset = hitch_offset(fleet.joints, agent, unit - 1, lane)
        sine, cosine = sincos(own - ahead)
        _, across = pull_of(speed, rate, cosine, sine, offset)
        sine, cosine = sincos(own - 0.5 * distance * across / length - ahead)
        along, across = pull_of(speed, rate, cosine, sine, offset)
        speed, rate = along, -across / length
        ahead = own + 0.5 * distance * rate
        turn_unit(state, agent, unit, lane, own + distance * rate)
        bend = state.heading[agent, unit, lane] - state.heading[agent, unit - 1, lane]
        within = within and abs(bend) < joint_limit(fleet.joints, usual, agent, unit, lane)
    return within


@kernel
def _refuse_near(place, world, agent, lane, margin, count):
    """Refuse the segments that are not farther than the margin [m] from a HAV."""
    driven, due = place.driven[agent, MOST_MOVED, lane], place.due[world.first + lane]
    for number in range(count):
        if due[agent, number] <= driven:
            gap = gap_to_segment(world, agent, segment_of(place, number, lane), lane)
            if gap > margin:
                due[agent, number] = driven + gap - margin
            else:
                for other in range(due.shape[0]):
                    due[other, number] = math.nan
