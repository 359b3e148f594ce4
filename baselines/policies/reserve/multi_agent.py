"""What a HAV under Reserve does among others, step by step.

It stands until it has reserved something, and moves only within what it has reserved. Before it
comes to the end of that it reserves the next part of its path; where that is not possible it looks
for another path, and in the end goes round the circle that it has reserved until there is one.
"""

import math

from baselines.policies.reserve.memory.rows import (
    ADOPTED,
    AFTER,
    ARRIVED,
    BEFORE,
    BLOCKED,
    CIRCLE,
    CLEAR,
    DOOMED,
    DRIVEN,
    END,
    EXPLORED,
    FAILED,
    GATHERED,
    GOAL,
    GOALS_LEFT,
    HELD,
    MARGIN,
    MODE,
    MOST_TRAILERS,
    NUM_SLOTS,
    NUMBER,
    OWN_DICE,
    OWN_FRONT,
    OWN_GOALS_LEFT,
    OWN_REACH,
    OWN_SAG,
    OWN_STEEPEST,
    OWN_STEP,
    OWN_STRIDE,
    PATH,
    PREFERRED,
    PURPOSE,
    RADIUS,
    REFRESH,
    RESERVED,
    SAG,
    SEGMENTS,
    SIDE,
    STAMP,
    STANDING,
    STRANGERS,
    STRIDE,
    TRIES,
)
from baselines.policies.reserve.path_search import (
    reserve_next,
    stands_test,
)
from baselines.policies.reserve.perception.gathering import gather
from baselines.policies.reserve.perception.other_agents import (
    has_company_changed,
    is_known,
    note_company,
    reserved_gap,
    slot_at,
)
from baselines.policies.reserve.perception.own_state import (
    goal_seen,
    is_due,
    sag,
    sense_itself,
    sense_joints,
    stride,
)
from baselines.policies.reserve.prediction.chain import keeps_clear_of, place_axles
from baselines.policies.reserve.prediction.holding_circle import go_round
from baselines.policies.reserve.prediction.motion import (
    advance_chain,
    command,
    follow,
    path_heading,
    sense_chain,
)
from baselines.policies.reserve.replanning import KEEP, begin, find_way_out, plan
from baselines.policies.reserve.reservation import ROUNDING, reserve_rest
from baselines.policies.reserve.single_agent import SURELY, hits_goal
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import sincos

_SAGS = 6.0  # that rolling wheels may be away from the simulator's next places, as measured
_LEAD = 1.0  # [m] before the end of what is reserved, where the next part is asked for
_RENEW = 0.3  # of the margin of the plan is the margin of a next part
_ANYWHERE = 1e9  # [m]
_WIDER = 1.01  # an outline's corners are at most 1 / cos(pi / 24) times as far as its contents
_MAYBE = 1.0 + 1e-9  # of the tolerances of a goal: what is outside is not hit


@rare_kernel
def act_among_others(policy, rows, memory, world, agent, lane):
    """Return speed [m/s] and steering [rad]."""
    if sense_itself(policy, rows, world, agent, lane):
        _take_back(rows)
    # who is asked has not arrived
    if rows[GOALS_LEFT] != rows[OWN_GOALS_LEFT] or rows[MODE] == ARRIVED:
        _take_goal(rows)
    changed = rows[MODE] == RESERVED and has_company_changed(
        policy, rows, memory, world, agent, lane
    )
    radius = _ANYWHERE if changed else _attention(policy, rows)
    rows[GATHERED] = 0.0
    if radius > 0.0:
        sense_joints(rows, world, agent, lane)
        gather(policy, rows, memory, world, agent, lane, radius)
        rows[GATHERED] = 1.0
    stood = rows[MODE] == STANDING
    turn, distance = think(policy, rows, changed)
    # who begins has just looked at everybody in range: only they are no newcomers later
    if changed or (stood and rows[HELD] > 0.0):
        note_company(policy, rows, memory, world, agent, lane)
    return command(policy, rows, turn, distance)


