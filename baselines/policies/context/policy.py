"""This module is context steering: interest and danger over steering slots, masks by the filter."""

import math

from baselines.policies.context.courses import COURSES, arrives, attraction, course_of
from baselines.policies.context.memory import (
    BANS,
    BLOCKED_STEPS,
    CIRCLED,
    COMMITTED,
    DROVE,
    GOALS,
    LAST,
    MARKS,
    TRIAL_SCRATCH,
    TRIED,
    UNDER_WAY,
    VALUES,
)
from baselines.policies.context.outlook import (
    circles,
    free_way,
    gap_to_others,
    near_others,
)
from baselines.policies.context.parameters import Context
from baselines.policies.context.slots import is_masked, widest_steering
from hav_env.compiled import kernel, lanes_from, rare_kernel
from hav_env.maths.elementary import sincos
from hav_env.policies.filtered import MOST_FILTERED_TRAILERS
from hav_env.policies.interface import act_lanes, memory_size
from hav_env.safety import SafetyFilter, keep_safe, scratch_rows
from hav_env.safety.trial_moves import keep_posture, put_back
from hav_env.world.lanes import block_of
from hav_env.world.sensing import (
    goal_pose,
    goals_left,
    limits,
    neighbor_before_front,
    num_neighbors,
)

_TRIAL_ROWS = scratch_rows(SafetyFilter(), MOST_FILTERED_TRAILERS + 1)


@memory_size.register
def _(policy: Context) -> int:
    return TRIAL_SCRATCH + _TRIAL_ROWS


@act_lanes.register(Context)
def steer_by_context(policy, memory, world, agent, speed, steering):
    """Choose the slot with the largest interest minus danger; its command passes the filter."""
    for lane in range(world.lanes):
        if not world.state.waiting[agent, lane]:
            _choose_slot(
                policy,
                lanes_from(memory[agent], lane),
                block_of(world, lane, 1, world.units),
                agent,
                lanes_from(speed, lane),
                lanes_from(steering, lane),
            )
    rows = memory[agent, TRIAL_SCRATCH:]
    keep_safe(policy.safety, policy, policy.vehicle, world, agent, speed, steering, rows)


@kernel
def _angle_of(policy, slot, steepest):
    return steepest * (2.0 * slot / (policy.slots - 1.0) - 1.0)


@rare_kernel
def _choose_slot(policy, mine, world, agent, speed, steering):
    full, _, _ = limits(world, agent, 0)
    steepest = widest_steering(policy, world, agent)
    _count_steps(policy, mine, world, agent)
    near = near_others(world, agent, policy.look)
    rows = mine[TRIAL_SCRATCH:]
    keep_posture(world, agent, rows)
    _try_course(policy, mine, world, agent, speed, steering, rows)
    wanted = steepest * attraction(policy, course_of(mine), world, agent)
    _rate_slots(policy, mine, world, agent, wanted, near)
    keep = min(policy.keep, 0.8 * gap_to_others(world, agent, policy.keep)) if near else 0.0
    chosen = -1
    while True:
        best = -1
        for slot in range(policy.slots):
            if mine[MARKS + slot, 0] < 2.0 and (
                best < 0 or mine[VALUES + slot, 0] > mine[VALUES + best, 0]
            ):
                best = slot
        if best < 0:
            break
        if mine[MARKS + best, 0] == 1.0:
            chosen = best
            break
        turned = _angle_of(policy, best, steepest)
        if is_masked(policy, mine, world, agent, best, turned, speed, steering, rows):
            mine[MARKS + best, 0] = 2.0
            continue
        mine[MARKS + best, 0] = 1.0
        if near:
            mine[VALUES + best, 0] -= _danger(
                policy, mine, world, agent, turned, wanted, keep, speed, steering, rows
            )
    put_back(world, agent, rows)
    if chosen >= 0 and mine[BLOCKED_STEPS, 0] < policy.recovery:
        chosen = -1 if mine[VALUES + chosen, 0] < -policy.pause else chosen
    if chosen < 0:
        speed[agent, 0], steering[agent, 0] = 0.0, 0.0
        mine[DROVE, 0] = 0.0
        mine[BLOCKED_STEPS, 0] = min(mine[BLOCKED_STEPS, 0] + 1.0, 1.0 * policy.recovery)
    else:
        speed[agent, 0], steering[agent, 0] = full, _angle_of(policy, chosen, steepest)
        off = abs(steering[agent, 0] - wanted) > 0.3 * steepest
        change = 1.0 if off else -1.0
        mine[BLOCKED_STEPS, 0] = min(
            max(mine[BLOCKED_STEPS, 0] + change, 0.0), 1.0 * policy.recovery
        )
        mine[LAST, 0], mine[DROVE, 0] = steering[agent, 0], 1.0
        if abs(steering[agent, 0] - wanted) > 1e-6:
            mine[COMMITTED, 0] = 0.0


