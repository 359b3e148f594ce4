"""This module decides each step of a HAV under Reserve among others: a state machine.

The row ``MODE`` of its memory holds the state, which it broadcasts.

``STANDING``: The HAV has reserved nothing and does not move. Others keep clear of its chain.
    It tries to begin every ``TRY_PERIOD`` steps. A reserved path or circle leads to ``RESERVED``.
``RESERVED``: The HAV has reserved an outline and moves only within that.
    A step that hits the goal leads to ``ARRIVED``. A HAV that is blocked for too long gives up its
    outline, which leads to ``STANDING``.
``ARRIVED``: The HAV stops at its goal, within its outline.
    If it has to decide again, it has a new goal, or it missed this one. Both lead to ``STANDING``.

A new goal leads from every state to ``STANDING``. Within ``RESERVED`` a HAV follows one of these:

*Part*: a part of its path, to the goal or to a random position, with a circle behind it.
    Before its end the HAV looks for a shorter path, and reserves the next part, or the rest. If it
    cannot, it looks for another path (a part or the rest). After ``policy.wait`` blocked steps it
    enters the circle.
*Rest*: the rest of its path, to the stop at the goal. It reserves that anew from time to time.
*Circle*: the circle, two turns at a time. Every ``PLAN_PERIOD`` steps it looks for a path.

If the outline overlaps that of a newcomer, the HAV clears the flag ``HELD``. It then stops until it
has reserved another outline, or gives up. docs/safety.md draws all of this.
"""

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import states
from baselines.policies.reserve.perception.gathering import gather
from baselines.policies.reserve.perception.other_agents import (
    has_neighborhood_changed,
    remember_neighborhood,
)
from baselines.policies.reserve.perception.own_state import (
    SURELY,
    hits_goal,
    is_due,
    sense_itself,
    sense_joints,
    sensed_goal,
)
from baselines.policies.reserve.prediction.motion import command, follow
from baselines.policies.reserve.prediction.next_step import next_step_keeps_clear
from baselines.policies.reserve.renewal import recheck_reservation, renew_reservation
from baselines.policies.reserve.replanning import (
    PLAN_PERIOD,
    TRY_PERIOD,
    find_way_out,
    lead_distance,
    may_find_shortcut,
    plan_path,
    try_to_begin,
)
from baselines.policies.reserve.reservation import PATH_ROUNDING
from baselines.policies.reserve.tight_paths import measure_arcs
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import sincos

ANYWHERE = 1e9  # [m] radius that contains all HAVs
_CORNER_FACTOR = 1.01  # above 1 / cos(pi / 24), the distance of a corner over the content's
_CIRCLE_REACH = 4.0  # radii of the nose's circle: the shift, its diameter, and one more for margins
_OUTLINE_SLACK = 1.0  # [m] by which an outline may be wider than its content: margins and sag
_POSSIBLY = (
    1.0 + 1e-9
)  # share of a goal's tolerances: poses outside do not hit it, despite rounding


@kernel
def act_among_others(policy, rows, memory, world, agent, lane):
    """Return speed [m/s] and steering [rad] of the next step.

    It is inlined, because a call copies hundreds of numbers that describe the arrays of a world,
    and most steps do little else.
    """
    changed = notice(policy, rows, memory, world, agent, lane)
    return drive_on(policy, rows, memory, world, agent, lane, changed)


@kernel
def notice(policy, rows, memory, world, agent, lane):
    """Update what the HAV knows of itself, and return whether its near neighbours have changed."""
    if sense_itself(policy, rows, world, agent, lane):
        _undo_step(rows)
    # the simulator calls the policy only for HAVs that have not arrived
    if rows[m.PLANNED_GOALS_LEFT] != rows[m.OWN_GOALS_LEFT] or rows[m.MODE] == states.ARRIVED:
        _start_on_goal(rows)
    return rows[m.MODE] == states.RESERVED and has_neighborhood_changed(
        policy, rows, memory, world, agent, lane
    )


