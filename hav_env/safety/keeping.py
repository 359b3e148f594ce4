"""This module filters the commands of HAVs that all decide on the same state of a world."""

from hav_env.compiled import fixed, generic, kernel, lanes_from
from hav_env.safety.commands import find_safe_commands
from hav_env.safety.filters import ONLY_COLLISIONS, ONLY_JACKKNIFES, SafetyFilter, Unfiltered
from hav_env.safety.keeping_apart import keep_apart
from hav_env.safety.quick_commands import find_by_angles
from hav_env.safety.stopping.commands import keep_stoppable
from hav_env.safety.straightening import bound_backup
from hav_env.safety.trial_moves import (
    ASKED_SPEED,
    ASKED_STEERING,
    IN_DOUBT,
    count_rows,
    drive_on_trial,
    drives,
    keep_posture,
    put_back,
)
from hav_env.safety.turns_left import settle_by_turns
from hav_env.vehicles import Instant, Limited, actuators_of
from hav_env.world.arrays import INTERVENTIONS
from hav_env.world.lanes import moving_block


def scratch_rows(safety, units: int) -> int:
    """Return the number of scratch rows that a filter needs for HAVs with so many units."""
    return 0 if isinstance(safety, Unfiltered) else count_rows(units)


@generic
def filter_commands(safety, task, vehicle, world, command, filtered, memory, rows):
    """Return speeds [m/s] and steering angles [rad] of all HAVs of a block, (N, W) each.

    Args:
        safety: Safety filter.
        task: Rules of the episode.
        vehicle: Vehicle model (kinematics).
        world: Block of worlds.
        command: (2, N, W) commanded speed and steering; they do not change.
        filtered: (2, N, W) to write, empty without a filter.
        memory: (N, K, W) of a backup behind the filter, empty without one.
        rows: (``scratch_rows``, W) scratch.
    """


@filter_commands.register(Unfiltered)
def _pass_on(safety, task, vehicle, world, command, filtered, memory, rows):
    return command[0], command[1]


@filter_commands.otherwise
def _filter_all(safety, task, vehicle, world, command, filtered, memory, rows):
    speed, steering = filtered[0], filtered[1]
    for hav in range(world.state.x.shape[0]):
        agent = fixed(hav)
        for lane in range(world.lanes):
            speed[agent, lane] = command[0, agent, lane]
            steering[agent, lane] = command[1, agent, lane]
        moving = moving_block(world, agent)
        first = moving.first - world.first
        filter_command(
            safety,
            task,
            vehicle,
            lanes_from(memory, first),
            moving,
            agent,
            lanes_from(speed, first),
            lanes_from(steering, first),
            lanes_from(rows, first),
        )
    return speed, steering


@generic
def filter_command(safety, task, vehicle, memory, world, agent, speed, steering, rows):
    """Filter the commands of one HAV in every lane of a block.

    Args:
        safety: Safety filter.
        task: Rules of the episode.
        vehicle: Vehicle model (kinematics).
        memory: (N, K, W); the first rows are those of a backup behind the filter.
        world: Block of worlds, as ``moving_block`` makes it.
        agent: Index of the HAV.
        speed: (N, W) commands [m/s]; row ``agent`` is overwritten where the filter changes it.
        steering: (N, W) commands [rad]; row ``agent`` is overwritten where the filter changes it.
        rows: (``scratch_rows``, W) scratch.
    """


@filter_command.register(Unfiltered)
def _keep_command(safety, task, vehicle, memory, world, agent, speed, steering, rows):
    pass


@filter_command.register(SafetyFilter)
def _keep_safe(safety, task, vehicle, memory, world, agent, speed, steering, rows):
    keep_safe(safety, task, vehicle, world, agent, speed, steering, rows)


@kernel
def keep_safe(safety, task, vehicle, world, agent, speed, steering, rows):
    """Filter the commands of one HAV in every lane of a block; count those that change.

    Args:
        safety: Safety filter.
        task: Rules of the episode.
        vehicle: Vehicle model (kinematics).
        world: Block of worlds, as ``moving_block`` makes it. The kernel moves the HAV on trial and
            puts it back.
        agent: Index of the HAV.
        speed: (N, W) commands [m/s]; row ``agent`` is overwritten where the filter changes it.
        steering: (N, W) commands [rad]; row ``agent`` is overwritten where the filter changes it.
        rows: (``scratch_rows``, W) scratch.
    """
    for lane in range(world.lanes):
        rows[ASKED_SPEED, lane] = speed[agent, lane]
        rows[ASKED_STEERING, lane] = steering[agent, lane]
    actuators = actuators_of(vehicle)
    _change_commands(actuators, safety, task, vehicle, world, agent, speed, steering, rows)
    for lane in range(world.lanes):
        slower = speed[agent, lane] != rows[ASKED_SPEED, lane]
        turned = steering[agent, lane] != rows[ASKED_STEERING, lane]
        changed = (slower | turned) & (not world.state.waiting[agent, lane])
        world.record.total[agent, INTERVENTIONS, lane] += 1.0 if changed else 0.0


@generic
def _change_commands(actuators, safety, task, vehicle, world, agent, speed, steering, rows):
    """Change unsafe commands of one HAV in every lane of a block; its posture does not change."""


@_change_commands.register(Instant)
def _keep_standing(actuators, safety, task, vehicle, world, agent, speed, steering, rows):
    keep_posture(world, agent, rows)
    drive_on_trial(vehicle, task.dt, world, agent, speed, steering)
    if safety.against != ONLY_COLLISIONS:
        _keep_straight(safety, task, vehicle, world, agent, speed, steering, rows)
    if safety.against != ONLY_JACKKNIFES:
        keep_apart(safety, task, world, agent, speed, rows)
    put_back(world, agent, rows)


@_change_commands.register(Limited)
def _keep_braking(actuators, safety, task, vehicle, world, agent, speed, steering, rows):
    keep_stoppable(safety, task, vehicle, world, agent, speed, steering, rows)


@kernel
def _keep_straight(safety, task, vehicle, world, agent, speed, steering, rows):
    """Replace commands after which a HAV could not straighten, in every lane of a block."""
    doubts = 0
    bound_backup(task.dt, world, agent, rows)
    for lane in range(world.lanes):
        doubts += (rows[IN_DOUBT, lane] != 0.0) & drives(world, agent, lane)
    if doubts > 0:
        joints = world.fleet.joints
        doubts -= settle_by_turns(joints, safety, vehicle, task.dt, world, agent, rows)
    if doubts > 0:
        doubts -= find_by_angles(
            world.fleet.joints, safety, vehicle, task.dt, world, agent, speed, steering, rows
        )
    if doubts > 0:
        find_safe_commands(safety, task, vehicle, world, agent, speed, steering, rows)
