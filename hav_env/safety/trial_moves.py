"""This module moves one HAV on trial, and puts it back to its earlier posture.

The simulator's own kernels move the HAV in its arrays. A prediction is therefore bit-equal to the
step itself, for every vehicle model. Scratch rows keep the earlier posture.
"""

from hav_env.compiled import kernel
from hav_env.vehicles import actuate, actuators_of, move

# scratch of a HAV: its posture before the trial, its commands, and the parts of a bound; from row
# POSTURE on headings, cosines and sines of all units
(
    KEPT_X,
    KEPT_Y,
    KEPT_SPEED,
    KEPT_STEERING,
    ASKED_SPEED,
    ASKED_STEERING,
    PATH_CURVATURE,
    LEAST_HEADING,
    GREATEST_HEADING,
    IN_DOUBT,
    COSINE_LIMIT,
    BENT_TOO_FAR,
    POSTURE,
) = range(13)
# the same rows again, once the bounds of the backup are done: the longest move of any command [m];
# the shortest unit and the widest body; whether another HAV or an obstacle may be near
LONGEST_MOVE, SHORTEST_UNIT, WIDEST_BODY, MAY_BE_NEAR = range(PATH_CURVATURE, COSINE_LIMIT)


def count_rows(units: int) -> int:
    """Return the number of scratch rows that a trial needs for HAVs with so many units."""
    return POSTURE + 3 * units


@kernel
def keep_posture(world, agent, rows):
    """Write the posture of a HAV into scratch, in every lane of a block."""
    state, units = world.state, world.units
    for lane in range(world.lanes):
        rows[KEPT_X, lane], rows[KEPT_Y, lane] = state.x[agent, lane], state.y[agent, lane]
        rows[KEPT_SPEED, lane] = state.speed[agent, lane]
        rows[KEPT_STEERING, lane] = state.steering[agent, lane]
    for unit in range(units):
        for lane in range(world.lanes):
            rows[POSTURE + unit, lane] = state.heading[agent, unit, lane]
            rows[POSTURE + units + unit, lane] = state.cosine[agent, unit, lane]
            rows[POSTURE + 2 * units + unit, lane] = state.sine[agent, unit, lane]


@kernel
def put_back(world, agent, rows):
    """Restore the posture of a HAV from scratch, in every lane of a block."""
    state, units = world.state, world.units
    for lane in range(world.lanes):
        state.x[agent, lane], state.y[agent, lane] = rows[KEPT_X, lane], rows[KEPT_Y, lane]
        state.speed[agent, lane] = rows[KEPT_SPEED, lane]
        state.steering[agent, lane] = rows[KEPT_STEERING, lane]
    for unit in range(units):
        for lane in range(world.lanes):
            state.heading[agent, unit, lane] = rows[POSTURE + unit, lane]
            state.cosine[agent, unit, lane] = rows[POSTURE + units + unit, lane]
            state.sine[agent, unit, lane] = rows[POSTURE + 2 * units + unit, lane]


@kernel
def swap_posture(world, agent, rows, lane):
    """Exchange the posture of a HAV in one lane with the one in scratch."""
    state, units = world.state, world.units
    rows[KEPT_X, lane], state.x[agent, lane] = state.x[agent, lane], rows[KEPT_X, lane]
    rows[KEPT_Y, lane], state.y[agent, lane] = state.y[agent, lane], rows[KEPT_Y, lane]
    for unit in range(units):
        _swap(rows, POSTURE + unit, state.heading, agent, unit, lane)
        _swap(rows, POSTURE + units + unit, state.cosine, agent, unit, lane)
        _swap(rows, POSTURE + 2 * units + unit, state.sine, agent, unit, lane)


@kernel
def _swap(rows, row, values, agent, unit, lane):
    rows[row, lane], values[agent, unit, lane] = values[agent, unit, lane], rows[row, lane]


@kernel
def drive_on_trial(vehicle, dt, world, agent, speed, steering):
    """Move a HAV one step with its command, in every lane of a block, without recording events.

    Args:
        vehicle: Vehicle model (kinematics).
        dt: Duration of the step [s].
        world: Block of worlds.
        agent: Index of the HAV.
        speed: (N, W) commands [m/s].
        steering: (N, W) commands [rad].
    """
    actuate(actuators_of(vehicle), dt, world, agent, speed, steering)
    move(vehicle, dt, world, agent)


@kernel
def drives(world, agent, lane):
    """Return whether a HAV moves in its trial step."""
    return (world.state.speed[agent, lane] > 0.0) & (not world.state.waiting[agent, lane])
