"""Where to go: paths to the goal, straight or by way of a random place, past all others.

Every candidate is driven in thought, in coarse steps. Near by, the HAV must be able to go round a
circle, past what others have reserved, from every place on the way; farther on only those who
stand count, for the others will have moved. The shortest one that stands the test is taken, if its
first part can be reserved.
"""

import math

from baselines.policies.reserve.memory.rows import (
    ADOPTED,
    AXLES,
    BODY,
    CURVATURES,
    EXPLORED,
    FAILED,
    GOAL,
    KIND,
    LENGTH_OF,
    LENGTHS,
    NUM_RESTLESS,
    NUM_SLOTS,
    NUMBER_OF,
    OWN_CIRCLE,
    OWN_FRONT,
    OWN_LENGTHS,
    OWN_REACH,
    OWN_REAR,
    RESERVED,
    SEGMENTS,
    STANDING,
    TRIAL,
    WAYPOINTS,
)
from baselines.policies.reserve.memory.shortlist import insert
from baselines.policies.reserve.perception.other_agents import (
    apart,
    gap_to,
    slot_at,
    someone_within,
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
    nose_swept,
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
    """Look for a path to a pose [m, rad] and reserve its first part; it is left in ``TRIAL``.

    Args:
        purpose: GOAL when it is the goal's, or PLACE.
        margin: to be kept from all others [m].

    Returns:
        Whether one was found and reserved.
    """
    count = 0
    for number in range(DIRECT + (WAYPOINTS if purpose == GOAL else 0)):
        write_candidate(rows, number, x, y, heading)
        total = total_length(rows, TRIAL)
        if rows[TRIAL + SEGMENTS] > 0.0 and total < INFEASIBLE:
            count = insert(rows, count, total, number)
    if count == 0:
        return False
    patience = policy.patience * (1.0 + 0.2 * rows[FAILED])
    longest = 1.2 * rows[LENGTH_OF] + patience
    front = rows[OWN_FRONT]
    for k in range(count):
        if rows[LENGTH_OF + k] > longest:
            break
        number = int(rows[NUMBER_OF + k])
        write_candidate(rows, number, x, y, heading)
        horizon = policy.horizon * front
        if not stands_test(policy, rows, TRIAL, 0.0, purpose, horizon, margin):
            continue
        if reserve_next(policy, rows, TRIAL, 0.0, 0.0, purpose, 0.5 * margin):
            return True
    return False


@rare_kernel
def search_in_order(policy, rows, x, y, heading, margin):
    """Go on through all sequences of arcs and straights, as ``search``; it takes many calls."""
    horizon = policy.horizon * rows[OWN_FRONT]
    for _ in range(_SEQUENCES_AT_ONCE):
        number = int(rows[EXPLORED])
        rows[EXPLORED] = (number + 1) % SEQUENCES
        write_sequence(rows, number, x, y, heading)
        if stands_test(policy, rows, TRIAL, 0.0, GOAL, horizon, margin) and reserve_next(
            policy, rows, TRIAL, 0.0, 0.0, GOAL, 0.5 * margin
        ):
            return True
    return False


@kernel
def rest_is_near(rows, rest):
    """Tell whether so much of a path [m] to the goal may be reserved at once.

    After some paths in vain it may be any, if all who are near are at their goals.
    """
    near = 3.0 * rows[OWN_CIRCLE] + rows[OWN_LENGTHS]
    in_vain = (rows[ADOPTED] > _MANY_PATHS) | (rows[FAILED] > MANY_FAILURES)
    return (rest <= near) | ((rows[NUM_RESTLESS] == 0.0) & in_vain)


@rare_kernel
def stands_test(policy, rows, path, done, purpose, horizon, margin):
    """Tell whether the HAV can drive along a path, in coarse steps, past all others.

    Args:
        path: where it stands; done: how much of it is done already [m].
        purpose: of the path.
        horizon: how far ahead what others have reserved counts [m].
        margin: to be kept [m].
    """
    coarse = min(2.0, 0.25 * rows[OWN_CIRCLE])
    rear, front = rows[OWN_REAR], rows[OWN_FRONT]
    reach = rows[OWN_REACH]
    extent = max(reach, rear + front) + margin + 2.0
    rest = total_length(rows, path) - done
    sense_chain(rows)
    place_axles(rows, 0.0, 0.0)
    x, y, heading, driven = 0.0, 0.0, 0.0, 0.0
    for segment in range(int(rows[path + SEGMENTS])):
        curvature, length = rows[path + CURVATURES + segment], rows[path + LENGTHS + segment]
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
            nose_x, nose_y = rows[AXLES], rows[AXLES + 1]
            sine, cosine = sincos(heading + half)
            x, y = x + chord * cosine, y + chord * sine
            heading, driven = heading + 2.0 * half, driven + along
            sine, cosine = sincos(heading)
            pull_axles(rows, x, y, cosine, sine)
            if not someone_within(rows, x, y, extent):
                continue
            if not _passes_standing(rows, nose_x, nose_y, margin):
                return False
            if driven > horizon:
                continue
            if not apart(rows, BODY, RESERVED, margin):
                return False
            if purpose == GOAL and rest_is_near(rows, rest - driven):
                continue
            side, _ = find_circle(policy, rows, x, y, heading, 2, margin, False)
            if side == 0.0:
                return False
    return True


@rare_kernel
def _passes_standing(rows, nose_x, nose_y, margin):
    """Tell whether the axles keep clear of all that stand; write their outline into ``BODY``."""
    clear_outline(rows, BODY)
    include_axles(rows, BODY)
    for number in range(int(rows[NUM_SLOTS])):
        slot = slot_at(number)
        if rows[slot + KIND] == STANDING and gap_to(rows, slot, BODY, margin) <= margin + 2.0:
            if not nose_swept(rows, slot, nose_x, nose_y, margin):
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
        purpose == GOAL
        and rest_is_near(rows, total - driven)
        and reserve_rest(policy, rows, path, driven, heading, margin)
    ):
        return True
    end = min(driven + policy.part, total)
    return reserve_circle(policy, rows, path, driven, heading, end, 2, margin)


@rare_kernel
def reserve_place(policy, rows, shifts, margin):
    """Reserve a circle that begins here and now; tell whether that is possible."""
    rows[TRIAL + SEGMENTS] = 0.0
    return reserve_circle(policy, rows, TRIAL, 0.0, 0.0, 0.0, shifts, margin)
