"""This module finds the command nearest to the given one after which a HAV can straighten."""

from hav_env.compiled import kernel, lanes_from, local_array, rare_kernel
from hav_env.maths.geometry import clip
from hav_env.safety.chains import (
    BAY_COLUMNS,
    BAYS,
    HANDED_ROWS,
    JOINT_ROWS,
    LOOK_COLUMNS,
    MOST_LOOKS,
    NARROW_BAY,
    OWN_LANE,
    SLOTS,
    TRIAL_NUMBER,
    WIDE_BAY,
    Chains,
    clear_chains,
)
from hav_env.safety.straightening import is_in_doubt, straightens_out
from hav_env.safety.trial_moves import (
    ASKED_SPEED,
    ASKED_STEERING,
    IN_DOUBT,
    drive_on_trial,
    drives,
    put_back,
)
from hav_env.safety.waves import PENDING, UNSAFE, UNSURE, WILL_STRAIGHTEN, enter, judge, wave
from hav_env.world.arrays import SPEED, STEERING
from hav_env.world.lanes import block_of

# shares of the commanded steering; the filter keeps the largest possible one
_STEERING_SHARES = (0.85, 0.7, 0.5, 0.25, 0.0)


@kernel
def find_safe_commands(safety, task, vehicle, world, agent, speed, steering, rows):
    """Find the commands nearest to the given ones after which HAVs in doubt can straighten.

    The HAVs have made their trial steps with the given commands. At the end they are at their
    positions after the found commands. If no share of the steering suffices, the command is the
    backup: straight on at full speed, which an earlier step found possible.

    Args:
        safety: Safety filter.
        task: Rules of the episode.
        vehicle: Vehicle model (kinematics).
        world: Block of worlds.
        agent: Index of the HAV.
        speed: (N, W) commands [m/s]; row ``agent`` is overwritten where the filter changes it.
        steering: (N, W) commands [rad]; row ``agent`` is overwritten where the filter changes it.
        rows: (``scratch_rows``, W) scratch; row IN_DOUBT is not 0 in lanes in doubt.
    """
    longest, begin = world.units - 1, 0
    # HAVs with few trailers are side by side
    for width in (NARROW_BAY, (longest + WIDE_BAY - 1) // WIDE_BAY * WIDE_BAY):
        if begin < longest:
            most = min(width, longest)
            _find_in_bays(
                safety,
                task.dt,
                vehicle,
                world,
                agent,
                speed,
                steering,
                rows,
                begin,
                most,
                width,
            )
            begin = most


@rare_kernel
def _find_in_bays(safety, dt, vehicle, world, agent, speed, steering, rows, more, most, width):
    """Find the commands of HAVs with more than ``more``, and at most ``most`` trailers."""
    chains = Chains(
        local_array(1, 2, SLOTS),
        local_array(1, 2, SLOTS),
        local_array(1, 2, SLOTS),
        local_array(1, 2, SLOTS),
        local_array(1, 2, SLOTS),
        local_array(1, JOINT_ROWS, SLOTS),
        local_array(1, HANDED_ROWS, SLOTS),
        local_array(BAYS, MOST_LOOKS, LOOK_COLUMNS),
        local_array(1, BAYS, BAY_COLUMNS),
    )
    bays = max(BAYS * NARROW_BAY // width, 1)
    h, begin, beyond, active = dt / vehicle.substeps, 0, 0, 1
    clear_chains(chains, bays * width)
    while active > 0:
        active = 0  # slots up to the last bay in use
        for bay in range(bays):
            own = chains.bay[0, bay]
            lane, number, verdict = int(own[OWN_LANE]), int(own[TRIAL_NUMBER]), WILL_STRAIGHTEN
            if lane >= 0:
                verdict = judge(safety, vehicle, chains, bay, width, beyond)
            while verdict != PENDING:
                if verdict == WILL_STRAIGHTEN:
                    lane, number = next_in_doubt(world, agent, rows, begin, more, most), -1
                    begin = lane + 1
                    if lane >= world.lanes:
                        own[OWN_LANE] = -1.0
                        break
                one, own_rows = block_of(world, lane, 1, world.units), lanes_from(rows, lane)
                own_speed, own_steering = lanes_from(speed, lane), lanes_from(steering, lane)
                unsure = verdict == UNSURE
                if unsure:
                    straight = straightens_out(
                        safety, vehicle, dt, one, agent, own_speed, own_steering, own_rows
                    )
                    verdict = WILL_STRAIGHTEN if straight else UNSAFE
                elif verdict == UNSAFE:
                    number += 1
                if number >= 0 or unsure:
                    try_command(vehicle, dt, world, agent, lane, speed, steering, rows, number)
                if unsure:
                    continue
                bent = enter(vehicle, dt, world, agent, lane, chains, bay, width)
                own[TRIAL_NUMBER] = float(number)
                verdict = UNSAFE if bent else PENDING
                given = number < 0  # the bounds alone decide on the given command
                if is_backup(world, agent, lane, rows, number) or (
                    bent and given and not is_in_doubt(dt, one, agent, own_rows)
                ):
                    verdict = WILL_STRAIGHTEN
            active = (bay + 1) * width if own[OWN_LANE] >= 0.0 else active
        if active > 0:
            beyond = wave(vehicle, h, world, chains, width, active)


@kernel
def is_backup(world, agent, lane, rows, number):
    """Return whether a command on trial is the backup: the last one, or no steering at full speed.

    It needs no prediction, because nothing else would follow.
    """
    full = rows[ASKED_SPEED, lane] == world.fleet.limit[agent, SPEED, lane]
    return number >= len(_STEERING_SHARES) - (1 if full else 0)


@kernel
def next_in_doubt(world, agent, rows, begin, more, most):
    """Return the next lane in which a HAV is in doubt and has so many trailers."""
    lane = begin
    while lane < world.lanes and not (
        rows[IN_DOUBT, lane] != 0.0
        and drives(world, agent, lane)
        and more < world.fleet.num_trailers[agent, lane] <= most
    ):
        lane += 1
    return lane


@kernel
def share_of_steering(number):
    """Return the share of the commanded steering of a command to try; see ``try_command``."""
    if number < 0:
        return 1.0
    return _STEERING_SHARES[number] if number < len(_STEERING_SHARES) else 0.0


@kernel
def try_command(vehicle, dt, world, agent, lane, speed, steering, rows, number):
    """Move a HAV on trial, in one lane, with one of the commands to try.

    -1 is the given command. The shares of the steering follow from 0 on, and then the backup.
    """
    one, own_rows = block_of(world, lane, 1, world.units), lanes_from(rows, lane)
    own_speed, own_steering = lanes_from(speed, lane), lanes_from(steering, lane)
    limit, asked = one.fleet.limit, own_rows[ASKED_STEERING, 0]
    steepest = limit[agent, STEERING, 0]
    turned = clip(asked, -steepest, steepest)
    put_back(one, agent, own_rows)
    own_speed[agent, 0], own_steering[agent, 0] = own_rows[ASKED_SPEED, 0], asked
    if number == len(_STEERING_SHARES):
        own_speed[agent, 0], own_steering[agent, 0] = limit[agent, SPEED, 0], 0.0
    elif number >= 0:
        own_steering[agent, 0] = turned * share_of_steering(number)
    drive_on_trial(vehicle, dt, one, agent, own_speed, own_steering)
