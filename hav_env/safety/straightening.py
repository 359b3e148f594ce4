"""This module predicts whether a HAV can straighten without a jackknife.

The backup drives straight on at full speed. ``bound_backup`` bounds every articulation during the
backup from the posture alone. If the bound is inconclusive, ``straightens_out`` simulates the
backup until the bound holds. ``hav_env.safety.waves`` usually decides the same for several HAVs at
a time. docs/safety-filter.md has the proofs.
"""

import math

from hav_env.compiled import fixed, kernel, rare_kernel
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import into_frame
from hav_env.safety.trial_moves import (
    COSINE_LIMIT,
    GREATEST_HEADING,
    IN_DOUBT,
    LEAST_HEADING,
    PATH_CURVATURE,
    drive_on_trial,
)
from hav_env.world.arrays import ARTICULATION, SPEED
from hav_env.world.units.joints import hitch_offset, joint_limit

# far more than the accumulated rounding error of a prediction [rad]
SPARE_ANGLE = 1e-6
_QUARTER = 0.5 * math.pi
_TINY = 1e-9


@kernel
def bound_backup(dt, world, agent, rows):
    """Write, in every lane of a block, whether a HAV is in doubt: 0.0 if its backup is safe.

    The kernel tries two bounds. With on-axle hitches, the headings of all units stay between the
    least and the greatest one. The second bounds the curvature of each axle's path from front to
    rear. A joint stays below the larger of its articulation and the angle at which the curvature
    ahead holds it.

    Args:
        dt: Duration of a step [s].
        world: Block of worlds.
        agent: Index of the HAV, at its position after the step in question.
        rows: Scratch; row IN_DOUBT is written.
    """
    state, fleet = world.state, world.fleet
    for lane in range(world.lanes):
        rows[PATH_CURVATURE, lane] = 0.0
        rows[LEAST_HEADING, lane] = rows[GREATEST_HEADING, lane] = state.heading[agent, 0, lane]
        rows[IN_DOUBT, lane] = 0.0
        rows[COSINE_LIMIT, lane] = cosine_limit(fleet.limit[agent, ARTICULATION, lane])
    for number in range(1, world.units):
        unit = fixed(number)
        for lane in range(world.lanes):
            _bound_unit(dt, world, agent, unit, lane, rows)
    for lane in range(world.lanes):
        spread = rows[GREATEST_HEADING, lane] - rows[LEAST_HEADING, lane]
        most = largest_spread(fleet.limit[agent, ARTICULATION, lane])
        rows[IN_DOUBT, lane] = 0.0 if spread < most else rows[IN_DOUBT, lane]


@kernel
def _bound_unit(dt, world, agent, unit, lane, rows):
    """Propagate both bounds to the next unit."""
    # reads come before selections: compiled code branches where it selects between reads
    state, fleet = world.state, world.fleet
    curvature, doubt = rows[PATH_CURVATURE, lane], rows[IN_DOUBT, lane]
    so_far = rows[LEAST_HEADING, lane], rows[GREATEST_HEADING, lane]
    limit, heading = rows[COSINE_LIMIT, lane], state.heading[agent, unit, lane]
    direction = state.cosine[agent, unit, lane], state.sine[agent, unit, lane]
    ahead = state.cosine[agent, unit - 1, lane], state.sine[agent, unit - 1, lane]
    length, step = fleet.length[agent, unit, lane], dt * fleet.limit[agent, SPEED, lane]
    offset = abs(hitch_offset(fleet.joints, agent, unit - 1, lane))
    present = unit <= fleet.num_trailers[agent, lane]
    length, offset = length if present else 1.0, offset if present else 0.0

    least, greatest = bound_headings(*so_far, heading, step, length, offset)
    cosine, sine = into_frame(*direction, *ahead)
    held, behind = bound_joint(curvature, step, length, offset, cosine, sine, limit)
    rows[LEAST_HEADING, lane] = least if present else so_far[0]
    rows[GREATEST_HEADING, lane] = greatest if present else so_far[1]
    rows[IN_DOUBT, lane] = doubt if held | (not present) else 1.0
    rows[PATH_CURVATURE, lane] = behind if present else curvature


@kernel
def cosine_limit(limit):
    """Return the cosine of a limit of articulations [rad], less a spare angle, above 0."""
    _, cosine = sincos(limit - SPARE_ANGLE)
    return max(cosine, _TINY)


@kernel
def largest_spread(limit):
    """Return the spread of headings [rad] below which no joint reaches a limit [rad]."""
    return min(limit, _QUARTER) - SPARE_ANGLE


@kernel
def bound_headings(least, greatest, heading, step, length, offset):
    """Return the least and the greatest heading [rad] of the units down to a trailer.

    A step longer than a trailer may turn it beyond the heading ahead, and off-axle hitches swing
    out: then the first one is -inf.
    """
    swings = (offset > 0.0) | (step > length)
    return min(least, -math.inf if swings else heading), max(greatest, heading)


@kernel
def bound_joint(curvature, step, length, offset, cosine, sine, least_cosine):
    """Return whether the bound of curvatures holds a joint, and the curvature behind it.

    Args:
        curvature: Bound on the curvature of the path of the axle ahead [1/m].
        step: Longest step of the truck [m].
        length: Length of the trailer [m].
        offset: Distance of its hitch from the axle ahead, at least 0 [m].
        cosine: Cosine of the articulation.
        sine: Sine of the articulation.
        least_cosine: Least cosine that is allowed.
    """
    bent = max(abs(sine), (length + offset) * curvature)
    straight = math.sqrt(max(1.0 - bent * bent, 0.0))
    limit = max(least_cosine, curvature * step)
    held = (straight - offset * curvature > limit) & (cosine > 0.0) & (step <= length)
    swing = offset * curvature
    room = max(straight - swing, _TINY)
    return held, (bent + swing + curvature * step * room) / (room * length)


@kernel
def bends_too_far(world, agent, lane):
    """Return whether a joint of a HAV is at its limit or beyond, or has folded through."""
    state, fleet = world.state, world.fleet
    usual = fleet.limit[agent, ARTICULATION, lane]
    for unit in range(1, fleet.num_trailers[agent, lane] + 1):
        bend = abs(state.heading[agent, unit, lane] - state.heading[agent, unit - 1, lane])
        if not bend < joint_limit(fleet.joints, usual, agent, unit, lane) - SPARE_ANGLE:
            return True
    return False


@rare_kernel
def is_in_doubt(dt, world, agent, rows):
    """Return what ``bound_backup`` finds in a block of one world."""
    bound_backup(dt, world, agent, rows)
    return rows[IN_DOUBT, 0] != 0.0


@rare_kernel
def straightens_out(safety, vehicle, dt, world, agent, speed, steering, rows):
    """Return whether a HAV can straighten from its position, in a block of one world.

    The HAV ends somewhere on its predicted path.

    Args:
        safety: Safety filter.
        vehicle: Vehicle model (kinematics).
        dt: Duration of a step [s].
        world: Block of one world.
        agent: Index of the HAV, at its position after the step in question.
        speed: (N, 1) commands [m/s]; the HAV's is overwritten.
        steering: (N, 1) commands [rad]; the HAV's is overwritten.
        rows: Scratch; bounds are overwritten.
    """
    speed[agent, 0], steering[agent, 0] = world.fleet.limit[agent, SPEED, 0], 0.0
    for _ in range(safety.horizon):
        if bends_too_far(world, agent, 0):
            return False
        if not is_in_doubt(dt, world, agent, rows):
            return True
        drive_on_trial(vehicle, dt, world, agent, speed, steering)
    return False