@kernel
def look_around(policy, rows, memory, world, agent, lane, radius):
    """Write the others that matter within a radius [m] into slots, none if it is 0.0."""
    rows[m.GATHERED] = 0.0
    if radius > 0.0:
        sense_joints(rows, world, agent, lane)
        if rows[m.OWN_TIGHT] > 0.0 and rows[m.LAST_TURNS] == 0.0:
            measure_arcs(rows)
        gather(policy, rows, memory, world, agent, lane, radius)
        rows[m.GATHERED] = 1.0


@kernel
def drive_on(policy, rows, memory, world, agent, lane, changed):
    """Decide on the next step, and return its speed [m/s] and steering [rad]."""
    radius = ANYWHERE if changed else _gathering_radius(policy, rows)
    look_around(policy, rows, memory, world, agent, lane, radius)
    stood = rows[m.MODE] == states.STANDING
    turn, distance = decide(policy, rows, changed)
    # a HAV that begins has just compared its outline with those of all HAVs in range
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
        return ANYWHERE
    if rows[m.MODE] == states.STANDING:
        return ANYWHERE if rows[m.TRIES] == 0.0 or is_due(rows, TRY_PERIOD) else 0.0
    rest = rows[m.PART_END] - rows[m.DRIVEN]
    reach = _CORNER_FACTOR * rows[m.OWN_REACH] + _OUTLINE_SLACK
    if not _may_step(rows):
        return ANYWHERE
    if _wants_other_path(rows) or may_find_shortcut(policy, rows):
        return ANYWHERE
    if rows[m.CIRCLE_SIDE] == 0.0:
        return _CORNER_FACTOR * rest + reach if rows[m.DRIVEN] >= rows[m.REFRESH] else 0.0
    far = circle_reach(rows, policy.part)
    return far if rest <= lead_distance(policy, rows) else 0.0


@kernel
def circle_reach(rows, part):
    """Return the radius [m] that holds the outline of a part [m] of a path and a circle behind."""
    reach = _CORNER_FACTOR * rows[m.OWN_REACH] + _OUTLINE_SLACK
    return _CORNER_FACTOR * (part + _CIRCLE_REACH * rows[m.OWN_FRONT_RADIUS]) + reach


@kernel
def _wants_other_path(rows):
    """Return whether to look for a path that is better than a circle or a blocked path."""
    return (rows[m.PURPOSE] == states.CIRCLE_PATH or rows[m.DOOMED] > 0.0) and is_due(
        rows, PLAN_PERIOD
    )


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
        recheck_reservation(policy, rows)
    renew_reservation(policy, rows)
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
    return move_along(policy, rows)


@kernel
def _start_on_goal(rows):
    """Stand, and clear the state of the previous goal."""
    rows[m.PLANNED_GOALS_LEFT] = rows[m.OWN_GOALS_LEFT]
    rows[m.MODE], rows[m.PURPOSE] = states.STANDING, states.GOAL_PATH
    rows[m.CURRENT_PATH + m.NUM_SEGMENTS] = 0.0
    rows[m.BLOCKED], rows[m.FAILED], rows[m.TRIES], rows[m.HELD] = 0.0, 0.0, 0.0, 0.0
    rows[m.ADOPTED], rows[m.EXPLORED] = 0.0, 0.0
    if rows[m.PREFERRED_SIDE] == 0.0:
        rows[m.PREFERRED_SIDE] = 1.0


@kernel
def _may_step(rows):
    """Return whether the next step is within the reservation."""
    step = rows[m.OWN_STEP]
    return (
        (rows[m.HELD] > 0.0)
        & (rows[m.CURRENT_PATH + m.NUM_SEGMENTS] > 0.0)
        & (rows[m.DRIVEN] + step <= rows[m.PART_END] + PATH_ROUNDING)
    )


@rare_kernel
def move_along(policy, rows):
    """Take the next step of the path, and write the outline's frame after it."""
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
        # if the goal is not hit after all, the HAV has to decide again
        rows[m.MODE] = states.ARRIVED
    return turn, distance
