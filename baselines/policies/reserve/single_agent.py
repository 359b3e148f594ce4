"""This module plans the path of a lone HAV: the shortest of many tight ones without a jackknife.

A HAV may turn more tightly than it could without end, if the turn ends before a joint folds. The
HAV predicts candidates step by step, several side by side, the shortest first. It takes the
shortest one on which every articulation stays allowed, up to the goal and on the straight line
behind it.
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes
from baselines.policies.reserve.perception.own_state import sense_itself, sense_joints
from baselines.policies.reserve.prediction.motion import command, follow
from baselines.policies.reserve.prediction.paths import total_length
from baselines.policies.reserve.prediction.trials import (
    RUNNING,
    SURVIVED,
    begin_trial,
    empty_trials,
    measure_first_turns,
    measure_last_turns,
    run_trials,
)
from baselines.policies.reserve.tight_paths import (
    LAST_TURN_FACTOR,
    list_shortest,
    write_endings,
    write_radii,
    write_tight_path,
)
from hav_env.compiled import rare_kernel

_PAUSE_TRUCKS = 0.5  # truck lengths straight ahead after a failed plan: the next one then differs


@rare_kernel
def act_alone(policy, rows, world, agent, lane):
    """Follow the path, or plan one. Drive straight on while no path is found.

    Returns:
        Speed [m/s] and steering [rad].
    """
    if (
        sense_itself(policy, rows, world, agent, lane)
        and rows[m.CURRENT_PATH + m.NUM_SEGMENTS] > 0.0
    ):
        rows[m.DRIVEN] -= rows[m.OWN_STEP]  # the HAV has stood instead
    if rows[m.PLANNED_GOALS_LEFT] != rows[m.OWN_GOALS_LEFT] or rows[m.DRIVEN] > total_length(
        rows, m.CURRENT_PATH
    ):
        rows[m.PLANNED_GOALS_LEFT], rows[m.CURRENT_PATH + m.NUM_SEGMENTS], rows[m.PAUSE] = (
            rows[m.OWN_GOALS_LEFT],
            0.0,
            0.0,
        )
    if rows[m.CURRENT_PATH + m.NUM_SEGMENTS] == 0.0:
        rows[m.PAUSE] -= 1.0
        if rows[m.PAUSE] < 0.0:
            sense_joints(rows, world, agent, lane)
            if plan_alone(policy, rows):
                rows[m.PLANNED_GOAL_HEADING], rows[m.DRIVEN] = rows[m.OWN_GOAL + 2], 0.0
    if rows[m.CURRENT_PATH + m.NUM_SEGMENTS] == 0.0:
        if rows[m.PAUSE] < 0.0:
            rows[m.PAUSE] = _PAUSE_TRUCKS * rows[m.OWN_LENGTHS] / rows[m.OWN_STEP]
        return command(policy, rows, 0.0, rows[m.OWN_STEP])
    turn, distance = follow(rows)
    rows[m.DRIVEN] += distance
    return command(policy, rows, turn, distance)


@rare_kernel
def plan_alone(policy, rows):
    """Write a path to the goal, and return whether one was found."""
    write_radii(rows)
    measure_first_turns(rows)
    measure_last_turns(rows)
    write_endings(rows, LAST_TURN_FACTOR)
    beyond = -1.0
    for _ in range(policy.shortlists):
        count = list_shortest(policy, rows, beyond, math.inf, 1, sizes.SHORTLIST_SIZE)
        survivor = _find_survivor(policy, rows, count)
        if survivor < count:
            write_tight_path(policy, rows, int(rows[m.LISTED_NUMBERS + survivor]), m.CURRENT_PATH)
            return True
        if count < sizes.SHORTLIST_SIZE:
            break
        beyond = rows[m.LISTED_LENGTHS + count - 1]
    rows[m.CURRENT_PATH + m.NUM_SEGMENTS] = 0.0
    return False


@rare_kernel
def _find_survivor(policy, rows, count):
    """Return the place in the list of the first candidate that survives, ``count`` if none does.

    Whenever a trial ends, the next candidate takes its lane. Behind one that has survived, only
    those before it matter.
    """
    empty_trials(rows)
    waiting, first, pending = 0, count, count > 0
    while pending:
        pending = False
        for lane in range(sizes.TRIALS):
            result, place = rows[m.TRIAL_RESULT + lane], int(rows[m.TRIAL_PLACE + lane])
            if result == SURVIVED:
                first = min(first, place)
            if result != RUNNING and waiting < first:
                write_tight_path(
                    policy, rows, int(rows[m.LISTED_NUMBERS + waiting]), m.CURRENT_PATH
                )
                begin_trial(rows, lane, m.CURRENT_PATH)
                rows[m.TRIAL_PLACE + lane] = waiting
                waiting += 1
        for lane in range(sizes.TRIALS):
            running = rows[m.TRIAL_RESULT + lane] == RUNNING
            pending = pending or (running and rows[m.TRIAL_PLACE + lane] < first)
        if pending:
            run_trials(policy, rows)
    return first
