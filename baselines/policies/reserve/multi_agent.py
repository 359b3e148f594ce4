"""What a HAV under Reserve does among others, step by step.

It stands until it has reserved something, and moves only within what it has reserved. Before it
comes to the end of that it reserves the next part of its path; where that is not possible it looks
for another path, and in the end goes round the circle that it has reserved until there is one.
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes, states
from baselines.policies.reserve.path_search import (
    is_drivable,
    reserve_next,
)
from baselines.policies.reserve.perception.gathering import gather
from baselines.policies.reserve.perception.other_agents import (
    has_neighborhood_changed,
    remember_neighborhood,
    reserved_gap,
    slot_at,
    was_near,
)
from baselines.policies.reserve.perception.own_state import (
    is_due,
    sag,
    sense_itself,
    sense_joints,
    sensed_goal,
    stride,
)
from baselines.policies.reserve.prediction.chain import keeps_clear_of, place_axles
from baselines.policies.reserve.prediction.holding_circle import extend_circle
from baselines.policies.reserve.prediction.motion import (
    advance_chain,
    command,
    follow,
    path_heading,
    sense_chain,
)
from baselines.policies.reserve.replanning import (
    CONTINUE_MARGIN,
    find_way_out,
    plan_path,
    try_to_begin,
)
from baselines.policies.reserve.reservation import ROUNDING, reserve_rest
from baselines.policies.reserve.single_agent import SURELY, hits_goal
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import sincos

_SAGS = 6.0  # that rolling wheels may be away from the simulator's next places, as measured
_LEAD = 1.0  # [m] before the end of what is reserved, where the next part is asked for
_RENEW = 0.3  # of the margin of the plan is the margin of a next part
_ANYWHERE = 1e9  # [m]
_WIDER = 1.01  # an outline's corners are at most 1 / cos(pi / 24) times as far as its contents
_AT_MOST = 1.0 + 1e-9  # of the tolerances of a goal: what is outside is not hit


@rare_kernel
def act_among_others(policy, rows, memory, world, agent, lane):
    """Return speed [m/s] and steering [rad]."""
    if sense_itself(policy, rows, world, agent, lane):
        _undo_step(rows)
    # who is asked has not arrived
    if rows[m.PLANNED_GOALS_LEFT] != rows[m.OWN_GOALS_LEFT] or rows[m.MODE] == states.ARRIVED:
        _start_on_goal(rows)
    changed = rows[m.MODE] == states.RESERVED and has_neighborhood_changed(
        policy, rows, memory, world, agent, lane
    )
    radius = _ANYWHERE if changed else _gathering_radius(policy, rows)
    rows[m.GATHERED] = 0.0
    if radius > 0.0:
        sense_joints(rows, world, agent, lane)
        gather(policy, rows, memory, world, agent, lane, radius)
        rows[m.GATHERED] = 1.0
    stood = rows[m.MODE] == states.STANDING
    turn, distance = decide(policy, rows, changed)
    # who begins has just looked at everybody in range: only they are no newcomers later
    if changed or (stood and rows[m.HELD] > 0.0):
        remember_neighborhood(policy, rows, memory, world, agent, lane)
    return command(policy, rows, turn, distance)


@kernel
def _undo_step(rows):
    """Forget the step before if it was decided: the HAV has stood instead."""
    moved = False
    for row in range(4):
        moved = moved | (rows[m.FRAME_AFTER + row] != rows[m.FRAME_BEFORE + row])
        rows[m.FRAME_AFTER + row] = rows[m.FRAME_BEFORE + row]
    if moved:
        rows[m.DRIVEN] -= rows[m.OWN_STEP]


@kernel
def _gathering_radius(policy, rows):
    """Return how far round [m] others matter in this step, 0.0 when nothing is to be decided."""
    if not policy.broadcast:
        return _ANYWHERE
    if rows[m.MODE] == states.STANDING:
        return _ANYWHERE if rows[m.TRIES] == 0.0 or is_due(rows, 5) else 0.0
    rest = rows[m.PART_END] - rows[m.DRIVEN]
    reach = _WIDER * rows[m.OWN_REACH] + 1.0  # outlines are wider than what they hold
    if not _may_step(rows):
        return _ANYWHERE
    if (rows[m.PURPOSE] == states.CIRCLE_PATH or rows[m.DOOMED] > 0.0) and is_due(rows, 15):
        return _ANYWHERE
    if rows[m.CIRCLE_SIDE] == 0.0:
        return _WIDER * rest + reach if rows[m.DRIVEN] >= rows[m.REFRESH] else 0.0
    far = _WIDER * (policy.part + 4.0 * rows[m.OWN_FRONT_RADIUS]) + reach
    return far if rest <= _lead_distance(policy, rows) else 0.0


@kernel
def _lead_distance(policy, rows):
    """Return how long before the end of what is reserved the next part is asked for [m]."""
    return _LEAD + (policy.turns - 1) * rows[m.OWN_STEP]


@rare_kernel
def decide(policy, rows, changed):
    """Decide on the next step; return its turn [rad] and its distance [m].

    Args:
        changed: whether other HAVs are in sensing range, or stand, than in the step before.
    """
    for row in range(4):
        rows[m.FRAME_BEFORE + row] = rows[m.FRAME_AFTER + row]
    if rows[m.MODE] == states.STANDING:
        rows[m.OUTLINE_RADIUS] = 0.0
        if hits_goal(policy, *sensed_goal(rows), SURELY):
            return 0.0, 0.0
        if rows[m.TRIES] == 0.0 or is_due(rows, 5):
            try_to_begin(policy, rows)
        if rows[m.MODE] == states.STANDING:
            return 0.0, 0.0
    elif changed:
        _recheck_reservation(policy, rows)
    _renew_reservation(policy, rows)
    if not _may_step(rows):
        find_way_out(policy, rows)
    elif (rows[m.PURPOSE] == states.CIRCLE_PATH or rows[m.DOOMED] > 0.0) and is_due(rows, 15):
        plan_path(policy, rows, policy.margin)
    if rows[m.MODE] == states.STANDING:
        return 0.0, 0.0
    rows[m.STAMP] = rows[m.OWN_RANDOM_KEY + 2] + 1.0
    if not _may_step(rows) or not (policy.broadcast or _step_stays_clear(rows)):
        rows[m.BLOCKED] += 1.0
        return 0.0, 0.0
    rows[m.BLOCKED] = 0.0
    return _move(policy, rows)


@kernel
def _start_on_goal(rows):
    rows[m.PLANNED_GOALS_LEFT] = rows[m.OWN_GOALS_LEFT]
    rows[m.MODE], rows[m.CURRENT_PATH + m.NUM_SEGMENTS], rows[m.PURPOSE] = (
        states.STANDING,
        0.0,
        states.GOAL_PATH,
    )
    rows[m.BLOCKED], rows[m.FAILED], rows[m.TRIES], rows[m.HELD] = 0.0, 0.0, 0.0, 0.0
    rows[m.ADOPTED], rows[m.EXPLORED] = 0.0, 0.0
    if rows[m.PREFERRED_SIDE] == 0.0:
        rows[m.PREFERRED_SIDE] = 1.0


@rare_kernel
def _recheck_reservation(policy, rows):
    """Compare what is reserved with those who came near: it is held only if they agree."""
    extent = math.sqrt(
        rows[m.FRAME_AFTER] * rows[m.FRAME_AFTER]
        + rows[m.FRAME_AFTER + 1] * rows[m.FRAME_AFTER + 1]
    )
    agree = rows[m.NEWCOMERS] == 0.0 or extent + rows[m.OUTLINE_RADIUS] <= rows[m.COVERED_RADIUS]
    for number in range(int(rows[m.NUM_SLOTS])):
        slot = slot_at(number)
        known = policy.broadcast and was_near(rows, rows[slot + m.SLOT_NUMBER])
        if not known and reserved_gap(rows, slot) <= 0.0:
            agree = False
    if not agree:
        heading = path_heading(rows)
        if not reserve_next(
            policy, rows, m.CURRENT_PATH, rows[m.DRIVEN], heading, rows[m.PURPOSE], CONTINUE_MARGIN
        ):
            rows[m.HELD] = 0.0
    if rows[m.PURPOSE] != states.CIRCLE_PATH and rows[m.CIRCLE_SIDE] != 0.0:
        margin = 0.5 * _RENEW * rows[m.PLANNED_MARGIN]
        passes = is_drivable(
            policy, rows, m.CURRENT_PATH, rows[m.DRIVEN], rows[m.PURPOSE], -1.0, margin
        )
        rows[m.DOOMED] = 0.0 if passes else 1.0


@rare_kernel
def _renew_reservation(policy, rows):
    """Reserve the next part of the path when the end of what is reserved comes near.

    On the rest to a goal, reserve what is left of it from time to time, to give way. On a circle
    with somebody inside, look at the next rounds.
    """
    driven, end = rows[m.DRIVEN], rows[m.PART_END]
    if rows[m.CURRENT_PATH + m.NUM_SEGMENTS] == 0.0:
        return
    heading = path_heading(rows)
    if rows[m.CIRCLE_SIDE] == 0.0 and rows[m.HELD] > 0.0:
        if driven >= rows[m.REFRESH]:
            rows[m.REFRESH] = driven + policy.refresh
            if rows[m.GATHERED] > 0.0:
                reserve_rest(policy, rows, m.CURRENT_PATH, driven, heading, CONTINUE_MARGIN)
        return
    step = rows[m.OWN_STEP]
    at_end = end - driven < step
    if end - driven > _lead_distance(policy, rows):
        return
    if at_end and rows[m.BLOCKED] > 0.0 and not is_due(rows, 3):
        return
    if rows[m.PURPOSE] == states.CIRCLE_PATH:
        if rows[m.GATHERED] > 0.0 and rows[m.HELD] > 0.0:
            extend_circle(rows, m.CURRENT_PATH, driven, heading, 0.0)
        return
    if rows[m.GATHERED] > 0.0:
        margin = CONTINUE_MARGIN if at_end else _RENEW * rows[m.PLANNED_MARGIN]
        reserve_next(policy, rows, m.CURRENT_PATH, driven, heading, rows[m.PURPOSE], margin)


@kernel
def _may_step(rows):
    """Tell whether the next step is within what is reserved."""
    step = rows[m.OWN_STEP]
    return (
        (rows[m.HELD] > 0.0)
        & (rows[m.CURRENT_PATH + m.NUM_SEGMENTS] > 0.0)
        & (rows[m.DRIVEN] + step <= rows[m.PART_END] + ROUNDING)
    )


@rare_kernel
def _step_stays_clear(rows):
    """Tell whether the HAV is still clear of all others after its next step, if they take one too.

    That is all that it can see to when nobody tells what is reserved.
    """
    turn, distance = follow(rows)
    sense_chain(rows)
    x, y, _ = advance_chain(rows, 0.0, 0.0, turn, distance)
    place_axles(rows, x, y)
    # of those in no slot it is known only that their units are at least half as long as a step
    step, steepest = rows[m.OWN_STEP], rows[m.OWN_STEERING_TANGENT]
    most = stride(step, steepest, 0.5 * step, sizes.MAX_TRAILERS)
    most += 2.0 * _SAGS * sag(step, steepest, 0.5 * step)
    if rows[m.OWN_REACH] + rows[m.OWN_STRIDE] + most > rows[m.COVERED_RADIUS]:
        return False
    for number in range(int(rows[m.NUM_SLOTS])):
        slot = slot_at(number)
        # before the end of the step, what is left of one stride and what is done of the other
        # are together no longer than the longer one
        margin = max(rows[m.OWN_STRIDE], rows[slot + m.SLOT_STRIDE])
        margin += _SAGS * (rows[m.OWN_SAG] + rows[slot + m.SLOT_SAG])
        if not keeps_clear_of(rows, slot, margin):
            return False
    return True


@rare_kernel
def _move(policy, rows):
    """Take the next step of the path, and tell the others where the outline's frame is then."""
    turn, distance = follow(rows)
    rows[m.DRIVEN] += distance
    sine, cosine = sincos(turn)
    dx, dy = distance * cosine, distance * sine
    x, y = rows[m.FRAME_AFTER] - dx, rows[m.FRAME_AFTER + 1] - dy
    rows[m.FRAME_AFTER], rows[m.FRAME_AFTER + 1] = x * cosine + y * sine, y * cosine - x * sine
    along, left = rows[m.FRAME_AFTER + 2], rows[m.FRAME_AFTER + 3]
    rows[m.FRAME_AFTER + 2], rows[m.FRAME_AFTER + 3] = (
        along * cosine + left * sine,
        left * cosine - along * sine,
    )
    goal_x, goal_y, goal_heading = sensed_goal(rows)
    if hits_goal(policy, goal_x - dx, goal_y - dy, goal_heading - turn, _AT_MOST):
        rows[m.MODE] = states.ARRIVED  # if it has not after all, it will be asked, and begins anew
    return turn, distance
