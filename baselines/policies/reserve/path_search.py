"""This module searches for a path to a pose, past all other HAVs.

The HAV predicts every candidate in coarse steps. Up to the horizon, it must have a free circle at
every step, past the outlines of others. Beyond the horizon only HAVs that stand count, because the
others will have moved. The HAV takes the shortest candidate that it can drive and whose first part
it can reserve.
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes, states
from baselines.policies.reserve.memory.shortlist import insert
from baselines.policies.reserve.perception.other_agents import (
    gap_to,
    is_any_within,
    keeps_margin,
    slot_at,
)
from baselines.policies.reserve.prediction.candidates import (
    DIRECT,
    SEQUENCES,
    write_candidate,
    write_sequence,
)
from baselines.policies.reserve.prediction.chain import (
    COARSE_TURN,
    include_axles,
    keeps_clear_of,
    nose_keeps_clear,
    place_axles,
    pull_axles,
)
from baselines.policies.reserve.prediction.holding_circle import SHIFTS, find_circle
from baselines.policies.reserve.prediction.joints import keeps_joints_when_wide, path_keeps_joints
from baselines.policies.reserve.prediction.motion import sense_chain
from baselines.policies.reserve.prediction.paths import total_length
from baselines.policies.reserve.reservation import reserve_circle, reserve_rest
from baselines.policies.reserve.tight_paths import AIMS, PER_AIM, list_tight, write_tight_path
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.dubins import INFEASIBLE
from hav_env.maths.elementary import sincos
from hav_env.maths.kdop import clear_outline

MANY_FAILURES = 20  # plans that fail, after which last resorts are tried
_PATHS_BEFORE_WHOLE_REST = 5  # to a goal, after which the whole rest to it may be reserved
_NEAR_GOAL_CIRCLES = 3.0  # radii of the endless circle, plus the truck: a rest that may be reserved
_SEQUENCES_AT_ONCE = 48  # that one plan tries: more would take too long in one step
_PATIENCE_GROWTH = 0.2  # of the patience, with each failed plan
_LENGTH_FACTOR = 1.2  # times the shortest candidate: a path of that length is never too long
_PART_MARGIN_SHARE = 0.5  # of the plan's margin: kept by the first part, which is predicted exactly
_PATH_COARSE_STEP = 2.0  # [m] of a coarse step along a path, at most
_WIDE = AIMS * PER_AIM  # number of the first wide candidate: tight ones come before
_FAR = _PATH_COARSE_STEP  # [m] beyond the margin, from where a coarse step cannot come too near


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
    for number in range(DIRECT + (sizes.WAYPOINTS if purpose == states.GOAL_PATH else 0)):
        write_candidate(rows, number, x, y, heading)
        total = total_length(rows, m.TRIAL_PATH)
        if rows[m.TRIAL_PATH + m.NUM_SEGMENTS] > 0.0 and total < min(INFEASIBLE, most):
            count = insert(rows, count, total, _WIDE + number, sizes.LONGLIST_SIZE)
    if count == 0:
        return False
    patience = policy.patience * (1.0 + _PATIENCE_GROWTH * rows[m.FAILED])
    longest = _LENGTH_FACTOR * rows[m.LISTED_LENGTHS] + patience
    front = rows[m.OWN_FRONT_RADIUS]
    for k in range(count):
        if rows[m.LISTED_LENGTHS + k] > longest:
            break
        number = int(rows[m.LISTED_NUMBERS + k])
        if number < _WIDE:
            write_tight_path(policy, rows, number, m.TRIAL_PATH)
        else:
            write_candidate(rows, number - _WIDE, x, y, heading)
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


@kernel
def rest_is_near(rows, rest):
    """Return whether a rest [m] of a path to the goal is short enough to be reserved at once.

    After many paths or failures any length is, if all others in slots have arrived.
    """
    near = _NEAR_GOAL_CIRCLES * rows[m.OWN_CIRCLE_RADIUS] + rows[m.OWN_LENGTHS]
    in_vain = (rows[m.ADOPTED] > _PATHS_BEFORE_WHOLE_REST) | (rows[m.FAILED] > MANY_FAILURES)
    return (rest <= near) | ((rows[m.NUM_UNARRIVED] == 0.0) & in_vain)


@rare_kernel
def is_drivable(policy, rows, path, done, purpose, horizon, margin):
    """Return whether the HAV can drive along a path, in coarse steps, past all others.

    Args:
        policy: The Reserve.
        rows: The HAV's memory.
        path: First row of the path.
        done: Distance driven along it [m].
        purpose: Purpose of the path.
        horizon: Distance from here up to which the outlines of others count [m].
        margin: Margin to all others [m].
    """
    coarse = min(_PATH_COARSE_STEP, COARSE_TURN * rows[m.OWN_CIRCLE_RADIUS])
    rear, front = rows[m.OWN_REAR_RADIUS], rows[m.OWN_FRONT_RADIUS]
    reach = rows[m.OWN_REACH]
    extent = max(reach, rear + front) + margin + _FAR
    rest = total_length(rows, path) - done
    sense_chain(rows)
    place_axles(rows, 0.0, 0.0)
    x, y, heading, driven = 0.0, 0.0, 0.0, 0.0
    for segment in range(int(rows[path + m.NUM_SEGMENTS])):
        curvature, length = rows[path + m.CURVATURES + segment], rows[path + m.LENGTHS + segment]
        skipped = min(done, length)
        done, length = done - skipped, length - skipped
        if length <= 0.0:
            continue
        steps = math.ceil(length / coarse)
        along = length / steps
        half = 0.5 * curvature * along
        sine, cosine = sincos(half)
        chord = along if half == 0.0 else along * sine / half
        for _ in range(steps):
            nose_x, nose_y = rows[m.AXLES], rows[m.AXLES + 1]
            sine, cosine = sincos(heading + half)
            x, y = x + chord * cosine, y + chord * sine
            heading, driven = heading + 2.0 * half, driven + along
            sine, cosine = sincos(heading)
            pull_axles(rows, x, y, cosine, sine)
            if not is_any_within(rows, x, y, extent):
                continue
            if not _passes_standing(rows, nose_x, nose_y, margin):
                return False
            if driven > horizon:
                continue
            if not keeps_margin(rows, m.BODY_OUTLINE, states.RESERVED, margin):
                return False
            if purpose == states.GOAL_PATH and rest_is_near(rows, rest - driven):
                continue
            side, _ = find_circle(policy, rows, x, y, heading, SHIFTS, margin, False)
            if side == 0.0:
                return False
    return True


@rare_kernel
def _passes_standing(rows, nose_x, nose_y, margin):
    """Return whether the axles keep clear of all standing HAVs.

    Their outline is written to ``BODY_OUTLINE``.
    """
    clear_outline(rows, m.BODY_OUTLINE)
    include_axles(rows, m.BODY_OUTLINE)
    for number in range(int(rows[m.NUM_SLOTS])):
        slot = slot_at(number)
        if (
            rows[slot + m.SLOT_KIND] == states.STANDING
            and gap_to(rows, slot, m.BODY_OUTLINE, margin) <= margin + _FAR
        ):
            if not nose_keeps_clear(rows, slot, nose_x, nose_y, margin):
                return False
            if not keeps_clear_of(rows, slot, margin):
                return False
    return True


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
