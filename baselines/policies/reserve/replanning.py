"""Where a HAV among others goes next: to its goal, to a random place, or round a circle."""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import states
from baselines.policies.reserve.memory.random_numbers import PLANS, random_key
from baselines.policies.reserve.path_search import (
    MANY_FAILURES,
    reserve_circle_here,
    search,
    search_in_order,
)
from baselines.policies.reserve.perception.own_state import is_due, sensed_goal
from baselines.policies.reserve.prediction.holding_circle import enter_circle
from baselines.policies.reserve.prediction.paths import copy_path
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import TWO_PI
from hav_env.maths.random_numbers import normal, uniform

_DRAWS = 11  # random numbers of a plan
_HOPELESS = 10  # times as long as a HAV waits, after which it gives up what it has reserved
_MANY_PATHS = 15  # to the goal, after which those who are in each other's way make room
CONTINUE_MARGIN = 0.02  # [m] margin that is enough to go on with what is reserved


@kernel
def _adopt(rows, purpose, margin):
    """Let the path that was tried be the one under way."""
    copy_path(rows, m.CURRENT_PATH, m.TRIAL_PATH)
    _, _, rows[m.PLANNED_GOAL_HEADING] = sensed_goal(rows)
    rows[m.DRIVEN], rows[m.PURPOSE], rows[m.REFRESH] = 0.0, purpose, 0.0
    rows[m.PLANNED_MARGIN], rows[m.DOOMED] = margin, 0.0
    rows[m.ADOPTED] += 1.0 if purpose == states.GOAL_PATH else 0.0


@rare_kernel
def plan_path(policy, rows, margin):
    """Look for a path and take it; return whether there is one.

    After failures it leads to a random pose within the goal's tolerance, with other margins. After
    many, or after many paths in vain, it leads to a random place now and then: those in the way may
    have the same trouble.
    """
    if (rows[m.GATHERED] == 0.0) | (not is_due(rows, policy.turns)):
        return False
    x, y, heading = sensed_goal(rows)
    seed, episode, stream, draw = random_key(rows, PLANS, _DRAWS)
    failed, purpose = int(rows[m.FAILED]), states.GOAL_PATH
    in_vain = rows[m.ADOPTED] > _MANY_PATHS
    lost = failed > 10 or (in_vain and uniform(seed, episode, stream, draw + 10) < 0.4)
    if lost and uniform(seed, episode, stream, draw) < 0.5:
        purpose = states.PLACE_PATH
        farther = 8.0 if in_vain else 3.0
        spread = rows[m.OWN_FRONT_RADIUS] * (
            0.5 + farther * uniform(seed, episode, stream, draw + 1)
        )
        x = spread * normal(seed, episode, stream, draw + 2)
        y = spread * normal(seed, episode, stream, draw + 4)
        heading = TWO_PI * uniform(seed, episode, stream, draw + 6)
    elif failed % 4 != 0:
        sine, cosine = sincos(TWO_PI * uniform(seed, episode, stream, draw + 7))
        away = 0.9 * policy.distance_tolerance
        away *= math.sqrt(uniform(seed, episode, stream, draw + 8))
        x, y = x + away * cosine, y + away * sine
        turned = 1.6 * uniform(seed, episode, stream, draw + 9) - 0.8
        heading += policy.heading_tolerance * turned
        margin = min(margin, 0.5 * policy.margin)
    if failed > 3 and failed % 3 != 0:
        margin *= 0.5 if failed % 3 == 1 else 0.3
    if (purpose == states.GOAL_PATH) & (failed > MANY_FAILURES) & (failed % 2 == 0):
        found = search_in_order(policy, rows, x, y, heading, margin)
    else:
        found = search(policy, rows, x, y, heading, purpose, margin)
    if found:
        _adopt(rows, purpose, margin)
        if purpose == states.GOAL_PATH:
            rows[m.FAILED] = 0.0
        return True
    rows[m.FAILED] += 1.0
    return False


@rare_kernel
def try_to_begin(policy, rows):
    """Try to begin moving: towards the goal, or at least round a circle."""
    rows[m.TRIES] += 1.0
    margin = policy.margin
    if rows[m.TRIES] > 10.0:
        margin *= 0.3 if rows[m.TRIES] <= 40.0 else 0.2
    if plan_path(policy, rows, margin):
        return
    if rows[m.GATHERED] > 0.0 and reserve_circle_here(policy, rows, 4, 0.5 * margin):
        _stop_at_once(rows)


@rare_kernel
def find_way_out(policy, rows):
    """Look for another path at intervals; meanwhile, after some time, go round the circle."""
    blocked = int(rows[m.BLOCKED])
    if (blocked == 0 or is_due(rows, 15)) and plan_path(policy, rows, policy.margin):
        return
    if blocked > 0 and not is_due(rows, 5):
        return
    if rows[m.HELD] > 0.0 and rows[m.CIRCLE_SIDE] != 0.0:
        patient = rows[m.PURPOSE] != states.CIRCLE_PATH and blocked < policy.wait
        if not patient and enter_circle(rows):
            _adopt(rows, states.CIRCLE_PATH, policy.margin)
        elif blocked > _HOPELESS * policy.wait:
            rows[m.MODE], rows[m.TRIES] = states.STANDING, 0.0
    elif rows[m.GATHERED] > 0.0 and reserve_circle_here(policy, rows, 2, CONTINUE_MARGIN):
        _stop_at_once(rows)
    elif blocked > policy.wait:
        rows[m.MODE], rows[m.TRIES] = (
            states.STANDING,
            0.0,
        )  # nobody need keep clear of more than the chain


@kernel
def _stop_at_once(rows):
    """Leave the path: what is reserved begins with a circle."""
    rows[m.CURRENT_PATH + m.NUM_SEGMENTS], rows[m.PURPOSE], rows[m.DRIVEN] = (
        0.0,
        states.CIRCLE_PATH,
        0.0,
    )
