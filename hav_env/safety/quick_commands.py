"""This module finds the commands of most HAVs in doubt by quick predictions.

Predictions by articulations alone decide clear cases. The other HAVs stay in doubt, and
``hav_env.safety.commands`` simulates them. Both find the same commands.
"""

import math

from hav_env.compiled import generic, kernel, local_array, rare_kernel
from hav_env.safety.angles import (
    ABREAST,
    ABREAST_BAYS,
    ANGLE_ROWS,
    BAY_ROWS,
    MOST_BEND,
    MOST_TURN,
    OF_LANE,
    ON_TRIAL,
    begin_command,
    hand_on_turns,
    judge_angles,
    move_trailer,
    note_angles,
)
from hav_env.safety.chains import NARROW_BAY
from hav_env.safety.commands import is_backup, next_in_doubt, try_command
from hav_env.safety.trial_moves import IN_DOUBT, POSTURE
from hav_env.safety.waves import PENDING, UNSAFE, UNSURE, WILL_STRAIGHTEN, is_proved
from hav_env.world.arrays import ARTICULATION, SPEED, STEERING_COSINE, STEERING_SINE
from hav_env.world.units.parts import OnAxles

_BLOCK = 16  # waves between two verdicts
_LEAST_LIMIT, _MOST_LIMIT = 0.5, 0.5 * math.pi


@generic
def find_by_angles(joints, safety, vehicle, dt, world, agent, speed, steering, rows):
    """Find the commands of most HAVs in doubt; return the number of HAVs.

    The HAVs end at their positions after the found commands, and are no longer in doubt.

    Args:
        joints: Kind of joints, which selects the kernel.
        safety: Safety filter.
        vehicle: Vehicle model (kinematics).
        dt: Duration of a step [s].
        world: Block of worlds, in which the HAV is at its position after the given command.
        agent: Index of the HAV.
        speed: (N, W) commands [m/s]; row ``agent`` is overwritten where the filter changes it.
        steering: (N, W) commands [rad]; row ``agent`` is overwritten where the filter changes it.
        rows: Scratch; row IN_DOUBT is changed.
    """


@find_by_angles.otherwise
def _find_none(joints, safety, vehicle, dt, world, agent, speed, steering, rows):
    return 0


@find_by_angles.register(OnAxles)
def _find_on_axles(joints, safety, vehicle, dt, world, agent, speed, steering, rows):
    if not is_proved(vehicle) or vehicle.simultaneous:
        return 0
    found = 0
    for wide in range(2):
        if world.units - 1 > wide * NARROW_BAY:
            found += _find_in_waves(
                safety, vehicle, dt, world, agent, speed, steering, rows, (wide + 1) * NARROW_BAY
            )
    return found


@rare_kernel
def _find_in_waves(safety, vehicle, dt, world, agent, speed, steering, rows, width):
    """Find the commands of HAVs whose trailers fill a bay of a width, but none of half of it."""
    chain, own = (
        local_array(1, ANGLE_ROWS, ABREAST)[0],
        local_array(1, BAY_ROWS, ABREAST_BAYS)[0],
    )
    bays, begin, active, found = ABREAST // width, 0, 1, 0
    for bay in range(bays):
        own[OF_LANE, bay] = -1.0
    while active > 0:
        active = 0
        for bay in range(bays):
            verdict = UNSURE
            if own[OF_LANE, bay] >= 0.0:
                verdict = _follow_verdict(
                    safety, vehicle, dt, world, agent, speed, steering, rows, chain, own, bay, width
                )
                found += 1 if verdict == WILL_STRAIGHTEN else 0
            if verdict != PENDING:
                begin = _take_next_doubt(dt, world, agent, rows, chain, own, bay, width, begin)
            active = bay + 1 if own[OF_LANE, bay] >= 0.0 else active
        for _ in range(_BLOCK if active > 0 else 0):
            for bay in range(active):
                hand_on_turns(chain, own, bay, width)
            for slot in range(active * width):
                move_trailer(chain, slot)
    return found


@kernel
def _follow_verdict(
    safety, vehicle, dt, world, agent, speed, steering, rows, chain, own, bay, width
):
    """Try the next command of the HAV in a bay, or move it by the found one; return the verdict."""
    verdict = judge_angles(safety, chain, own, bay, width)
    lane, number = int(own[OF_LANE, bay]), int(own[ON_TRIAL, bay])
    if verdict == UNSAFE:
        number += 1
        if not is_backup(world, agent, lane, rows, number):
            begin_command(dt, world, agent, lane, rows, chain, own, bay, width, number)
            return PENDING
        verdict = WILL_STRAIGHTEN
    if verdict == WILL_STRAIGHTEN:
        rows[IN_DOUBT, lane] = 0.0
        if number >= 0:
            try_command(vehicle, dt, world, agent, lane, speed, steering, rows, number)
    return verdict


@kernel
def _take_next_doubt(dt, world, agent, rows, chain, own, bay, width, begin):
    """Let the next HAV in doubt enter a bay; return the lane after it."""
    lane = _next_predictable(dt, world, agent, rows, begin, width)
    own[OF_LANE, bay] = -1.0
    if lane < world.lanes:
        own[OF_LANE, bay] = float(lane)
        note_angles(world, agent, lane, rows, chain, own, bay, width)
        begin_command(dt, world, agent, lane, rows, chain, own, bay, width, -1)
    return lane + 1


@kernel
def _next_predictable(dt, world, agent, rows, begin, width):
    """Return the next lane in which a HAV is in doubt, fits and is within the polynomials."""
    fleet, limits, lane, narrower = world.fleet, world.fleet.limit, begin, width - NARROW_BAY
    while True:
        lane = next_in_doubt(world, agent, rows, lane, narrower, width)
        if lane >= world.lanes:
            return lane
        shortest = dt * limits[agent, SPEED, lane] / MOST_TURN
        fits, most = _LEAST_LIMIT <= limits[agent, ARTICULATION, lane] <= _MOST_LIMIT, 0.0
        tangent = limits[agent, STEERING_SINE, lane] * shortest
        fits = (
            fits and tangent <= limits[agent, STEERING_COSINE, lane] * fleet.length[agent, 0, lane]
        )
        for unit in range(1, fleet.num_trailers[agent, lane] + 1):
            fits = fits and fleet.length[agent, unit, lane] >= shortest
            most = max(most, abs(rows[POSTURE + unit, lane] - rows[POSTURE + unit - 1, lane]))
        if fits and most <= MOST_BEND:
            return lane
        lane += 1
