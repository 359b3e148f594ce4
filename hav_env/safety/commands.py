"""This module finds commands after which HAVs can straighten, near the given ones."""

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

# the filter tries these shares of the commanded steering one after another, until one is refused
_STEERING_SHARES = (0.0, 0.25, 0.5, 0.7, 0.85)
# numbers of commands to try: the backup, those of the shares from 0 on, and the given command
BACKUP, GIVEN = -1, len(_STEERING_SHARES)


@kernel
def find_safe_commands(safety, task, vehicle, world, agent, speed, steering, rows):
    """Find commands near the given ones after which HAVs in doubt can straighten.

    The HAVs have made their trial steps with the given commands. At the end they are at their
    positions after the found commands. If the given command is refused, the kernel tries shares of
    the steering, the smallest first, and finds the one before the first that is refused. If the
    smallest is refused, the command is the backup: straight on at full speed, which an earlier step
    found possible.

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
            found = lane < 0
            if not found:
                verdict = judge(safety, vehicle, chains, bay, width, beyond)
            while verdict != PENDING:
                if found:
                    lane = next_in_doubt(world, agent, rows, begin, more, most)
                    begin, number, found = lane + 1, GIVEN, False
                    if lane >= world.lanes:
                        own[OWN_LANE] = -1.0
                        break
                else:
                    one, own_rows = block_of(world, lane, 1, world.units), lanes_from(rows, lane)
                    own_speed, own_steering = lanes_from(speed, lane), lanes_from(steering, lane)
                    if verdict == UNSURE:
                        try_command(vehicle, dt, world, agent, lane, speed, steering, rows, number)
                        straight = straightens_out(
                            safety, vehicle, dt, one, agent, own_speed, own_steering, own_rows
                        )
                        verdict = WILL_STRAIGHTEN if straight else UNSAFE
                    safe = verdict == WILL_STRAIGHTEN
                    number, found = next_command(world, agent, lane, rows, number, safe)
                try_command(vehicle, dt, world, agent, lane, speed, steering, rows, number)
                if found:
                    continue
                bent = enter(vehicle, dt, world, agent, lane, chains, bay, width)
                own[TRIAL_NUMBER] = float(number)
                verdict = UNSAFE if bent else PENDING
                if bent and number == GIVEN:  # the bounds alone decide on the given command
                    one, own_rows = block_of(world, lane, 1, world.units), lanes_from(rows, lane)
                    found = not is_in_doubt(dt, one, agent, own_rows)
            active = (bay + 1) * width if own[OWN_LANE] >= 0.0 else active
        if active > 0:
            beyond = wave(vehicle, h, world, chains, width, active)


@kernel
def next_command(world, agent, lane, rows, number, safe):
    """Return the number of the command to try after another one, and whether it is the found one.

    At full speed, the share 0 is the backup itself, which needs no prediction.

    Args:
        world: Block of worlds.
        agent: Index of the HAV.
        lane: Index of the world.
        rows: Scratch with the commands.
        number: Number of the command on trial.
        safe: Whether the HAV straightens after it.
    """
    if number == GIVEN:
        full = rows[ASKED_SPEED, lane] == world.fleet.limit[agent, SPEED, lane]
        return (GIVEN if safe else 1 if full else 0), safe
    last = number + 1 == GIVEN
    return (number if last else number + 1) if safe else number - 1, last or not safe


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
    """Return the share of the commanded steering of a command to try."""
    if number == GIVEN:
        return 1.0
    return _STEERING_SHARES[number] if number > BACKUP else 0.0


@kernel
def try_command(vehicle, dt, world, agent, lane, speed, steering, rows, number):
    """Move a HAV on trial, in one lane, with one of the commands to try, from BACKUP to GIVEN."""
    one, own_rows = block_of(world, lane, 1, world.units), lanes_from(rows, lane)
    own_speed, own_steering = lanes_from(speed, lane), lanes_from(steering, lane)
    limit, asked = one.fleet.limit, own_rows[ASKED_STEERING, 0]
    steepest = limit[agent, STEERING, 0]
    turned = clip(asked, -steepest, steepest)
    put_back(one, agent, own_rows)
    own_speed[agent, 0], own_steering[agent, 0] = own_rows[ASKED_SPEED, 0], asked
    if number == BACKUP:
        own_speed[agent, 0], own_steering[agent, 0] = limit[agent, SPEED, 0], 0.0
    elif number < GIVEN:
        own_steering[agent, 0] = turned * share_of_steering(number)
    drive_on_trial(vehicle, dt, one, agent, own_speed, own_steering)