@kernel
def _take_back(rows):
    """Forget the step before if it was decided: the HAV has stood instead."""
    moved = False
    for row in range(4):
        moved = moved | (rows[AFTER + row] != rows[BEFORE + row])
        rows[AFTER + row] = rows[BEFORE + row]
    if moved:
        rows[DRIVEN] -= rows[OWN_STEP]


@kernel
def _attention(policy, rows):
    """Return how far round [m] others matter in this step, 0.0 when nothing is to be decided."""
    if not policy.broadcast:
        return _ANYWHERE
    if rows[MODE] == STANDING:
        return _ANYWHERE if rows[TRIES] == 0.0 or is_due(rows, 5) else 0.0
    rest = rows[END] - rows[DRIVEN]
    reach = _WIDER * rows[OWN_REACH] + 1.0  # outlines are wider than what they hold
    if not _may_move(rows):
        return _ANYWHERE
    if (rows[PURPOSE] == CIRCLE or rows[DOOMED] > 0.0) and is_due(rows, 15):
        return _ANYWHERE
    if rows[SIDE] == 0.0:
        return _WIDER * rest + reach if rows[DRIVEN] >= rows[REFRESH] else 0.0
    far = _WIDER * (policy.part + 4.0 * rows[OWN_FRONT]) + reach
    return far if rest <= _lead(policy, rows) else 0.0


@kernel
def _lead(policy, rows):
    """Return how long before the end of what is reserved the next part is asked for [m]."""
    return _LEAD + (policy.turns - 1) * rows[OWN_STEP]


@rare_kernel
def think(policy, rows, changed):
    """Decide on the next step; return its turn [rad] and its distance [m].

    Args:
        changed: whether other HAVs are in sensing range, or stand, than in the step before.
    """
    for row in range(4):
        rows[BEFORE + row] = rows[AFTER + row]
    if rows[MODE] == STANDING:
        rows[RADIUS] = 0.0
        if hits_goal(policy, *goal_seen(rows), SURELY):
            return 0.0, 0.0
        if rows[TRIES] == 0.0 or is_due(rows, 5):
            begin(policy, rows)
        if rows[MODE] == STANDING:
            return 0.0, 0.0
    elif changed:
        _look_again(policy, rows)
    _go_on_reserving(policy, rows)
    if not _may_move(rows):
        find_way_out(policy, rows)
    elif (rows[PURPOSE] == CIRCLE or rows[DOOMED] > 0.0) and is_due(rows, 15):
        plan(policy, rows, policy.margin)
    if rows[MODE] == STANDING:
        return 0.0, 0.0
    rows[STAMP] = rows[OWN_DICE + 2] + 1.0
    if not _may_move(rows) or not (policy.broadcast or _step_is_clear(rows)):
        rows[BLOCKED] += 1.0
        return 0.0, 0.0
    rows[BLOCKED] = 0.0
    return _move(policy, rows)


@kernel
def _take_goal(rows):
    rows[GOALS_LEFT] = rows[OWN_GOALS_LEFT]
    rows[MODE], rows[PATH + SEGMENTS], rows[PURPOSE] = STANDING, 0.0, GOAL
    rows[BLOCKED], rows[FAILED], rows[TRIES], rows[HELD] = 0.0, 0.0, 0.0, 0.0
    rows[ADOPTED], rows[EXPLORED] = 0.0, 0.0
    if rows[PREFERRED] == 0.0:
        rows[PREFERRED] = 1.0


@rare_kernel
def _look_again(policy, rows):
    """Compare what is reserved with those who came near: it is held only if they agree."""
    extent = math.sqrt(rows[AFTER] * rows[AFTER] + rows[AFTER + 1] * rows[AFTER + 1])
    agree = rows[STRANGERS] == 0.0 or extent + rows[RADIUS] <= rows[CLEAR]
    for number in range(int(rows[NUM_SLOTS])):
        slot = slot_at(number)
        known = policy.broadcast and is_known(rows, rows[slot + NUMBER])
        if not known and reserved_gap(rows, slot) <= 0.0:
            agree = False
    if not agree:
        heading = path_heading(rows)
        if not reserve_next(policy, rows, PATH, rows[DRIVEN], heading, rows[PURPOSE], KEEP):
            rows[HELD] = 0.0
    if rows[PURPOSE] != CIRCLE and rows[SIDE] != 0.0:
        margin = 0.5 * _RENEW * rows[MARGIN]
        passes = stands_test(policy, rows, PATH, rows[DRIVEN], rows[PURPOSE], -1.0, margin)
        rows[DOOMED] = 0.0 if passes else 1.0


