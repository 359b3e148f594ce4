"""This module drives HAVs straight on by trial, where bounds on their joints do not decide.

Units that roll without slip follow the same paths at all speeds. So a drive in the longest steps
stands for all, if it stays far from all limits. Otherwise a drive in short steps, which is nearly
the motion in continuous time, has to confirm it.
"""

import math

from hav_env.compiled import fixed, generic, kernel, lanes_from, local_array, rare_kernel
from hav_env.safety.straightening import bound_backup
from hav_env.safety.trial_moves import BENT_TOO_FAR, IN_DOUBT
from hav_env.vehicles import move
from hav_env.vehicles.off_axle import EULER
from hav_env.world.arrays import ARTICULATION, SPEED, turn_unit
from hav_env.world.lanes import LANES, block_of
from hav_env.world.units.joints import joint_limit
from hav_env.world.units.parts import Hitches

_SHARES_OF_STEP = 4  # of the longest step, driven one by one in the second drive
# distances of joints to their limits [rad] that a drive needs, and beyond which it suffices alone:
# drives of the vehicles of the catalogue differ by up to 0.12
_LEAST_SLACK, _AMPLE_SLACK = 0.05, 0.2
_MOST_UNITS = 32  # of HAVs that drive on trial; bounds alone decide on longer ones
_FEWEST_DRIVES = 4  # doubts below which HAVs drive one by one, not in all lanes
# scratch of a drive: whether a HAV is still under way; the least distance of its joints to their
# limits [rad]
_ON_THE_WAY, _SLACK, _DRIVE_ROWS = range(3)


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
    # with Euler steps the way depends on the speed
    if vehicle.integrator == EULER or world.units > _MOST_UNITS:
        return
    for first in range(0, world.lanes, LANES):
        part = block_of(world, first, min(LANES, world.lanes - first), world.units)
        _settle_midway(safety, vehicle, dt, part, agent, lanes_from(rows, first))


@rare_kernel
def _settle_midway(safety, vehicle, dt, world, agent, rows):
    """Clear doubts about HAVs that keep away from their limits in one drive, or in two."""
    begun, drive = (
        local_array(1, _MOST_UNITS, LANES)[0],
        local_array(1, _DRIVE_ROWS, LANES)[0],
    )
    heading, doubts = world.state.heading, 0
    for unit in range(world.units):
        for lane in range(world.lanes):
            begun[unit, lane] = heading[agent, unit, lane]
    for lane in range(world.lanes):
        doubt = (rows[IN_DOUBT, lane] != 0.0) & (rows[BENT_TOO_FAR, lane] == 0.0)
        drive[_ON_THE_WAY, lane] = 1.0 if doubt else 0.0
        drive[_SLACK, lane] = math.inf
        doubts += doubt
    if doubts >= _FEWEST_DRIVES:
        _drive(safety, vehicle, dt, 1, world, agent, rows, drive)
    for lane in range(world.lanes):
        one, own_rows = block_of(world, lane, 1, world.units), lanes_from(rows, lane)
        own = lanes_from(drive, lane)
        if own[_ON_THE_WAY, 0] != 0.0:
            _drive(safety, vehicle, dt, 1, one, agent, own_rows, own)
        if _LEAST_SLACK < own[_SLACK, 0] < _AMPLE_SLACK:
            for unit in range(1, world.units):
                turn_unit(one.state, agent, unit, 0, begun[unit, lane])
            own[_ON_THE_WAY, 0] = 1.0
            _drive(safety, vehicle, dt, _SHARES_OF_STEP, one, agent, own_rows, own)
        own_rows[IN_DOUBT, 0] = 0.0 if own[_SLACK, 0] > _LEAST_SLACK else 1.0


@kernel
def _drive(safety, vehicle, dt, pieces, world, agent, rows, drive):
    """Drive HAVs straight on until bounds hold their joints or a joint is near its limit.

    A HAV under way at the end of the horizon is near its limit. Each of the longest steps is driven
    in pieces.
    """
    state, left = world.state, safety.horizon
    for lane in range(world.lanes):
        state.speed[agent, lane] = world.fleet.limit[agent, SPEED, lane]
        state.steering[agent, lane] = 0.0
    _note_slack(world, agent, drive)
    while left > 0:
        bound_backup(dt, world, agent, rows)
        under_way = 0
        for lane in range(world.lanes):
            goes = (rows[IN_DOUBT, lane] != 0.0) & (drive[_SLACK, lane] > _LEAST_SLACK)
            drive[_ON_THE_WAY, lane] = drive[_ON_THE_WAY, lane] if goes else 0.0
            under_way += drive[_ON_THE_WAY, lane] != 0.0
        if under_way == 0:
            return
        for _ in range(pieces):
            move(vehicle, dt / pieces, world, agent)
            _note_slack(world, agent, drive)
        left -= 1
    for lane in range(world.lanes):
        stays = drive[_ON_THE_WAY, lane] == 0.0
        drive[_SLACK, lane] = drive[_SLACK, lane] if stays else 0.0
        drive[_ON_THE_WAY, lane] = 0.0


@kernel
def _note_slack(world, agent, drive):
    """Note how near joints of HAVs under way are to their limits."""
    heading, fleet = world.state.heading, world.fleet
    for number in range(1, world.units):
        unit = fixed(number)
        for lane in range(world.lanes):
            bend = abs(heading[agent, unit, lane] - heading[agent, unit - 1, lane])
            usual, noted = fleet.limit[agent, ARTICULATION, lane], drive[_SLACK, lane]
            slack = joint_limit(fleet.joints, usual, agent, unit, lane) - bend
            counts = (unit <= fleet.num_trailers[agent, lane]) & (drive[_ON_THE_WAY, lane] != 0.0)
            drive[_SLACK, lane] = min(noted, slack) if counts else noted
