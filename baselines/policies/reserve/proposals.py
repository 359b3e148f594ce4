"""This module lets a HAV take the proposals of another policy, for which Reserve is the backup.

A proposal is one step. The HAV takes it if it can reserve that step and a circle behind it, or if
the step hits the goal. Its memory is then that of a HAV under Reserve whose path ends with the
step, so Reserve can drive on from there at any time. It does so after each refusal for a while, on
a reserved rest to the goal, and when the time for proposals on the way to this goal is over.
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import states
from baselines.policies.reserve.multi_agent import (
    ANYWHERE,
    circle_reach,
    drive_on,
    look_around,
    move_along,
    notice,
)
from baselines.policies.reserve.perception.other_agents import remember_neighborhood
from baselines.policies.reserve.perception.own_state import SURELY, hits_goal, sensed_goal
from baselines.policies.reserve.prediction.holding_circle import SHIFTS
from baselines.policies.reserve.prediction.joints import are_joints_small, circle_keeps_joints
from baselines.policies.reserve.prediction.motion import (
    advance_chain,
    command,
    most_turn,
    sense_chain,
)
from baselines.policies.reserve.prediction.paths import append
from baselines.policies.reserve.renewal import recheck_reservation
from baselines.policies.reserve.replanning import CONTINUE_MARGIN, adopt_path
from baselines.policies.reserve.reservation import reserve_circle, reserve_rest
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.dubins import shortest_path
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import clip

_SLOWEST_SHARE = 0.5  # of full speed: slower proposals stand, others drive at full speed
_STEEPEST = 1.5  # [rad] a quarter turn has no tangent, and the limit of the steering is far below
_MOST_DOUBLINGS = 10.0  # of the time without proposals after a refusal


@rare_kernel
def take_or_drive(policy, rows, memory, world, agent, lane, speed, steering):
    """Take a proposal, or drive by Reserve.

    Args:
        policy: The Reserve.
        rows: The HAV's memory.
        memory: Memory of all HAVs.
        world: World of the HAV.
        agent: Number of the HAV.
        lane: Lane of the world.
        speed: Proposed speed [m/s].
        steering: Proposed steering angle [rad].

    Returns:
        Whether the proposal was taken; speed [m/s] and steering [rad].
    """
    changed = notice(policy, rows, memory, world, agent, lane)
    if rows[m.PROPOSED_GOALS_LEFT] != rows[m.OWN_GOALS_LEFT]:
        _start_listening(policy, rows)
    if _listens(rows):
        step = rows[m.OWN_STEP]
        if not speed * policy.dt >= _SLOWEST_SHARE * step:  # also if it is no number
            _stand(policy, rows, memory, world, agent, lane, changed)
            return True, 0.0, 0.0
        stood = rows[m.MODE] == states.STANDING
        radius = ANYWHERE if changed or stood else circle_reach(rows, step)
        look_around(policy, rows, memory, world, agent, lane, radius)
        sine, cosine = sincos(clip(steering, -_STEEPEST, _STEEPEST))
        most = most_turn(rows, step)
        turn = clip(step * sine / (rows[m.OWN_LENGTHS] * cosine), -most, most)
        if abs(steering) < math.inf and _reserve_step(policy, rows, turn):
            rows[m.STAMP] = rows[m.OWN_RANDOM_KEY + 2] + 1.0
            rows[m.BLOCKED] = 0.0
            if changed or stood:
                remember_neighborhood(policy, rows, memory, world, agent, lane)
            turn, distance = move_along(policy, rows)
            speed, steering = command(policy, rows, turn, distance)
            return True, speed, steering
        _stop_listening(policy, rows)
    speed, steering = drive_on(policy, rows, memory, world, agent, lane, changed)
    return False, speed, steering


@rare_kernel
def _start_listening(policy, rows):
    """Set the time for proposals on the way to a new goal."""
    x, y, heading = sensed_goal(rows)
    _, first, middle, last = shortest_path(x, y, heading, rows[m.OWN_CIRCLE_RADIUS])
    now, steps = rows[m.OWN_RANDOM_KEY + 2], (first + middle + last) / rows[m.OWN_STEP]
    rows[m.PROPOSED_GOALS_LEFT] = rows[m.OWN_GOALS_LEFT]
    rows[m.LISTENS_FROM], rows[m.LISTENS_UNTIL] = now, now + policy.leeway * steps
    rows[m.REFUSED] = 0.0


@kernel
def _stop_listening(policy, rows):
    """Leave the next steps to Reserve: after each refusal for twice the time."""
    doublings = int(min(rows[m.REFUSED], _MOST_DOUBLINGS))
    rows[m.LISTENS_FROM] = rows[m.OWN_RANDOM_KEY + 2] + policy.retry * 2**doublings
    rows[m.REFUSED] += 1.0


@kernel
def _listens(rows):
    """Return whether the HAV considers proposals in this step."""
    now = rows[m.OWN_RANDOM_KEY + 2]
    finishes = (
        (rows[m.MODE] == states.RESERVED)
        & (rows[m.HELD] > 0.0)
        & (rows[m.CIRCLE_SIDE] == 0.0)
        & (rows[m.CURRENT_PATH + m.NUM_SEGMENTS] > 0.0)
    )
    return (rows[m.LISTENS_FROM] <= now) & (now < rows[m.LISTENS_UNTIL]) & (not finishes)


@rare_kernel
def _stand(policy, rows, memory, world, agent, lane, changed):
    """Stand within what is reserved, and compare that with the outlines of newcomers."""
    for row in range(4):
        rows[m.FRAME_BEFORE + row] = rows[m.FRAME_AFTER + row]
    if rows[m.MODE] == states.STANDING:
        rows[m.OUTLINE_RADIUS] = 0.0
        return
    if changed:
        look_around(policy, rows, memory, world, agent, lane, ANYWHERE)
        recheck_reservation(policy, rows)
        remember_neighborhood(policy, rows, memory, world, agent, lane)
    rows[m.STAMP] = rows[m.OWN_RANDOM_KEY + 2] + 1.0


@rare_kernel
def _reserve_step(policy, rows, turn):
    """Reserve a step with a turn [rad] and a circle behind it, or the stop if it hits the goal.

    Returns:
        Whether that is possible.
    """
    distance = rows[m.OWN_STEP]
    sense_chain(rows)
    x, y, least = advance_chain(rows, 0.0, 0.0, turn, distance)
    if least < rows[m.OWN_LEAST_COSINE]:
        return False
    # without tight paths, the bound of the joints is that of wide paths
    wide = abs(turn) * rows[m.OWN_CIRCLE_RADIUS] <= distance
    if rows[m.OWN_TIGHT] == 0.0 and not (wide and are_joints_small(rows)):
        return False
    rows[m.TRIAL_PATH + m.NUM_SEGMENTS] = 0.0
    # a HAV heads as its path does half a step ahead
    append(rows, m.TRIAL_PATH, 2.0 * turn / distance, distance)
    goal_x, goal_y, goal_heading = sensed_goal(rows)
    if hits_goal(policy, goal_x - x, goal_y - y, goal_heading - turn, SURELY):
        goes_on = (
            rows[m.OWN_GOALS_LEFT] == 1.0
            or circle_keeps_joints(rows, 1.0, 0.0)
            or circle_keeps_joints(rows, -1.0, 0.0)
        )
        if goes_on and reserve_rest(policy, rows, m.TRIAL_PATH, 0.0, 0.0, CONTINUE_MARGIN):
            adopt_path(rows, states.GOAL_PATH, policy.margin)
            return True
        return False
    if reserve_circle(policy, rows, m.TRIAL_PATH, 0.0, 0.0, distance, SHIFTS, CONTINUE_MARGIN):
        adopt_path(rows, states.PLACE_PATH, policy.margin)
        return True
    return False
