"""This module lets HAVs brake on trial, and says whether their joints keep their limits."""

from hav_env.compiled import fixed, kernel
from hav_env.safety.stopping.straight_ways import settle_by_drives
from hav_env.safety.straightening import SPARE_ANGLE, bound_backup
from hav_env.safety.trial_moves import BENT_TOO_FAR, IN_DOUBT, drive_on_trial, drives
from hav_env.safety.turns_left import settle_by_turns
from hav_env.world.arrays import ARTICULATION, SPEED
from hav_env.world.units.joints import joint_limit


@kernel
def brake_on_trial(vehicle, dt, world, agent, speed, steering):
    """Let a HAV brake for a step with its wheels held, in every lane of a block.

    Its commands are overwritten.
    """
    for lane in range(world.lanes):
        speed[agent, lane], steering[agent, lane] = 0.0, world.state.steering[agent, lane]
    drive_on_trial(vehicle, dt, world, agent, speed, steering)


@kernel
def find_doubts(safety, task, vehicle, world, agent, speed, steering, rows):
    """Write, in every lane of a block, whether a HAV is in doubt: 0.0 if its joints are safe.

    They are safe if they keep their limits while the HAV brakes until it stands, and if bounds hold
    them from there while it drives straight on at any speeds. With off-axle hitches, trial drives
    decide where bounds do not. The HAV ends somewhere on its way.

    Args:
        safety: Safety filter.
        task: Rules of the episode.
        vehicle: Vehicle model (kinematics).
        world: Block of worlds, in which the HAV is at its position after the step in question.
        agent: Index of the HAV.
        speed: (N, W) commands [m/s]; row ``agent`` is overwritten.
        steering: (N, W) commands [rad]; row ``agent`` is overwritten.
        rows: Scratch; row IN_DOUBT is written.
    """
    for lane in range(world.lanes):
        rows[BENT_TOO_FAR, lane] = 0.0
    _note_bends(world, agent, rows)
    left, rolling = safety.horizon, _count_driving(world, agent)
    while rolling > 0 and left > 0:
        brake_on_trial(vehicle, task.dt, world, agent, speed, steering)
        _note_bends(world, agent, rows)
        left, rolling = left - 1, _count_driving(world, agent)
    bound_backup(task.dt, world, agent, rows)
    doubts = 0
    for lane in range(world.lanes):
        stands = not drives(world, agent, lane)
        rows[BENT_TOO_FAR, lane] = rows[BENT_TOO_FAR, lane] if stands else 1.0
        doubts += rows[IN_DOUBT, lane] != 0.0
    if doubts > 0:
        for lane in range(world.lanes):  # the third bound examines HAVs that drive
            world.state.speed[agent, lane] = world.fleet.limit[agent, SPEED, lane]
        settle_by_turns(world.fleet.joints, safety, vehicle, task.dt, world, agent, rows)
        settle_by_drives(world.fleet.joints, safety, vehicle, task.dt, world, agent, rows)
    for lane in range(world.lanes):
        rows[IN_DOUBT, lane] = max(rows[IN_DOUBT, lane], rows[BENT_TOO_FAR, lane])


@kernel
def _count_driving(world, agent):
    """Return the number of lanes in which a HAV has not come to rest."""
    count = 0
    for lane in range(world.lanes):
        count += drives(world, agent, lane)
    return count


@kernel
def _note_bends(world, agent, rows):
    """Note in which lanes a joint is at its limit or beyond, or has folded through."""
    heading, fleet = world.state.heading, world.fleet
    for number in range(1, world.units):
        unit = fixed(number)
        for lane in range(world.lanes):
            bend = abs(heading[agent, unit, lane] - heading[agent, unit - 1, lane])
            usual, noted = fleet.limit[agent, ARTICULATION, lane], rows[BENT_TOO_FAR, lane]
            most = joint_limit(fleet.joints, usual, agent, unit, lane) - SPARE_ANGLE
            beyond = (unit <= fleet.num_trailers[agent, lane]) & (not bend < most)
            rows[BENT_TOO_FAR, lane] = 1.0 if beyond else noted
