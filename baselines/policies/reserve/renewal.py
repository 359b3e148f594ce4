"""This module keeps the reservation of a moving HAV: it renews its part, and compares it anew."""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import states
from baselines.policies.reserve.path_search import reserve_next
from baselines.policies.reserve.perception.other_agents import reserved_gap, slot_at, was_near
from baselines.policies.reserve.perception.own_state import is_due
from baselines.policies.reserve.prediction.coarse_paths import is_drivable
from baselines.policies.reserve.prediction.holding_circle import extend_circle
from baselines.policies.reserve.prediction.motion import path_heading
from baselines.policies.reserve.replanning import (
    CONTINUE_MARGIN,
    find_shortcut,
    lead_distance,
    may_find_shortcut,
)
from baselines.policies.reserve.reservation import reserve_rest
from hav_env.compiled import rare_kernel

_RENEW_PERIOD = 3  # steps from one attempt to do so to the next, for a HAV that is blocked
_NEXT_MARGIN_SHARE = 0.3  # of the plan's margin: kept by the next part of a path
_RECHECK_MARGIN_SHARE = 0.5  # of that: kept by the path ahead, so that it is not given up too soon
_NO_HORIZON = -1.0  # [m] no outline of others counts on the path ahead, only HAVs that stand


@rare_kernel
def recheck_reservation(policy, rows):
    """Compare the outline with those of newcomers, and the path ahead with HAVs that stand.

    If an outline overlaps, reserve the next part anew. The outline is not held if that fails.
    """
    x, y = rows[m.FRAME_AFTER], rows[m.FRAME_AFTER + 1]
    extent = math.sqrt(x * x + y * y)
    disjoint = rows[m.NEWCOMERS] == 0.0 or extent + rows[m.OUTLINE_RADIUS] <= rows[m.COVERED_RADIUS]
    for number in range(int(rows[m.NUM_SLOTS])):
        slot = slot_at(number)
        known = policy.broadcast and was_near(rows, rows[slot + m.SLOT_NUMBER])
        if not known and reserved_gap(rows, slot) <= 0.0:
            disjoint = False
    path, driven = m.CURRENT_PATH, rows[m.DRIVEN]
    if not disjoint:
        heading = path_heading(rows)
        purpose, margin = rows[m.PURPOSE], CONTINUE_MARGIN
        if not reserve_next(policy, rows, path, driven, heading, purpose, margin):
            rows[m.HELD] = 0.0
    if rows[m.PURPOSE] != states.CIRCLE_PATH and rows[m.CIRCLE_SIDE] != 0.0:
        margin = _RECHECK_MARGIN_SHARE * _NEXT_MARGIN_SHARE * rows[m.PLANNED_MARGIN]
        purpose = rows[m.PURPOSE]
        passes = is_drivable(policy, rows, path, driven, purpose, _NO_HORIZON, margin)
        rows[m.DOOMED] = 0.0 if passes else 1.0


@rare_kernel
def renew_reservation(policy, rows):
    """Reserve the next part of the path near the end of the reserved one.

    On the rest to a goal, reserve the remaining part from time to time, to give space to others. On
    a circle, extend the reserved part by the next turns.
    """
    driven, end = rows[m.DRIVEN], rows[m.PART_END]
    if rows[m.CURRENT_PATH + m.NUM_SEGMENTS] == 0.0:
        return
    heading = path_heading(rows)
    if rows[m.CIRCLE_SIDE] == 0.0 and rows[m.HELD] > 0.0:
        if driven >= rows[m.REFRESH]:
            rows[m.REFRESH] = driven + policy.refresh
            if rows[m.GATHERED] > 0.0:
                reserve_rest(policy, rows, m.CURRENT_PATH, driven, heading, CONTINUE_MARGIN)
        return
    step = rows[m.OWN_STEP]
    at_end = end - driven < step
    if end - driven > lead_distance(policy, rows):
        return
    if at_end and rows[m.BLOCKED] > 0.0 and not is_due(rows, _RENEW_PERIOD):
        return
    if rows[m.PURPOSE] == states.CIRCLE_PATH:
        if rows[m.GATHERED] > 0.0 and rows[m.HELD] > 0.0:
            extend_circle(rows, m.CURRENT_PATH, driven, heading, 0.0)
        return
    if rows[m.GATHERED] > 0.0:
        if may_find_shortcut(policy, rows) and find_shortcut(policy, rows):
            return
        margin = CONTINUE_MARGIN if at_end else _NEXT_MARGIN_SHARE * rows[m.PLANNED_MARGIN]
        reserve_next(policy, rows, m.CURRENT_PATH, driven, heading, rows[m.PURPOSE], margin)
