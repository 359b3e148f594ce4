"""This module decides each step of a HAV under Reserve among others: a state machine.

The row ``MODE`` of its memory holds the state, which others hear.

``STANDING``: The HAV has reserved nothing and does not move. Others keep clear of its chain.
    It tries to begin every ``TRY_PERIOD`` steps. A reserved path or circle leads to ``RESERVED``.
``RESERVED``: The HAV has reserved an outline and moves only within that.
    A step that hits the goal leads to ``ARRIVED``. A HAV that is blocked for too long gives up its
    outline, which leads to ``STANDING``.
``ARRIVED``: The HAV stops at its goal, within its outline.
    If it has to decide again, it has a new goal, or it missed this one. Both lead to ``STANDING``.

A new goal leads from every state to ``STANDING``. Within ``RESERVED`` a HAV follows one of these:

*Part*: a part of its path, to the goal or to a random place, with a circle behind it.
    Before its end the HAV reserves the next part, or the rest. If it cannot, it looks for another
    path (a part or the rest). After ``policy.wait`` blocked steps it enters the circle.
*Rest*: the rest of its path, to the stop at the goal. It reserves that anew from time to time.
*Circle*: the circle, two turns at a time. Every ``PLAN_PERIOD`` steps it looks for a path.

If the outline overlaps that of a newcomer, the HAV clears the flag ``HELD``. It then stops until it
has reserved another outline, or gives up. docs/safety.md draws all of this.
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import states
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
    SURELY,
    hits_goal,
    is_due,
    sense_itself,
    sense_joints,
    sensed_goal,
)
from baselines.policies.reserve.prediction.holding_circle import extend_circle
from baselines.policies.reserve.prediction.motion import (
    command,
    follow,
    path_heading,
)
from baselines.policies.reserve.prediction.next_step import next_step_keeps_clear
from baselines.policies.reserve.replanning import (
    CONTINUE_MARGIN,
    PLAN_PERIOD,
    TRY_PERIOD,
    find_way_out,
    plan_path,
    try_to_begin,
)
from baselines.policies.reserve.reservation import PATH_ROUNDING, reserve_rest
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import sincos

_LEAD = 1.0  # [m] before the end of the reserved part, from where the HAV reserves the next one
_RENEW_PERIOD = 3  # steps from one attempt to do so to the next, for a HAV that is blocked
_NEXT_MARGIN_SHARE = 0.3  # of the plan's margin: kept by the next part of a path
_RECHECK_MARGIN_SHARE = 0.5  # of that: kept by the path ahead, so that it is not given up too soon
_NO_HORIZON = -1.0  # [m] no outline of others counts on the path ahead, only HAVs that stand
_ANYWHERE = 1e9  # [m] radius that holds everybody
_CORNER_FACTOR = 1.01  # above 1 / cos(pi / 24), the distance of a corner over the content's
_CIRCLE_REACH = 4.0  # radii of the nose's circle: the shift, its diameter, and one more for margins
_OUTLINE_SLACK = 1.0  # [m] by which an outline may be wider than its content: margins and sag
_POSSIBLY = 1.0 + 1e-9  # of the tolerances of a goal: what is outside is not hit, despite rounding


@rare_kernel
def act_among_others(policy, rows, memory, world, agent, lane):
    """Return speed [m/s] and steering [rad] of the next step."""
    if sense_itself(policy, rows, world, agent, lane):
        _undo_step(rows)
    # the simulator asks only HAVs that have not arrived
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
    # a HAV that begins has just compared its outline with those of everybody in range
    if changed or (stood and rows[m.HELD] > 0.0):
        remember_neighborhood(policy, rows, memory, world, agent, lane)
    return command(policy, rows, turn, distance)


@kernel
def _undo_step(rows):
    """Undo the step that was decided last: the HAV has stood instead."""
    moved = False
    for row in range(4):
        moved = moved | (rows[m.FRAME_AFTER + row] != rows[m.FRAME_BEFORE + row])
        rows[m.FRAME_AFTER + row] = rows[m.FRAME_BEFORE + row]
    if moved:
        rows[m.DRIVEN] -= rows[m.OWN_STEP]


@kernel
def _gathering_radius(policy, rows):
    """Return the radius [m] in which others matter in this step, 0.0 if there is no decision."""
    if not policy.broadcast:
        return _ANYWHERE
    if rows[m.MODE] == states.STANDING:
        return _ANYWHERE if rows[m.TRIES] == 0.0 or is_due(rows, TRY_PERIOD) else 0.0
    rest = rows[m.PART_END] - rows[m.DRIVEN]
    reach = _CORNER_FACTOR * rows[m.OWN_REACH] + _OUTLINE_SLACK
    if not _may_step(rows):
        return _ANYWHERE
    if _wants_other_path(rows):
        return _ANYWHERE
    if rows[m.CIRCLE_SIDE] == 0.0:
        return _CORNER_FACTOR * rest + reach if rows[m.DRIVEN] >= rows[m.REFRESH] else 0.0
    far = _CORNER_FACTOR * (policy.part + _CIRCLE_REACH * rows[m.OWN_FRONT_RADIUS]) + reach
    return far if rest <= _lead_distance(policy, rows) else 0.0


@kernel
def _wants_other_path(rows):
    """Tell whether it is time to look for a path that is better than a circle or a blocked one."""
    return (rows[m.PURPOSE] == states.CIRCLE_PATH or rows[m.DOOMED] > 0.0) and is_due(
        rows, PLAN_PERIOD
    )


@kernel
def _lead_distance(policy, rows):
    """Return the distance [m] before the end of the reserved part to reserve the next one from."""
    return _LEAD + (policy.turns - 1) * rows[m.OWN_STEP]


@rare_kernel
def decide(policy, rows, changed):
    """Decide on the next step.

    Args:
        policy: The Reserve.
        rows: The HAV's memory, with what it senses in this step.
        changed: Whether the near neighbours, or their states, differ from those remembered.

    Returns:
        The turn [rad] and the distance [m] of the step.
    """
    for row in range(4):
        rows[m.FRAME_BEFORE + row] = rows[m.FRAME_AFTER + row]
    if rows[m.MODE] == states.STANDING:
        rows[m.OUTLINE_RADIUS] = 0.0
        if hits_goal(policy, *sensed_goal(rows), SURELY):
            return 0.0, 0.0
        if rows[m.TRIES] == 0.0 or is_due(rows, TRY_PERIOD):
            try_to_begin(policy, rows)
        if rows[m.MODE] == states.STANDING:
            return 0.0, 0.0
    elif changed:
        _recheck_reservation(policy, rows)
    _renew_reservation(policy, rows)
    if not _may_step(rows):
        find_way_out(policy, rows)
    elif _wants_other_path(rows):
        plan_path(policy, rows, policy.margin)
    if rows[m.MODE] == states.STANDING:
        return 0.0, 0.0
    rows[m.STAMP] = rows[m.OWN_RANDOM_KEY + 2] + 1.0
    if not _may_step(rows) or not (policy.broadcast or next_step_keeps_clear(rows)):
        rows[m.BLOCKED] += 1.0
        return 0.0, 0.0
    rows[m.BLOCKED] = 0.0
    return _move(policy, rows)


@kernel
def _start_on_goal(rows):
    """Stand, and forget what belongs to the goal before."""
    rows[m.PLANNED_GOALS_LEFT] = rows[m.OWN_GOALS_LEFT]
    rows[m.MODE], rows[m.PURPOSE] = states.STANDING, states.GOAL_PATH
    rows[m.CURRENT_PATH + m.NUM_SEGMENTS] = 0.0
    rows[m.BLOCKED], rows[m.FAILED], rows[m.TRIES], rows[m.HELD] = 0.0, 0.0, 0.0, 0.0
    rows[m.ADOPTED], rows[m.EXPLORED] = 0.0, 0.0
    if rows[m.PREFERRED_SIDE] == 0.0:
        rows[m.PREFERRED_SIDE] = 1.0


@rare_kernel
def _recheck_reservation(policy, rows):
    """Compare the outline with those of newcomers, and the path ahead with HAVs that stand.

    If an outline overlaps, reserve the next part anew. The outline is not held if that fails.
    """
    x, y = rows[m.FRAME_AFTER], rows[m.FRAME_AFTER + 1]
    extent = math.sqrt(x * x + y * y)
    disjoint = rows[m.NEWCOMERS] == 0.0 or extent + rows[m.OUTLINE_RADIUS] <= rows[m.COVERED_RADIUS]
    for number in range(int(rows[m.NUM_SLOTS])):
        slot = slot_at(number)
        known = policy.broadcast and was_near(rows, rows[slot + m.SLOT_NUMBER])
        if not known and reserved_gap(rows, slot) <= 0.0:
            disjoint = False
    path, driven = m.CURRENT_PATH, rows[m.DRIVEN]
    if not disjoint:
        heading = path_heading(rows)
        purpose, margin = rows[m.PURPOSE], CONTINUE_MARGIN
        if not reserve_next(policy, rows, path, driven, heading, purpose, margin):
            rows[m.HELD] = 0.0
    if rows[m.PURPOSE] != states.CIRCLE_PATH and rows[m.CIRCLE_SIDE] != 0.0:
        margin = _RECHECK_MARGIN_SHARE * _NEXT_MARGIN_SHARE * rows[m.PLANNED_MARGIN]
        purpose = rows[m.PURPOSE]
        passes = is_drivable(policy, rows, path, driven, purpose, _NO_HORIZON, margin)
        rows[m.DOOMED] = 0.0 if passes else 1.0


@rare_kernel
def _renew_reservation(policy, rows):
    """Reserve the next part of the path near the end of the reserved one.

    On the rest to a goal, reserve what is left of it from time to time, to make room for others. On
    a circle, extend the reserved part by the next turns.
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
    if at_end and rows[m.BLOCKED] > 0.0 and not is_due(rows, _RENEW_PERIOD):
        return
    if rows[m.PURPOSE] == states.CIRCLE_PATH:
        if rows[m.GATHERED] > 0.0 and rows[m.HELD] > 0.0:
            extend_circle(rows, m.CURRENT_PATH, driven, heading, 0.0)
        return
    if rows[m.GATHERED] > 0.0:
        margin = CONTINUE_MARGIN if at_end else _NEXT_MARGIN_SHARE * rows[m.PLANNED_MARGIN]
        reserve_next(policy, rows, m.CURRENT_PATH, driven, heading, rows[m.PURPOSE], margin)


@kernel
def _may_step(rows):
    """Tell whether the next step is within what is reserved."""
    step = rows[m.OWN_STEP]
    return (
        (rows[m.HELD] > 0.0)
        & (rows[m.CURRENT_PATH + m.NUM_SEGMENTS] > 0.0)
        & (rows[m.DRIVEN] + step <= rows[m.PART_END] + PATH_ROUNDING)
    )


@rare_kernel
def _move(policy, rows):
    """Take the next step of the path, and write where the outline's frame is after it."""
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
    if hits_goal(policy, goal_x - dx, goal_y - dy, goal_heading - turn, _POSSIBLY):
        rows[m.MODE] = states.ARRIVED  # if it has not after all, it has to decide again
    return turn, distance
