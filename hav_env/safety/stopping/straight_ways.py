"""This module drives HAVs straight on by trial, where bounds on their joints do not decide.

Units that roll without slip follow the same paths at all speeds. So a drive in the longest steps
stands for all, if it stays far from all limits. Otherwise a drive in short steps, which is nearly
the motion in continuous time, has to confirm it.
"""

import math

from hav_env.compiled import generic, kernel, lanes_from, local_array, rare_kernel
from hav_env.safety.straightening import is_in_doubt
from hav_env.safety.trial_moves import BENT_TOO_FAR, IN_DOUBT
from hav_env.vehicles import move
from hav_env.vehicles.off_axle import EULER
from hav_env.world.arrays import ARTICULATION, SPEED, turn_unit
from hav_env.world.lanes import block_of
from hav_env.world.units.joints import joint_limit
from hav_env.world.units.parts import Hitches

_PIECES = (1, 4)  # of the longest step, in the first and in the second drive
# distances of joints to their limits [rad] that a drive needs, and beyond which it suffices alone:
# drives of the vehicles of the catalogue differ by up to 0.12
_LEAST_SLACK, _AMPLE_SLACK = 0.05, 0.2
_MOST_UNITS = 64


@generic
def settle_by_drives(joints, safety, vehicle, dt, world, agent, rows):
    """Clear doubts about HAVs whose joints keep their limits on the way straight on.

    Args:
        joints: Kind of joints, which selects the kernel.
        safety: Safety filter.
        vehicle: Vehicle model (kinematics).
        dt: Duration of a step [s].
        world: Block of worlds, in which the HAV stands. It ends somewhere on its way.
        agent: Index of the HAV.
        rows: Scratch; row IN_DOUBT is changed.
    """


@settle_by_drives.otherwise
def _settle_none(joints, safety, vehicle, dt, world, agent, rows):
    pass


@settle_by_drives.register(Hitches)
def _settle_off_axle(joints, safety, vehicle, dt, world, agent, rows):
    if vehicle.integrator == EULER:  # its path depends on the speed
        return
    for lane in range(world.lanes):
        if (rows[IN_DOUBT, lane] != 0.0) & (rows[BENT_TOO_FAR, lane] == 0.0):
            one, own_rows = block_of(world, lane, 1, world.units), lanes_from(rows, lane)
            held = _keeps_unbent(safety, vehicle, dt, one, agent, own_rows)
            rows[IN_DOUBT, lane] = 0.0 if held else 1.0


@rare_kernel
def _keeps_unbent(safety, vehicle, dt, world, agent, rows):
    """Return whether all joints keep their limits on the way, in a block of one world."""
    state, begun = world.state, local_array(1, 1, _MOST_UNITS)[0, 0]
    if world.units > _MOST_UNITS:
        return False
    for unit in range(world.units):
        begun[unit] = state.heading[agent, unit, 0]
    slack = 0.0
    for pieces in _PIECES:
        for unit in range(1, world.units):
            turn_unit(state, agent, unit, 0, begun[unit])
        slack = _find_slack(safety, vehicle, dt, pieces, world, agent, rows)
        if not _LEAST_SLACK < slack < _AMPLE_SLACK:
            break
    return slack > _LEAST_SLACK


@kernel
def _find_slack(safety, vehicle, dt, pieces, world, agent, rows):
    """Return how near joints come to their limits [rad] until a bound holds them; -inf if none.

    Each of the longest steps is driven in pieces.
    """
    state, slack = world.state, _slack_of_joints(world, agent)
    state.speed[agent, 0], state.steering[agent, 0] = world.fleet.limit[agent, SPEED, 0], 0.0
    for _ in range(safety.horizon):
        if not slack > _LEAST_SLACK or not is_in_doubt(dt, world, agent, rows):
            return slack
        for _ in range(pieces):
            move(vehicle, dt / pieces, world, agent)
            slack = min(slack, _slack_of_joints(world, agent))
    return -math.inf


@kernel
def _slack_of_joints(world, agent):
    """Return the least distance of a joint to its limit [rad]."""
    heading, usual = world.state.heading, world.fleet.limit[agent, ARTICULATION, 0]
    slack = math.inf
    for unit in range(1, world.fleet.num_trailers[agent, 0] + 1):
        bend = abs(heading[agent, unit, 0] - heading[agent, unit - 1, 0])
        slack = min(slack, joint_limit(world.fleet.joints, usual, agent, unit, 0) - bend)
    return slack
