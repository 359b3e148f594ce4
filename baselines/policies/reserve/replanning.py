"""This module plans the next path of a HAV among others.

The path leads to its goal, to a random place, or round a circle.
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import states
from baselines.policies.reserve.memory.random_numbers import PLANS, random_key
from baselines.policies.reserve.path_search import (
    reserve_circle_here,
    search,
    search_in_order,
)
from baselines.policies.reserve.perception.own_state import is_due, sensed_goal
from baselines.policies.reserve.prediction.coarse_paths import MANY_FAILURES
from baselines.policies.reserve.prediction.holding_circle import SHIFTS, enter_circle
from baselines.policies.reserve.prediction.paths import copy_path, total_length
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.dubins import shortest_path
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import TWO_PI
from hav_env.maths.random_numbers import normal, uniform

CONTINUE_MARGIN = 0.02  # [m] margin that suffices to continue with the present reservation
TRY_PERIOD = 5  # steps from one attempt to begin, or to find a way out, to the next
PLAN_PERIOD = 15  # steps from one plan of a moving HAV to the next: a plan costs the most time
_LEAD = 1.0  # [m] before the end of the reserved part, from where the HAV reserves the next one
_WAITS_BEFORE_GIVING_UP = 10  # times ``policy.wait``, blocked, if the circle cannot be entered

# A plan.
_DRAWS_PER_PLAN = 11  # the largest number of a draw below, plus one
_PATHS_BEFORE_ROOM = 15  # to a goal, after which a HAV gives space to others now and then
_FAILURES_BEFORE_ROOM = 10  # plans that fail, with the same effect
_ROOM_CHANCE = 0.4  # chance that a HAV after many paths considers giving space
# chance that a HAV that considers it does so: others in the way may do so as well
_PLACE_CHANCE = 0.5
_LEAST_SPREAD = 0.5  # of random places round the HAV [radii of the nose's circle]
_SPREAD_AFTER_FAILURES = 3.0  # the same, at most in addition: there may be space nearby
_SPREAD_AFTER_PATHS = 8.0  # the same: far away from a place where HAVs block each other
_EXACT_EVERY = 4  # failures: one of these plans leads to the goal's own pose
_AIM_DISTANCE = 0.9  # of the distance tolerance: random aims round the goal, below 1 for rounding
_AIM_TURN = 0.8  # of the heading tolerance, the same
_AIM_MARGIN_SHARE = 0.5  # of ``policy.margin``: the most for a random aim
_FAILURES_BEFORE_NARROW = 3  # plans that fail, after which two of three plans have less margin
_NARROW_EVERY = 3
_NARROW_SHARE, _NARROWER_SHARE = 0.5, 0.3  # of the margin, in these plans

# An attempt to begin.
_BEGIN_SHIFTS = 4  # straight distances before a circle to try: a HAV that stands has time
_BEGIN_MARGIN_SHARE = 0.5  # of the plan's margin, for a circle from here
_TRIES_BEFORE_NARROW, _TRIES_BEFORE_NARROWER = 10, 40  # with the whole margin; with the next share
_BEGIN_NARROW_SHARE, _BEGIN_NARROWER_SHARE = 0.3, 0.2  # of ``policy.margin``: at a tight start


@kernel
def adopt_path(rows, purpose, margin):
    """Make the trial path the current one."""
    copy_path(rows, m.CURRENT_PATH, m.TRIAL_PATH)
    _, _, rows[m.PLANNED_GOAL_HEADING] = sensed_goal(rows)
    rows[m.DRIVEN], rows[m.PURPOSE], rows[m.REFRESH] = 0.0, purpose, 0.0
    rows[m.PLANNED_MARGIN], rows[m.DOOMED] = margin, 0.0
    rows[m.ADOPTED] += 1.0 if purpose == states.GOAL_PATH else 0.0


@rare_kernel
def plan_path(policy, rows, margin):
    """Look for a path and take it. Return whether there is one.

    After a failure the path leads to a random pose within the goal's tolerances, with another
    margin. After many failures, or many paths to one goal, it leads to a random place now and then.
    HAVs that block each other therefore give space to each other.
    """
    if (rows[m.GATHERED] == 0.0) | (not is_due(rows, policy.turns)):
        return False
    x, y, heading = sensed_goal(rows)
    seed, episode, stream, draw = random_key(rows, PLANS, _DRAWS_PER_PLAN)
    failed, purpose = int(rows[m.FAILED]), states.GOAL_PATH
    in_vain = rows[m.ADOPTED] > _PATHS_BEFORE_ROOM
    makes_room = failed > _FAILURES_BEFORE_ROOM or (
        in_vain and uniform(seed, episode, stream, draw + 10) < _ROOM_CHANCE
    )
    if makes_room and uniform(seed, episode, stream, draw) < _PLACE_CHANCE:
        purpose = states.PLACE_PATH
        farther = _SPREAD_AFTER_PATHS if in_vain else _SPREAD_AFTER_FAILURES
        spread = rows[m.OWN_FRONT_RADIUS] * (
            _LEAST_SPREAD + farther * uniform(seed, episode, stream, draw + 1)
        )
        x = spread * normal(seed, episode, stream, draw + 2)
        y = spread * normal(seed, episode, stream, draw + 4)
        heading = TWO_PI * uniform(seed, episode, stream, draw + 6)
    elif failed % _EXACT_EVERY != 0:
        sine, cosine = sincos(TWO_PI * uniform(seed, episode, stream, draw + 7))
        away = _AIM_DISTANCE * policy.distance_tolerance
        away *= math.sqrt(uniform(seed, episode, stream, draw + 8))
        x, y = x + away * cosine, y + away * sine
        turned = 2.0 * _AIM_TURN * uniform(seed, episode, stream, draw + 9) - _AIM_TURN
        heading += policy.heading_tolerance * turned
        margin = min(margin, _AIM_MARGIN_SHARE * policy.margin)
    if failed > _FAILURES_BEFORE_NARROW and failed % _NARROW_EVERY != 0:
        margin *= _NARROW_SHARE if failed % _NARROW_EVERY == 1 else _NARROWER_SHARE
    if (purpose == states.GOAL_PATH) & (failed > MANY_FAILURES) & (failed % 2 == 0):
        found = search_in_order(policy, rows, x, y, heading, margin)
    else:
        found = search(policy, rows, x, y, heading, purpose, margin, math.inf)
    if found:
        adopt_path(rows, purpose, margin)
        if purpose == states.GOAL_PATH:
            rows[m.FAILED] = 0.0
        return True
    rows[m.FAILED] += 1.0
    return False


@kernel
def lead_distance(policy, rows):
    """Return the distance [m] before the end of the reserved part to reserve the next one from."""
    return _LEAD + (policy.turns - 1) * rows[m.OWN_STEP]


@kernel
def may_find_shortcut(policy, rows):
    """Return whether the HAV may reserve the next part of a path to its goal in this step."""
    return (
        (rows[m.PURPOSE] == states.GOAL_PATH)
        & (rows[m.CIRCLE_SIDE] != 0.0)
        & (rows[m.BLOCKED] == 0.0)
        & (rows[m.PART_END] - rows[m.DRIVEN] <= lead_distance(policy, rows))
        & is_due(rows, policy.turns)
    )


@rare_kernel
def find_shortcut(policy, rows):
    """Look for a path to the goal that is shorter by ``policy.shortcut`` than the rest of this one.

    Others may have moved since the current path was planned.
    """
    rest = total_length(rows, m.CURRENT_PATH) - rows[m.DRIVEN]
    x, y, heading = sensed_goal(rows)
    most = rest - policy.shortcut
    _, first, middle, last = shortest_path(x, y, heading, rows[m.OWN_CIRCLE_RADIUS])
    if first + middle + last >= most:
        return False
    if search(policy, rows, x, y, heading, states.GOAL_PATH, policy.margin, most):
        adopt_path(rows, states.GOAL_PATH, policy.margin)
        rows[m.ADOPTED] -= 1.0  # paths that become shorter do not block each other for long
        return True
    return False


@rare_kernel
def try_to_begin(policy, rows):
    """Try to begin moving: along a path, or at least round a circle from here."""
    rows[m.TRIES] += 1.0
    margin = policy.margin
    if rows[m.TRIES] > _TRIES_BEFORE_NARROW:
        narrow = rows[m.TRIES] <= _TRIES_BEFORE_NARROWER
        margin *= _BEGIN_NARROW_SHARE if narrow else _BEGIN_NARROWER_SHARE
    if plan_path(policy, rows, margin):
        return
    margin *= _BEGIN_MARGIN_SHARE
    if rows[m.GATHERED] > 0.0 and reserve_circle_here(policy, rows, _BEGIN_SHIFTS, margin):
        _leave_path(rows)


@rare_kernel
def find_way_out(policy, rows):
    """Look for another path from time to time. After some time, enter the reserved circle.

    A HAV that can do neither finally gives up its reservation, and stands.
    """
    blocked = int(rows[m.BLOCKED])
    if (blocked == 0 or is_due(rows, PLAN_PERIOD)) and plan_path(policy, rows, policy.margin):
        return
    if blocked > 0 and not is_due(rows, TRY_PERIOD):
        return
    if rows[m.HELD] > 0.0 and rows[m.CIRCLE_SIDE] != 0.0:
        patient = rows[m.PURPOSE] != states.CIRCLE_PATH and blocked < policy.wait
        if not patient and enter_circle(rows):
            adopt_path(rows, states.CIRCLE_PATH, policy.margin)
        elif blocked > _WAITS_BEFORE_GIVING_UP * policy.wait:
            _give_up(rows)
    elif rows[m.GATHERED] > 0.0 and reserve_circle_here(policy, rows, SHIFTS, CONTINUE_MARGIN):
        _leave_path(rows)
    elif blocked > policy.wait:
        _give_up(rows)


@kernel
def _leave_path(rows):
    """Leave the current path: the HAV has reserved a circle that begins here."""
    rows[m.CURRENT_PATH + m.NUM_SEGMENTS], rows[m.DRIVEN] = 0.0, 0.0
    rows[m.PURPOSE] = states.CIRCLE_PATH


@kernel
def _give_up(rows):
    """Give up the reservation and stand: others keep clear of the chain only."""
    rows[m.MODE], rows[m.TRIES] = states.STANDING, 0.0
