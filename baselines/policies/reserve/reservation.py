"""This module reserves an outline: all points that a HAV may occupy until its next reservation.

A HAV reserves either the next part of its path and a circle behind that, or the rest of the path
and its stop at the goal. It can drive on the circle without end.

The HAV predicts the part step by step, as the simulation will move it. The outline holds every axle
of every step. Of the circle, the outline holds the disc of the truck's front axle. A pulled axle
moves towards the one ahead, so the chain stays in the convex hull of chain and disc.

An outline keeps a margin from the outlines of all others. It also keeps a margin from each standing
HAV, or else every predicted step does.
"""

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import states
from baselines.policies.reserve.perception.other_agents import extent_of, is_covered, keeps_margin
from baselines.policies.reserve.perception.own_state import (
    SURELY,
    hits_goal,
    is_due,
    sensed_goal,
)
from baselines.policies.reserve.prediction.chain import (
    include_axles,
    keeps_clear,
    move_axles,
    place_axles,
)
from baselines.policies.reserve.prediction.holding_circle import find_circle
from baselines.policies.reserve.prediction.motion import sense_chain, turn_to
from baselines.policies.reserve.prediction.paths import heading_at, total_length
from baselines.policies.reserve.prediction.stretches import (
    STRETCH,
    STRETCH_SIZE,
    add_step,
    begin_stretch,
    end_stretch,
)
from hav_env.compiled import kernel, local_array, rare_kernel
from hav_env.maths.geometry import wrap
from hav_env.maths.kdop import SIDES, clear_outline, widen

_NO_MARGIN = -1.0  # [m] standing HAVs do not count while a part is predicted
PATH_ROUNDING = 1e-6  # [m] that a step may lead beyond the end of the reserved part


@rare_kernel
def predict_part(policy, rows, path, driven, heading, end, stop, margin):
    """Predict the next part of a path, and write its outline into ``TRIAL_OUTLINE``.

    The outline is wider than the convex hull of all axles by the sag. It therefore also holds the
    chain between the steps. The predicted chain and its axles keep their state at the end.

    Args:
        policy: The Reserve.
        rows: The HAV's memory.
        path: First row of the path.
        driven: Distance driven along it [m].
        heading: Truck's heading less that of the path's start [rad], up to whole turns.
        end: Distance along the path at which the part ends [m].
        stop: Whether the part ends at the goal instead.
        margin: Margin to close standing HAVs [m]. They do not count if it is negative.

    Returns:
        Whether the part can be driven, then x [m], y [m] and heading [rad] at its end in the own
        frame, and the distance along the path there [m].
    """
    goal_x, goal_y, goal_heading = sensed_goal(rows)
    bound = rows[m.OWN_LEAST_COSINE]
    distance = rows[m.OWN_STEP]
    total = total_length(rows, path)
    sense_chain(rows)
    place_axles(rows, 0.0, 0.0)
    clear_outline(rows, m.TRIAL_OUTLINE)
    include_axles(rows, m.TRIAL_OUTLINE)
    chains = local_array(1, 1, STRETCH_SIZE)[0, 0]
    x, y, turned, least = 0.0, 0.0, 0.0, 1.0
    # close HAVs are compared with each step before the next one
    most, goes_on = 1 if margin >= 0.0 else STRETCH, True
    while goes_on:
        begin_stretch(rows, chains)
        count = 0
        while count < most and goes_on:
            goes_on = stop or driven + distance <= end + PATH_ROUNDING
            if not goes_on:
                break
            if driven > total:
                return False, x, y, turned, driven
            wanted = heading_at(rows, path, driven + 0.5 * distance)
            turn = turn_to(rows, wrap(wanted - heading), 0.0, distance)
            x, y, least = add_step(rows, chains, count, x, y, turn, distance)
            heading, turned, driven = heading + turn, turned + turn, driven + distance
            if least < bound:
                return False, x, y, turned, driven
            count += 1
            goes_on = not stop or not hits_goal(
                policy, goal_x - x, goal_y - y, goal_heading - turned, SURELY
            )
        end_stretch(rows, chains, count, m.TRIAL_OUTLINE)
        if margin >= 0.0 and count > 0:
            move_axles(rows, x, y)
            if not keeps_clear(rows, margin):
                return False, x, y, turned, driven
    place_axles(rows, x, y)
    widen(rows, m.TRIAL_OUTLINE, rows[m.OWN_SAG])
    return True, x, y, turned, driven


