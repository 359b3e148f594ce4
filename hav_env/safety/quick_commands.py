"""This module finds the commands of most HAVs in doubt by quick predictions.

Predictions by articulations alone decide clear cases. The other HAVs stay in doubt, and
``hav_env.safety.commands`` simulates them. Both find the same commands.
"""

import math

from hav_env.compiled import generic, kernel, local_array, rare_kernel
from hav_env.safety.angles import (
    ABREAST,
    ANGLE_ROWS,
    HAS_TRAILERS,
    HAV_ROWS,
    MOST_BEND,
    MOST_TURN,
    OF_LANE,
    ON_TRIAL,
    STEPS_MADE,
    begin_command,
    clear_slot,
    hand_on_turns,
    judge_angles,
    move_trailer,
    move_up,
    note_angles,
)
from hav_env.safety.chains import NARROW_BAY
from hav_env.safety.commands import GIVEN, next_command, next_in_doubt, try_command
from hav_env.safety.trial_moves import IN_DOUBT, POSTURE
from hav_env.safety.waves import PENDING, UNSURE, WILL_STRAIGHTEN, is_proved
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
    return _find_in_waves(safety, vehicle, dt, world, agent, speed, steering, rows)


@rare_kernel
def _find_in_waves(safety, vehicle, dt, world, agent, speed, steering, rows):
    """Find the commands of HAVs whose trailers stand side by side in slots, without gaps."""
    chain, own = local_array(1, ANGLE_ROWS, ABREAST)[0], local_array(1, HAV_ROWS, ABREAST)[0]
    havs = slots = begin = found = 0
    while True:
        havs, slots, begin, done = _take_doubts(
            vehicle, dt, world, agent, speed, steering, rows, chain, own, havs, slots, begin
        )
        found += done
        if havs == 0:
            return found
        vectors = (slots + NARROW_BAY - 1) // NARROW_BAY
        for slot in range(slots, vectors * NARROW_BAY):
            clear_slot(chain, slot)
        for _ in range(_BLOCK):
            hand_on_turns(chain, vectors)
            for slot in range(vectors * NARROW_BAY):
                move_trailer(chain, slot)
        havs, slots, done = _follow_verdicts(
            safety, vehicle, dt, world, agent, speed, steering, rows, chain, own, havs
        )
        found += done


@kernel
def _take_doubts(vehicle, dt, world, agent, speed, steering, rows, chain, own, havs, slots, begin):
    """Let HAVs in doubt enter free slots, as many as fit.

    Returns:
        Numbers of HAVs and of slots in use; the next lane; number of HAVs with a found command.
    """
    found, begin = 0, _next_predictable(dt, world, agent, rows, begin)
    while begin < world.lanes and slots + world.fleet.num_trailers[agent, begin] <= ABREAST:
        note_angles(world, agent, begin, rows, chain, own, havs, slots)
        if begin_command(dt, world, agent, rows, chain, own, havs, slots, GIVEN) and _find_next(
            vehicle, dt, world, agent, speed, steering, rows, chain, own, havs, slots, False
        ):
            found += 1
        else:
            slots += world.fleet.num_trailers[agent, begin]
            havs += 1
        begin = _next_predictable(dt, world, agent, rows, begin + 1)
    return havs, slots, begin, found


@kernel
def _follow_verdicts(safety, vehicle, dt, world, agent, speed, steering, rows, chain, own, havs):
    """Let each HAV go on, or begin its next command, or leave; others move up.

    Returns:
        Numbers of HAVs and of slots in use; number of HAVs with a found command.
    """
    kept = slots = first = found = 0
    for hav in range(havs):
        trailers = int(own[HAS_TRAILERS, hav])
        own[STEPS_MADE, hav] += float(_BLOCK)
        verdict = judge_angles(safety, chain, own, hav, first)
        stays = verdict == PENDING
        if verdict not in (PENDING, UNSURE):
            safe = verdict == WILL_STRAIGHTEN
            stays = not _find_next(
                vehicle, dt, world, agent, speed, steering, rows, chain, own, hav, first, safe
            )
            found += 0 if stays else 1
        if stays:
            if kept < hav:
                move_up(chain, own, hav, first, kept, slots)
            kept, slots = kept + 1, slots + trailers
        first += trailers
    return kept, slots, found


@kernel
def _find_next(vehicle, dt, world, agent, speed, steering, rows, chain, own, hav, first, safe):
    """Let a HAV begin the next command, or move it by the found one; return whether one is found.

    Args:
        vehicle: Vehicle model (kinematics).
        dt: Duration of a step [s].
        world: Block of worlds.
        agent: Index of the HAV in its world.
        speed: (N, W) commands [m/s]; row ``agent`` is overwritten where the filter changes it.
        steering: (N, W) commands [rad]; row ``agent`` is overwritten where the filter changes it.
        rows: Scratch with the commands.
        chain: Trailers under prediction.
        own: HAVs under prediction.
        hav: Index of the HAV among those.
        first: Slot of its first trailer.
        safe: Whether the HAV straightens after the command on trial.
    """
    lane, number = int(own[OF_LANE, hav]), int(own[ON_TRIAL, hav])
    while True:
        number, found = next_command(world, agent, lane, rows, number, safe)
        if found:
            break
        if not begin_command(dt, world, agent, rows, chain, own, hav, first, number):
            return False
        safe = False
    rows[IN_DOUBT, lane] = 0.0
    if number != GIVEN:
        try_command(vehicle, dt, world, agent, lane, speed, steering, rows, number)
    return True


@kernel
def _next_predictable(dt, world, agent, rows, begin):
    """Return the next lane in which a HAV is in doubt, fits and is within the polynomials."""
    fleet, limits, lane = world.fleet, world.fleet.limit, begin
    while True:
        lane = next_in_doubt(world, agent, rows, lane, 0, ABREAST)
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
