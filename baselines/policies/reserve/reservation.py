"""What a HAV reserves: an outline of all that it may occupy from now on, until it reserves anew.

It reserves the next part of its path, and either a circle to drive on for ever behind it, or the
rest of the path and the place where it stops at its goal. The part of the path is predicted step by
step as the simulation will move the HAV, and every axle of every step is in the outline. Of the
circle, the outline holds the disc that the truck's front axle drives round: an axle that is pulled
moves towards the one ahead, so nothing leaves the convex hull of chain and disc.

Reserved is what keeps a margin from everything that others have reserved, and from those who
stand; by the same prediction where their outlines are too coarse to tell.
"""

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import states
from baselines.policies.reserve.perception.other_agents import extent_of, is_covered, keeps_margin
from baselines.policies.reserve.perception.own_state import is_due, sensed_goal
from baselines.policies.reserve.prediction.chain import (
    include_axles,
    keeps_clear,
    move_axles,
    place_axles,
)
from baselines.policies.reserve.prediction.holding_circle import find_circle
from baselines.policies.reserve.prediction.motion import advance_chain, sense_chain, turn_to
from baselines.policies.reserve.prediction.paths import heading_at, total_length
from baselines.policies.reserve.single_agent import SURELY, hits_goal
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.geometry import wrap
from hav_env.maths.kdop import SIDES, clear_outline, widen

ROUNDING = 1e-6  # [m] that a path may be longer than its end says


@rare_kernel
def predict_part(policy, rows, path, driven, heading, end, stop, margin):
    """Predict the next part of a path, and write its outline into ``TRIAL_OUTLINE``.

    Args:
        path: where it stands; driven: how much of it is done [m].
        heading: of the truck less that of the path's start [rad], by whole turns.
        end: up to where [m]; stop: whether to go on to the goal instead.
        margin: to be kept from those that stand and are close [m]; negative: do not look.

    The outline is wider than the axles need by what they may leave the straight ways from step to
    step, so it holds the chain between steps too.

    Returns:
        Whether all went well, x, y [m], heading [rad] in the own frame, and driven [m].
    """
    goal_x, goal_y, goal_heading = sensed_goal(rows)
    bound = rows[m.OWN_LEAST_COSINE]
    distance = rows[m.OWN_STEP]
    total = total_length(rows, path)
    sense_chain(rows)
    place_axles(rows, 0.0, 0.0)
    clear_outline(rows, m.TRIAL_OUTLINE)
    include_axles(rows, m.TRIAL_OUTLINE)
    x, y, turned, least = 0.0, 0.0, 0.0, 1.0
    while stop or driven + distance <= end + ROUNDING:
        if driven > total:
            return False, x, y, turned, driven
        wanted = heading_at(rows, path, driven + 0.5 * distance)
        turn = turn_to(rows, wrap(wanted - heading), 0.0, distance)
        x, y, least = advance_chain(rows, x, y, turn, distance)
        heading, turned, driven = heading + turn, turned + turn, driven + distance
        if least < bound:
            return False, x, y, turned, driven
        move_axles(rows, x, y)
        include_axles(rows, m.TRIAL_OUTLINE)
        if margin >= 0.0 and not keeps_clear(rows, margin):
            return False, x, y, turned, driven
        if stop and hits_goal(policy, goal_x - x, goal_y - y, goal_heading - turned, SURELY):
            break
    widen(rows, m.TRIAL_OUTLINE, rows[m.OWN_SAG])
    return True, x, y, turned, driven


@rare_kernel
def reserve_rest(policy, rows, path, driven, heading, margin):
    """Reserve the rest of a path and the place at its goal; return whether that is possible."""
    if not is_due(rows, policy.turns):
        return False
    ok, _, _, _, end = predict_part(policy, rows, path, driven, heading, 0.0, True, -1.0)
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
    """Reserve a path up to ``end`` [m] and a circle behind it; return whether that is possible.

    Args:
        shifts: as in ``find_circle``; others: as in ``predict_part``.
    """
    if not is_due(rows, policy.turns):
        return False
    ok, x, y, turned, _ = predict_part(policy, rows, path, driven, heading, end, False, -1.0)
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
    """Broadcast ``TRIAL_OUTLINE`` as what is reserved, in the truck's frame as it is now."""
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
