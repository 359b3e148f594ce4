"""This module finds the command nearest to the given one after which a HAV can stop safely."""

import math

from hav_env.compiled import kernel, lanes_from, rare_kernel
from hav_env.safety.commands import BACKUP, GIVEN, try_command
from hav_env.safety.filters import ONLY_COLLISIONS, ONLY_JACKKNIFES
from hav_env.safety.stopping.braking import find_doubts
from hav_env.safety.stopping.clearance import is_far_from_all, plan_is_clear
from hav_env.safety.trial_moves import (
    ASKED_SPEED,
    ASKED_STEERING,
    IN_DOUBT,
    KEPT_SPEED,
    KEPT_STEERING,
    drive_on_trial,
    drives,
    keep_posture,
    put_back,
)
from hav_env.vehicles import actuators_of
from hav_env.world.lanes import block_of


@kernel
def keep_stoppable(safety, task, vehicle, world, agent, speed, steering, rows):
    """Replace commands after which a HAV could not stop safely, in every lane of a block.

    Args:
        safety: Safety filter.
        task: Rules of the episode.
        vehicle: Vehicle model (kinematics).
        world: Block of worlds. The kernel moves the HAV on trial and puts it back.
        agent: Index of the HAV.
        speed: (N, W) commands [m/s]; row ``agent`` is overwritten where the filter changes it.
        steering: (N, W) commands [rad]; row ``agent`` is overwritten where the filter changes it.
        rows: (``scratch_rows``, W) scratch with the commands.
    """
    keep_posture(world, agent, rows)
    drive_on_trial(vehicle, task.dt, world, agent, speed, steering)
    for lane in range(world.lanes):
        rows[IN_DOUBT, lane] = 0.0
    if safety.against != ONLY_COLLISIONS:
        find_doubts(safety, task, vehicle, world, agent, speed, steering, rows)
        put_back(world, agent, rows)
        for lane in range(world.lanes):
            speed[agent, lane] = rows[ASKED_SPEED, lane]
            steering[agent, lane] = rows[ASKED_STEERING, lane]
        drive_on_trial(vehicle, task.dt, world, agent, speed, steering)
    for lane in range(world.lanes):
        if drives(world, agent, lane):
            one = block_of(world, lane, 1, world.units)
            doubt = rows[IN_DOUBT, lane] != 0.0
            if doubt or _may_meet(safety, task, vehicle, one, agent):
                _replace_command(
                    safety,
                    task,
                    vehicle,
                    one,
                    agent,
                    lanes_from(speed, lane),
                    lanes_from(steering, lane),
                    lanes_from(rows, lane),
                    doubt,
                )
    put_back(world, agent, rows)


@kernel
def _may_meet(safety, task, vehicle, world, agent):
    """Return whether a HAV may not be clear of all others: a quick test."""
    actuators = actuators_of(vehicle)
    return safety.against != ONLY_JACKKNIFES and not is_far_from_all(
        safety, task, actuators, world, agent
    )


@rare_kernel
def _replace_command(safety, task, vehicle, world, agent, speed, steering, rows, doubt):
    """Replace the command of a HAV in a block of one world if it cannot stop safely after it.

    ``doubt`` says that its joints may not be safe.
    """
    faster, turned = speed[agent, 0], steering[agent, 0]
    if doubt:
        faster, turned = _find_command(safety, task, vehicle, world, agent, speed, steering, rows)
        put_back(world, agent, rows)
        speed[agent, 0], steering[agent, 0] = faster, turned
        drive_on_trial(vehicle, task.dt, world, agent, speed, steering)
    if (
        safety.against != ONLY_JACKKNIFES
        and drives(world, agent, 0)
        and not plan_is_clear(safety, task, vehicle, world, agent, speed, steering, rows)
    ):
        faster = 0.0
        # the wheels of a HAV that stands may turn
        turned = rows[KEPT_STEERING, 0] if rows[KEPT_SPEED, 0] > 0.0 else turned
    speed[agent, 0], steering[agent, 0] = faster, turned


@rare_kernel
def _find_command(safety, task, vehicle, world, agent, speed, steering, rows):
    """Return the command nearest to the given one after which a HAV can straighten.

    The given one is known to be in doubt. Rates may let several commands reach the same steering.
    The last resort is to brake. A HAV that stands turns its wheels straight instead, and then it
    drives straight on.
    """
    stands, held = rows[KEPT_SPEED, 0] == 0.0, rows[KEPT_STEERING, 0]
    refused = math.inf
    for number in range(GIVEN, BACKUP, -1):
        try_command(vehicle, task.dt, world, agent, 0, speed, steering, rows, number)
        faster, turned = speed[agent, 0], steering[agent, 0]
        reached = world.state.steering[agent, 0]
        if (stands and reached == 0.0) or not drives(world, agent, 0):
            return faster, turned
        if number != GIVEN and reached != refused:
            find_doubts(safety, task, vehicle, world, agent, speed, steering, rows)
            if rows[IN_DOUBT, 0] == 0.0:
                return faster, turned
        refused = reached
    return 0.0, 0.0 if stands else held
