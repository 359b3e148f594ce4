"""This module searches for a path to a pose, past all other HAVs.

The HAV takes the shortest candidate that it can drive, and whose first part it can reserve.
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes, states
from baselines.policies.reserve.memory.shortlist import insert
from baselines.policies.reserve.prediction.candidates import (
    DIRECT,
    SEQUENCES,
    write_candidate,
    write_sequence,
)
from baselines.policies.reserve.prediction.coarse_paths import is_drivable, rest_is_near
from baselines.policies.reserve.prediction.holding_circle import SHIFTS
from baselines.policies.reserve.prediction.joints import keeps_joints_when_wide, path_keeps_joints
from baselines.policies.reserve.prediction.paths import total_length
from baselines.policies.reserve.reservation import reserve_circle, reserve_rest
from baselines.policies.reserve.tight_paths import AIMS, PER_AIM, list_tight, write_tight_path
from hav_env.compiled import rare_kernel
from hav_env.maths.dubins import INFEASIBLE

_SEQUENCES_AT_ONCE = 48  # that one plan tries: more would take too long in one step
_PATIENCE_GROWTH = 0.2  # of the patience, with each failed plan
_LENGTH_FACTOR = 1.2  # times the shortest candidate: a path of that length is never too long
_PART_MARGIN_SHARE = 0.5  # of the plan's margin: kept by the first part, which is predicted exactly
_WIDE = AIMS * PER_AIM  # number of the first wide candidate: tight ones come before


@rare_kernel
def search(policy, rows, x, y, heading, purpose, margin, most):
    """Look for a path to a pose and reserve its first part. It writes the path to ``TRIAL_PATH``.

    Args:
        policy: The Reserve.
        rows: The HAV's memory.
        x: Forward coordinate of the pose [m].
        y: Left coordinate of the pose [m].
        heading: Heading of the pose [rad].
        purpose: ``GOAL_PATH`` if the pose is at the goal, otherwise ``PLACE_PATH``.
        margin: Margin of the path to all others [m].
        most: Maximum length of the path [m].

    Returns:
        Whether a path was found and its first part reserved.
    """
    count, small = 0, keeps_joints_when_wide(rows)
    if purpose == states.GOAL_PATH and rows[m.OWN_TIGHT] > 0.0:
        count = list_tight(policy, rows, most)
    patience = policy.patience * (1.0 + _PATIENCE_GROWTH * rows[m.FAILED])
    longest = math.inf
    for number in range(DIRECT + (sizes.WAYPOINTS if purpose == states.GOAL_PATH else 0)):
        write_candidate(rows, number, x, y, heading, min(most, longest))
        total = total_length(rows, m.TRIAL_PATH)
        if rows[m.TRIAL_PATH + m.NUM_SEGMENTS] > 0.0 and total < min(INFEASIBLE, most):
            count = insert(rows, count, total, _WIDE + number, sizes.LONGLIST_SIZE)
        if count > 0:
            # it never grows, so a candidate that is too long already will not be tried
            longest = _LENGTH_FACTOR * rows[m.LISTED_LENGTHS] + patience
    if count == 0:
        return False
    front = rows[m.OWN_FRONT_RADIUS]
    for k in range(count):
        if rows[m.LISTED_LENGTHS + k] > longest:
            break
        number = int(rows[m.LISTED_NUMBERS + k])
        if number < _WIDE:
            write_tight_path(policy, rows, number, m.TRIAL_PATH)
        else:
            write_candidate(rows, number - _WIDE, x, y, heading, math.inf)
        horizon = policy.horizon * front
        if not is_drivable(policy, rows, m.TRIAL_PATH, 0.0, purpose, horizon, margin):
            continue
        if (number < _WIDE or not small) and not path_keeps_joints(
            policy, rows, m.TRIAL_PATH, purpose == states.GOAL_PATH
        ):
            continue
        part_margin = _PART_MARGIN_SHARE * margin
        if reserve_next(policy, rows, m.TRIAL_PATH, 0.0, 0.0, purpose, part_margin):
            return True
    return False


@rare_kernel
def search_in_order(policy, rows, x, y, heading, margin):
    """Try the next sequences of arcs and straights, as ``search`` tries candidates.

    A call tries ``_SEQUENCES_AT_ONCE`` of them, and the next call goes on from there.

    Args:
        policy: The Reserve.
        rows: The HAV's memory.
        x: Forward coordinate of the pose [m].
        y: Left coordinate of the pose [m].
        heading: Heading of the pose [rad].
        margin: Margin of the path to all others [m].

    Returns:
        Whether a path was found and its first part reserved.
    """
    horizon = policy.horizon * rows[m.OWN_FRONT_RADIUS]
    part_margin, small = _PART_MARGIN_SHARE * margin, keeps_joints_when_wide(rows)
    for _ in range(_SEQUENCES_AT_ONCE):
        number = int(rows[m.EXPLORED])
        rows[m.EXPLORED] = (number + 1) % SEQUENCES
        write_sequence(rows, number, x, y, heading)
        if not small and not path_keeps_joints(policy, rows, m.TRIAL_PATH, True):
            continue
        if is_drivable(
            policy, rows, m.TRIAL_PATH, 0.0, states.GOAL_PATH, horizon, margin
        ) and reserve_next(policy, rows, m.TRIAL_PATH, 0.0, 0.0, states.GOAL_PATH, part_margin):
            return True
    return False


@rare_kernel
def reserve_next(policy, rows, path, driven, heading, purpose, margin):
    """Reserve the next part of a path, or the whole rest if the goal is near.

    Args:
        policy: The Reserve.
        rows: The HAV's memory.
        path: First row of the path.
        driven: Distance driven along it [m].
        heading: Truck's heading less that of the path's start [rad], up to whole turns.
        purpose: Purpose of the path.
        margin: Margin to all others [m].

    Returns:
        Whether that is possible.
    """
    total = total_length(rows, path)
    if (
        purpose == states.GOAL_PATH
        and rest_is_near(rows, total - driven)
        and reserve_rest(policy, rows, path, driven, heading, margin)
    ):
        return True
    end = min(driven + policy.part, total)
    return reserve_circle(policy, rows, path, driven, heading, end, SHIFTS, margin)


@rare_kernel
def reserve_circle_here(policy, rows, shifts, margin):
    """Reserve a circle that begins here, and return whether that is possible."""
    rows[m.TRIAL_PATH + m.NUM_SEGMENTS] = 0.0
    return reserve_circle(policy, rows, m.TRIAL_PATH, 0.0, 0.0, 0.0, shifts, margin)
