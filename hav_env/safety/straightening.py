"""This module predicts whether a HAV can straighten without a jackknife.

The backup drives straight on at full speed. ``bound_backup`` bounds every articulation during the
backup from the posture alone. If the bound is inconclusive, ``straightens_out`` simulates the
backup until the bound holds. docs/safety-filter.md has the proofs.
"""

import math

from hav_env.compiled import kernel, rare_kernel
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
        _, cosine = sincos(fleet.limit[agent, ARTICULATION, lane] - SPARE_ANGLE)
        rows[COSINE_LIMIT, lane] = max(cosine, _TINY)
    for unit in range(1, world.units):
        for lane in range(world.lanes):
            _bound_joint(dt, world, agent, unit, lane, rows)
    for lane in range(world.lanes):
        limit = min(fleet.limit[agent, ARTICULATION, lane], _QUARTER) - SPARE_ANGLE
        spread = rows[GREATEST_HEADING, lane] - rows[LEAST_HEADING, lane]
        rows[IN_DOUBT, lane] = 0.0 if spread < limit else rows[IN_DOUBT, lane]


@kernel
def _bound_joint(dt, world, agent, unit, lane, rows):
    """Propagate both bounds to the next unit."""
    state, fleet = world.state, world.fleet
    present = unit <= fleet.num_trailers[agent, lane]
    heading = state.heading[agent, unit, lane]
    least, greatest = rows[LEAST_HEADING, lane], rows[GREATEST_HEADING, lane]
    step = dt * fleet.limit[agent, SPEED, lane]
    length = fleet.length[agent, unit, lane] if present else 1.0
    offset = abs(hitch_offset(fleet.joints, agent, unit - 1, lane)) if present else 0.0
    # a step longer than a trailer may turn it beyond the heading ahead; off-axle hitches swing out
    swings = (offset > 0.0) | (step > length)
    least = min(least, -math.inf if swings else heading)
    rows[LEAST_HEADING, lane] = least if present else rows[LEAST_HEADING, lane]
    greatest = max(greatest, heading)
    rows[GREATEST_HEADING, lane] = greatest if present else rows[GREATEST_HEADING, lane]

    cosine, sine = into_frame(
        state.cosine[agent, unit, lane],
        state.sine[agent, unit, lane],
        state.cosine[agent, unit - 1, lane],
        state.sine[agent, unit - 1, lane],
    )
    curvature = rows[PATH_CURVATURE, lane]
    bent = max(abs(sine), (length + offset) * curvature)
    straight = math.sqrt(max(1.0 - bent * bent, 0.0))
    least_cosine = max(rows[COSINE_LIMIT, lane], curvature * step)
    held = (straight - offset * curvature > least_cosine) & (cosine > 0.0) & (step <= length)
    rows[IN_DOUBT, lane] = 1.0 if present and not held else rows[IN_DOUBT, lane]
    swing = offset * curvature
    tangent = (bent + swing) / max(straight - swing, _TINY)
    carried = (tangent + curvature * step) / length
    rows[PATH_CURVATURE, lane] = carried if present else curvature


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
        bound_backup(dt, world, agent, rows)
        if rows[IN_DOUBT, 0] == 0.0:
            return True
        drive_on_trial(vehicle, dt, world, agent, speed, steering)
    return False
