"""Where to go: paths to the goal, straight or by way of a random place, past all others.

Every candidate is driven in thought, in coarse steps. Near by, the HAV must be able to go round a
circle, past what others have reserved, from every place on the way; farther on only those who
stand count, for the others will have moved. The shortest one that stands the test is taken, if its
first part can be reserved.
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
    include_axles,
    keeps_clear_of,
    nose_keeps_clear,
    place_axles,
    pull_axles,
)
from baselines.policies.reserve.prediction.holding_circle import find_circle
from baselines.policies.reserve.prediction.motion import sense_chain
from baselines.policies.reserve.prediction.paths import total_length
from baselines.policies.reserve.reservation import reserve_circle, reserve_rest
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.dubins import INFEASIBLE
from hav_env.maths.elementary import sincos
from hav_env.maths.kdop import clear_outline

_SEQUENCES_AT_ONCE = 48
_MANY_PATHS = 5
MANY_FAILURES = 20


@rare_kernel
def search(policy, rows, x, y, heading, purpose, margin):
    """Look for a path to a pose [m, rad] and reserve its first part; it is left in ``TRIAL_PATH``.

    Args:
        purpose: GOAL when it is the goal's, or PLACE.
        margin: to be kept from all others [m].

    Returns:
        Whether one was found and reserved.
    """
    count = 0
    for number in range(DIRECT + (sizes.WAYPOINTS if purpose == states.GOAL_PATH else 0)):
        write_candidate(rows, number, x, y, heading)
        total = total_length(rows, m.TRIAL_PATH)
        if rows[m.TRIAL_PATH + m.NUM_SEGMENTS] > 0.0 and total < INFEASIBLE:
            count = insert(rows, count, total, number)
    if count == 0:
        return False
    patience = policy.patience * (1.0 + 0.2 * rows[m.FAILED])
    longest = 1.2 * rows[m.LISTED_LENGTHS] + patience
    front = rows[m.OWN_FRONT_RADIUS]
    for k in range(count):
        if rows[m.LISTED_LENGTHS + k] > longest:
            break
        number = int(rows[m.LISTED_NUMBERS + k])
        write_candidate(rows, number, x, y, heading)
        horizon = policy.horizon * front
        if not is_drivable(policy, rows, m.TRIAL_PATH, 0.0, purpose, horizon, margin):
            continue
        if reserve_next(policy, rows, m.TRIAL_PATH, 0.0, 0.0, purpose, 0.5 * margin):
            return True
    return False


@rare_kernel
def search_in_order(policy, rows, x, y, heading, margin):
    """Go on through all sequences of arcs and straights, as ``search``; it takes many calls."""
    horizon = policy.horizon * rows[m.OWN_FRONT_RADIUS]
    for _ in range(_SEQUENCES_AT_ONCE):
        number = int(rows[m.EXPLORED])
        rows[m.EXPLORED] = (number + 1) % SEQUENCES
        write_sequence(rows, number, x, y, heading)
        if is_drivable(
            policy, rows, m.TRIAL_PATH, 0.0, states.GOAL_PATH, horizon, margin
        ) and reserve_next(policy, rows, m.TRIAL_PATH, 0.0, 0.0, states.GOAL_PATH, 0.5 * margin):
            return True
    return False


@kernel
def rest_is_near(rows, rest):
    """Tell whether so much of a path [m] to the goal may be reserved at once.

    After some paths in vain it may be any, if all who are near are at their goals.
    """
    near = 3.0 * rows[m.OWN_CIRCLE_RADIUS] + rows[m.OWN_LENGTHS]
    in_vain = (rows[m.ADOPTED] > _MANY_PATHS) | (rows[m.FAILED] > MANY_FAILURES)
    return (rest <= near) | ((rows[m.NUM_UNARRIVED] == 0.0) & in_vain)


@rare_kernel
def is_drivable(policy, rows, path, done, purpose, horizon, margin):
    """Tell whether the HAV can drive along a path, in coarse steps, past all others.

    Args:
        path: where it stands; done: how much of it is done already [m].
        purpose: of the path.
        horizon: how far ahead what others have reserved counts [m].
        margin: to be kept [m].
    """
    coarse = min(2.0, 0.25 * rows[m.OWN_CIRCLE_RADIUS])
    rear, front = rows[m.OWN_REAR_RADIUS], rows[m.OWN_FRONT_RADIUS]
    reach = rows[m.OWN_REACH]
    extent = max(reach, rear + front) + margin + 2.0
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
            side, _ = find_circle(policy, rows, x, y, heading, 2, margin, False)
            if side == 0.0:
                return False
    return True


@rare_kernel
def _passes_standing(rows, nose_x, nose_y, margin):
    """Tell whether the axles keep clear of all that stand.

    Their outline is left in ``BODY_OUTLINE``.
    """
    clear_outline(rows, m.BODY_OUTLINE)
    include_axles(rows, m.BODY_OUTLINE)
    for number in range(int(rows[m.NUM_SLOTS])):
        slot = slot_at(number)
        if (
            rows[slot + m.SLOT_KIND] == states.STANDING
            and gap_to(rows, slot, m.BODY_OUTLINE, margin) <= margin + 2.0
        ):
            if not nose_keeps_clear(rows, slot, nose_x, nose_y, margin):
                return False
            if not keeps_clear_of(rows, slot, margin):
                return False
    return True


@rare_kernel
def reserve_next(policy, rows, path, driven, heading, purpose, margin):
    """Reserve the next part of a path, to its end if that is a goal near by; tell whether it is.

    Args:
        path: where it stands; driven: how much of it is done [m].
        heading: of the truck less that of the path's start [rad].
        purpose: of the path; margin: to be kept from all others [m].
    """
    total = total_length(rows, path)
    if (
        purpose == states.GOAL_PATH
        and rest_is_near(rows, total - driven)
        and reserve_rest(policy, rows, path, driven, heading, margin)
    ):
        return True
    end = min(driven + policy.part, total)
    return reserve_circle(policy, rows, path, driven, heading, end, 2, margin)


@rare_kernel
def reserve_circle_here(policy, rows, shifts, margin):
    """Reserve a circle that begins here and now; tell whether that is possible."""
    rows[m.TRIAL_PATH + m.NUM_SEGMENTS] = 0.0
    return reserve_circle(policy, rows, m.TRIAL_PATH, 0.0, 0.0, 0.0, shifts, margin)