@kernel
def _count_steps(policy, mine, world, agent):
    left = goals_left(world, agent, 0)
    if mine[GOALS, 0] != left:
        mine[GOALS, 0] = left
        mine[UNDER_WAY, 0] = mine[BLOCKED_STEPS, 0] = mine[COMMITTED, 0] = mine[TRIED, 0] = 0.0
        for slot in range(policy.slots):
            mine[BANS + slot, 0] = 0.0
    mine[UNDER_WAY, 0] += 1.0


@rare_kernel
def _try_course(policy, mine, world, agent, speed, steering, rows):
    """Try the next course periodically, unless the present one leads to the goal."""
    if mine[COMMITTED, 0] != 0.0 or int(mine[UNDER_WAY, 0]) % policy.every != 1:
        return
    if mine[DROVE, 0] == 0.0 and mine[UNDER_WAY, 0] > 1.0:
        return
    before = mine[TRIED, 0]
    for _ in range(COURSES):
        strict = int(mine[TRIED, 0]) // COURSES % 2 == 0
        keep = policy.keep if strict else -1.0
        found = arrives(
            policy, course_of(mine), world, agent, policy.patience, keep, speed, steering
        )
        put_back(world, agent, rows)
        if found:
            mine[COMMITTED, 0] = 1.0
            return
        mine[TRIED, 0] += 1.0
        if policy.tries <= mine[TRIED, 0] - before:
            return


@kernel
def _rate_slots(policy, mine, world, agent, wanted, near):
    steepest = widest_steering(policy, world, agent)
    growth = mine[BLOCKED_STEPS, 0] / policy.recovery if near else 0.0
    ahead, aside = 0.0, 0.0
    if growth > 0.0:
        least = math.inf
        for k in range(num_neighbors(world, agent, 0)):
            forward, left = neighbor_before_front(world, agent, k, 0)
            squared = forward * forward + left * left
            if squared < least:
                least, ahead, aside = squared, -forward, -left
        distance = math.sqrt(least) + 1e-9
        ahead, aside = ahead / distance, aside / distance
    for slot in range(policy.slots):
        turned = _angle_of(policy, slot, steepest)
        value = 1.0 - abs(turned - wanted) / (2.0 * steepest)
        sine, cosine = sincos(turned)
        value += growth * policy.evade * (ahead * cosine + aside * sine)
        value -= growth * policy.side * turned / steepest
        value -= 1e-7 * abs(turned - mine[LAST, 0])
        mine[VALUES + slot, 0], mine[MARKS + slot, 0] = value, 0.0


@rare_kernel
def _danger(policy, mine, world, agent, turned, wanted, keep, speed, steering, rows):
    side = 1.0 if mine[CIRCLED, 0] >= 0.0 else -1.0
    if policy.escape == 0.0 or circles(policy, world, agent, side, keep):
        return 0.0
    if circles(policy, world, agent, -side, keep):
        mine[CIRCLED, 0] = -side
        return 0.0
    free = free_way(policy, world, agent, turned, keep)
    if abs(turned - wanted) < 1e-6 and _gets_there(
        policy, mine, world, agent, keep, speed, steering
    ):
        return 0.0
    return policy.escape + policy.avoid * (1.0 - free / policy.look)


@rare_kernel
def _gets_there(policy, mine, world, agent, keep, speed, steering):
    """Return whether the HAV is so near to its goal that its course leads there past the others."""
    forward, left, _ = goal_pose(world, agent, 0)
    if forward * forward + left * left > policy.look * policy.look:
        return False
    full, _, _ = limits(world, agent, 0)
    horizon = int(2.0 * policy.look / (policy.dt * full))
    return arrives(policy, course_of(mine), world, agent, horizon, keep, speed, steering)
