"""This module predicts in coarse steps whether a HAV can drive along a path, past all others.

Up to the horizon, the HAV must have a free circle at every step, past the outlines of others.
Beyond the horizon only HAVs that stand count, because the others will have moved.
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import states
from baselines.policies.reserve.perception.other_agents import (
    gap_to,
    keeps_margin,
    slot_at,
    squared_distance,
)
from baselines.policies.reserve.prediction.chain import (
    COARSE_TURN,
    include_axles,
    keeps_clear_of,
    nose_keeps_clear,
    place_axles,
    pull_axles,
)
from baselines.policies.reserve.prediction.holding_circle import SHIFTS, find_circle
from baselines.policies.reserve.prediction.motion import sense_chain
from baselines.policies.reserve.prediction.paths import total_length
from hav_env.compiled import kernel, local_array, rare_kernel
from hav_env.maths.elementary import sincos
from hav_env.maths.kdop import clear_outline

MANY_FAILURES = 20  # plans that fail, after which last resorts are tried
_PATHS_BEFORE_WHOLE_REST = 5  # to a goal, after which the whole rest to it may be reserved
_NEAR_GOAL_CIRCLES = 3.0  # radii of the endless circle, plus the truck: a rest that may be reserved
_PATH_COARSE_STEP = 2.0  # [m] of a coarse step along a path, at most
_FAR = _PATH_COARSE_STEP  # [m] beyond the margin, from where a coarse step cannot come too near
_LAGGING = 64  # coarse steps by which the trailers follow the truck late, at most
# of a coarse step of the truck: x [m], y [m], cosine, sine
_TRUCK_X, _TRUCK_Y, _TRUCK_HEADING_COSINE, _TRUCK_HEADING_SINE, _TRUCK_ROWS = range(5)
_ROUNDED = 1e-6  # [m] far more than the rounding of distances and lengths


@kernel
def rest_is_near(rows, rest):
    """Return whether a rest [m] of a path to the goal is short enough to be reserved at once.

    After many paths or failures any length is, if all others in slots have arrived.
    """
    near = _NEAR_GOAL_CIRCLES * rows[m.OWN_CIRCLE_RADIUS] + rows[m.OWN_LENGTHS]
    in_vain = (rows[m.ADOPTED] > _PATHS_BEFORE_WHOLE_REST) | (rows[m.FAILED] > MANY_FAILURES)
    return (rest <= near) | ((rows[m.NUM_UNARRIVED] == 0.0) & in_vain)


@rare_kernel
def is_drivable(policy, rows, path, done, purpose, horizon, margin):
    """Return whether the HAV can drive along a path, in coarse steps, past all others.

    The truck goes ahead, and the trailers follow it where another HAV is near: within ``extent`` of
    the truck, which no part of the chain and no circle leaves. Beyond the horizon only HAVs that
    stand count, so the chain need not follow where none of these is near.

    Args:
        policy: The Reserve.
        rows: The HAV's memory.
        path: First row of the path.
        done: Distance driven along it [m].
        purpose: Purpose of the path.
        horizon: Distance from here up to which the outlines of others count [m].
        margin: Margin to all others [m].
    """
    coarse = min(_PATH_COARSE_STEP, COARSE_TURN * rows[m.OWN_CIRCLE_RADIUS])
    rear, front = rows[m.OWN_REAR_RADIUS], rows[m.OWN_FRONT_RADIUS]
    extent = max(rows[m.OWN_REACH], rear + front) + margin + _FAR
    rest = total_length(rows, path) - done
    sense_chain(rows)
    place_axles(rows, 0.0, 0.0)
    truck, lag = local_array(1, _TRUCK_ROWS, _LAGGING)[0], 0
    x, y, heading, driven, alone_until = 0.0, 0.0, 0.0, 0.0, -1.0
    for segment in range(int(rows[path + m.NUM_SEGMENTS])):
        curvature, length = rows[path + m.CURVATURES + segment], rows[path + m.LENGTHS + segment]
        skipped = min(done, length)
        done, length = done - skipped, length - skipped
        if length <= 0.0:
            continue
        steps = math.ceil(length / coarse)
        along = length / steps
        half = 0.5 * curvature * along
        sine, cosine = sincos(half)
        chord = along if half == 0.0 else along * sine / half
        sine, cosine = sincos(heading)
        for _ in range(steps):
            if half != 0.0:
                sine, cosine = sincos(heading + half)
            x, y = x + chord * cosine, y + chord * sine
            heading, driven = heading + 2.0 * half, driven + along
            if half != 0.0:
                sine, cosine = sincos(heading)
            truck[_TRUCK_X, lag], truck[_TRUCK_Y, lag] = x, y
            truck[_TRUCK_HEADING_COSINE, lag], truck[_TRUCK_HEADING_SINE, lag] = cosine, sine
            lag += 1
            near = False
            if driven >= alone_until:
                squared = squared_distance(rows, x, y, driven > horizon)
                near = squared <= extent * extent
                # until then the truck cannot come near, because a chord is no longer than its arc
                alone_until = driven + math.sqrt(squared) - extent - _ROUNDED
                if alone_until > rest + _ROUNDED:
                    return True
            if near or lag == _LAGGING:
                nose_x, nose_y = _pull_all(rows, truck, lag)
                lag = 0
            if near and not (
                _passes_standing(rows, nose_x, nose_y, margin)
                and (
                    driven > horizon
                    or _passes_reserved(policy, rows, x, y, heading, purpose, rest - driven, margin)
                )
            ):
                return False
    return True


@kernel
def _pull_all(rows, truck, lag):
    """Pull the axles after the truck in its last steps, and return the nose before the last one."""
    nose_x, nose_y = rows[m.AXLES], rows[m.AXLES + 1]
    for step in range(lag):
        nose_x, nose_y = rows[m.AXLES], rows[m.AXLES + 1]
        pull_axles(
            rows,
            truck[_TRUCK_X, step],
            truck[_TRUCK_Y, step],
            truck[_TRUCK_HEADING_COSINE, step],
            truck[_TRUCK_HEADING_SINE, step],
        )
    return nose_x, nose_y


@rare_kernel
def _passes_standing(rows, nose_x, nose_y, margin):
    """Return whether the axles keep clear of all standing HAVs.

    Their outline is written to ``BODY_OUTLINE``.
    """
    clear_outline(rows, m.BODY_OUTLINE)
    include_axles(rows, m.BODY_OUTLINE)
    for number in range(int(rows[m.NUM_SLOTS])):
        slot = slot_at(number)
        if (
            rows[slot + m.SLOT_KIND] == states.STANDING
            and gap_to(rows, slot, m.BODY_OUTLINE, margin) <= margin + _FAR
        ):
            if not nose_keeps_clear(rows, slot, nose_x, nose_y, margin):
                return False
            if not keeps_clear_of(rows, slot, margin):
                return False
    return True


@kernel
def _passes_reserved(policy, rows, x, y, heading, purpose, rest, margin):
    """Return whether ``BODY_OUTLINE`` keeps clear of the outlines of others, and a circle is free.

    No circle is needed on a rest [m] to the goal that may be reserved.
    """
    if not keeps_margin(rows, m.BODY_OUTLINE, states.RESERVED, margin):
        return False
    if purpose == states.GOAL_PATH and rest_is_near(rows, rest):
        return True
    side, _ = find_circle(policy, rows, x, y, heading, SHIFTS, margin, False)
    return side != 0.0