@rare_kernel
def _go_on_reserving(policy, rows):
    """Reserve the next part of the path when the end of what is reserved comes near.

    On the rest to a goal, reserve what is left of it from time to time, to give way. On a circle
    with somebody inside, look at the next rounds.
    """
    driven, end = rows[DRIVEN], rows[END]
    if rows[PATH + SEGMENTS] == 0.0:
        return
    heading = path_heading(rows)
    if rows[SIDE] == 0.0 and rows[HELD] > 0.0:
        if driven >= rows[REFRESH]:
            rows[REFRESH] = driven + policy.refresh
            if rows[GATHERED] > 0.0:
                reserve_rest(policy, rows, PATH, driven, heading, KEEP)
        return
    step = rows[OWN_STEP]
    at_end = end - driven < step
    if end - driven > _lead(policy, rows):
        return
    if at_end and rows[BLOCKED] > 0.0 and not is_due(rows, 3):
        return
    if rows[PURPOSE] == CIRCLE:
        if rows[GATHERED] > 0.0 and rows[HELD] > 0.0:
            go_round(rows, PATH, driven, heading, 0.0)
        return
    if rows[GATHERED] > 0.0:
        margin = KEEP if at_end else _RENEW * rows[MARGIN]
        reserve_next(policy, rows, PATH, driven, heading, rows[PURPOSE], margin)


@kernel
def _may_move(rows):
    """Tell whether the next step is within what is reserved."""
    step = rows[OWN_STEP]
    return (
        (rows[HELD] > 0.0)
        & (rows[PATH + SEGMENTS] > 0.0)
        & (rows[DRIVEN] + step <= rows[END] + ROUNDING)
    )


@rare_kernel
def _step_is_clear(rows):
    """Tell whether the HAV is still clear of all others after its next step, if they take one too.

    That is all that it can see to when nobody tells what is reserved.
    """
    turn, distance = follow(rows)
    sense_chain(rows)
    x, y, _ = advance_chain(rows, 0.0, 0.0, turn, distance)
    place_axles(rows, x, y)
    # of those in no slot it is known only that their units are at least half as long as a step
    step, steepest = rows[OWN_STEP], rows[OWN_STEEPEST]
    most = stride(step, steepest, 0.5 * step, MOST_TRAILERS)
    most += 2.0 * _SAGS * sag(step, steepest, 0.5 * step)
    if rows[OWN_REACH] + rows[OWN_STRIDE] + most > rows[CLEAR]:
        return False
    for number in range(int(rows[NUM_SLOTS])):
        slot = slot_at(number)
        # before the end of the step, what is left of one stride and what is done of the other
        # are together no longer than the longer one
        margin = max(rows[OWN_STRIDE], rows[slot + STRIDE])
        margin += _SAGS * (rows[OWN_SAG] + rows[slot + SAG])
        if not keeps_clear_of(rows, slot, margin):
            return False
    return True


@rare_kernel
def _move(policy, rows):
    """Take the next step of the path, and tell the others where the outline's frame is then."""
    turn, distance = follow(rows)
    rows[DRIVEN] += distance
    sine, cosine = sincos(turn)
    dx, dy = distance * cosine, distance * sine
    x, y = rows[AFTER] - dx, rows[AFTER + 1] - dy
    rows[AFTER], rows[AFTER + 1] = x * cosine + y * sine, y * cosine - x * sine
    along, left = rows[AFTER + 2], rows[AFTER + 3]
    rows[AFTER + 2], rows[AFTER + 3] = along * cosine + left * sine, left * cosine - along * sine
    goal_x, goal_y, goal_heading = goal_seen(rows)
    if hits_goal(policy, goal_x - dx, goal_y - dy, goal_heading - turn, _MAYBE):
        rows[MODE] = ARRIVED  # if it has not after all, it will be asked, and begins anew
    return turn, distance