@rare_kernel
def reserve_rest(policy, rows, path, driven, heading, margin):
    """Reserve the rest of a path to its goal, where the HAV stops.

    Args:
        policy: The Reserve.
        rows: The HAV's memory.
        path: First row of the path.
        driven: Distance driven along it [m].
        heading: Truck's heading less that of the path's start [rad], up to whole turns.
        margin: Margin to all others [m].

    Returns:
        Whether that is possible.
    """
    if not is_due(rows, policy.turns):
        return False
    ok, _, _, _, end = predict_part(policy, rows, path, driven, heading, 0.0, True, _NO_MARGIN)
    if not (
        ok
        and is_covered(rows, m.TRIAL_OUTLINE, margin)
        and keeps_margin(rows, m.TRIAL_OUTLINE, states.RESERVED, margin)
    ):
        return False
    if not keeps_margin(rows, m.TRIAL_OUTLINE, states.STANDING, margin):
        ok, _, _, _, end = predict_part(policy, rows, path, driven, heading, 0.0, True, margin)
        if not ok:
            return False
    _commit(rows, end, 0.0, 0.0)
    return True


@rare_kernel
def reserve_circle(policy, rows, path, driven, heading, end, shifts, margin):
    """Reserve a path up to ``end`` and a circle behind it.

    Args:
        policy: The Reserve.
        rows: The HAV's memory.
        path: First row of the path.
        driven: Distance driven along it [m].
        heading: Truck's heading less that of the path's start [rad], up to whole turns.
        end: Distance along the path at which the part ends [m].
        shifts: Number of straight distances before the circle to try, as in ``find_circle``.
        margin: Margin to all others [m].

    Returns:
        Whether that is possible.
    """
    if not is_due(rows, policy.turns):
        return False
    ok, x, y, turned, _ = predict_part(policy, rows, path, driven, heading, end, False, _NO_MARGIN)
    if not ok or not keeps_margin(rows, m.TRIAL_OUTLINE, states.RESERVED, margin):
        return False
    for side in range(SIDES):
        rows[m.BODY_OUTLINE + side] = rows[m.TRIAL_OUTLINE + side]
    if not keeps_margin(rows, m.BODY_OUTLINE, states.STANDING, margin):
        ok, x, y, turned, _ = predict_part(policy, rows, path, driven, heading, end, False, margin)
        if not ok:
            return False
    side, shift = find_circle(policy, rows, x, y, turned, shifts, margin, True)
    if side == 0.0:
        return False
    _commit(rows, end, side, shift)
    return True


@kernel
def _commit(rows, end, side, shift):
    """Reserve and broadcast ``TRIAL_OUTLINE``, in the truck's frame as it is now."""
    for number in range(SIDES):
        rows[m.OUTLINE + number] = rows[m.TRIAL_OUTLINE + number]
    rows[m.OUTLINE_RADIUS], rows[m.MODE] = extent_of(rows, m.OUTLINE), states.RESERVED
    (
        rows[m.FRAME_BEFORE],
        rows[m.FRAME_BEFORE + 1],
        rows[m.FRAME_BEFORE + 2],
        rows[m.FRAME_BEFORE + 3],
    ) = 0.0, 0.0, 1.0, 0.0
    (
        rows[m.FRAME_AFTER],
        rows[m.FRAME_AFTER + 1],
        rows[m.FRAME_AFTER + 2],
        rows[m.FRAME_AFTER + 3],
    ) = 0.0, 0.0, 1.0, 0.0
    rows[m.PART_END], rows[m.CIRCLE_SIDE], rows[m.CIRCLE_SHIFT], rows[m.HELD] = (
        end,
        side,
        shift,
        1.0,
    )
    if side != 0.0:
        rows[m.PREFERRED_SIDE] = side
