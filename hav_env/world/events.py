"""This module tests and records events: jackknifes, collisions, goal hits, close misses."""

import math

from hav_env.compiled import fixed, kernel, rare_kernel
from hav_env.maths.dubins import path_length
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import wrap
from hav_env.world.arrays import (
    ACTUAL,
    ARTICULATION,
    CLOSEST,
    COSINE,
    DISTANCE,
    DUBINS,
    EUCLIDEAN_MISS,
    FEW,
    HEADING,
    HEADING_MISS,
    HIT_DISTANCE,
    HIT_HEADING,
    HIT_PATH,
    HIT_STEP,
    JACKKNIFE,
    LARGEST,
    MISS_ARTICULATION,
    MISS_COUNT,
    MISS_DISTANCE,
    MISS_HEADING,
    MOVED,
    NEVER,
    PATH,
    PHASE,
    POTENTIAL,
    SINE,
    STABLE,
    STEP,
    WHEN,
    WHERE,
    X,
    Y,
    goal_under_way,
    into_truck_frame,
)
from hav_env.world.collision import actual_collision, boxes_overlap, potential_collision
from hav_env.world.continuous_collision import collision_between


@kernel
def clear_record(record, lane):
    """Forget everything: the episode begins."""
    record.first[..., lane] = NEVER
    record.total[..., lane] = 0.0
    record.goal[..., lane] = math.nan
    record.goal[:, :, HIT_STEP, lane] = NEVER
    record.miss[..., lane] = math.nan
    record.miss[:, :, :, MISS_COUNT, lane] = 0.0


@kernel
def jackknifed(articulation, limit):
    """Tell whether an articulation [rad] is beyond its limit in (0, pi], eq. (cos_delta_lim)."""
    _, cosine = sincos(articulation)
    _, cosine_limit = sincos(limit)
    return cosine < cosine_limit


@kernel
def record_motion(dt, world, agent):
    """Record the driven path and the largest articulation, and look for the first jackknife.

    Returns:
        In how many lanes the HAV may have jackknifed.
    """
    state, total = world.state, world.record.total
    for lane in range(world.lanes):
        total[agent, PATH, lane] += state.speed[agent, lane] * dt
        total[agent, MOVED, lane] += 0.0 if state.waiting[agent, lane] else 1.0
    for unit in range(1, world.units):
        for lane in range(world.lanes):
            size = abs(state.heading[agent, unit, lane] - state.heading[agent, unit - 1, lane])
            size = size if unit <= world.fleet.num_trailers[agent, lane] else 0.0
            total[agent, LARGEST, lane] = max(total[agent, LARGEST, lane], size)
    news = 0
    for lane in range(world.lanes):
        news += _may_jackknife(world, agent, lane)
    if news > 0:
        _record_jackknifes(world, agent)
    return news


@kernel
def _may_jackknife(world, agent, lane):
    """Tell whether a HAV that never jackknifed has been beyond its limit; below, none can."""
    beyond = world.record.total[agent, LARGEST, lane] > world.fleet.limit[agent, ARTICULATION, lane]
    return beyond & (world.record.first[agent, JACKKNIFE, WHEN, lane] == NEVER)


@rare_kernel
def _record_jackknifes(world, agent):
    first = world.record.first
    for lane in range(world.lanes):
        if not _may_jackknife(world, agent, lane):
            continue
        limit = world.fleet.limit[agent, ARTICULATION, lane]
        for unit in range(1, world.fleet.num_trailers[agent, lane] + 1):
            ahead = world.state.heading[agent, unit - 1, lane]
            articulation = world.state.heading[agent, unit, lane] - ahead
            if abs(articulation) > limit and jackknifed(articulation, limit):
                first[agent, JACKKNIFE, WHEN, lane] = world.state.clock[STEP, lane]
                first[agent, JACKKNIFE, WHERE, lane] = unit
                break


@kernel
def record_collisions(task, world):
    """Record the first potential and the first actual collision of every HAV.

    Actual collisions between steps count if the task says so.

    Returns:
        How many pairs of HAVs may have collided for the first time.
    """
    num_havs, all_news = world.state.x.shape[0], 0
    if num_havs <= FEW:
        for agent in range(num_havs):
            for other in range(agent + 1, num_havs):
                news = 0
                for lane in range(world.lanes):
                    news += _may_be_news(world, agent, other, lane)
                if news > 0:
                    _record_pairs(task, world, agent, other)
                all_news += news
    else:
        for lane in range(world.lanes):
            for agent in range(num_havs):
                for k in range(world.nearby.count[agent, lane]):
                    other = world.nearby.index[agent, k, lane]
                    if other > agent:  # a pair is looked at once
                        _record_pair(task, world, agent, other, lane)
                        all_news += 1
    return all_news


@kernel
def _may_be_news(world, agent, other, lane):
    """Tell whether there is a first potential collision, or maybe a first actual one."""
    first = world.record.first
    potential = _is_new(first, POTENTIAL, agent, other, lane)
    actual = _is_new(first, ACTUAL, agent, other, lane)
    return (potential & potential_collision(world, agent, other, lane)) | (
        actual & boxes_overlap(world, agent, other, lane)
    )


@kernel
def _is_new(first, event, agent, other, lane):
    own, others = first[agent, event, WHEN, lane], first[other, event, WHEN, lane]
    return (own == NEVER) | (others == NEVER)


@rare_kernel
def _record_pairs(task, world, agent, other):
    for lane in range(world.lanes):
        _record_pair(task, world, agent, other, lane)


@kernel
def _record_pair(task, world, agent, other, lane):
    first = world.record.first
    new_potential = _is_new(first, POTENTIAL, agent, other, lane)
    if new_potential and potential_collision(world, agent, other, lane):
        _record_both(world, POTENTIAL, agent, other, lane)
    new_actual = _is_new(first, ACTUAL, agent, other, lane)
    may_touch = new_actual and boxes_overlap(world, agent, other, lane)
    between = task.continuous_collisions
    if may_touch and (
        (between and collision_between(world, agent, other, lane))
        or (not between and actual_collision(world, agent, other, lane))
    ):
        _record_both(world, ACTUAL, agent, other, lane)


@kernel
def _record_both(world, event, agent, other, lane):
    _record_first(world, event, agent, other, lane)
    _record_first(world, event, other, agent, lane)


@kernel
def _record_first(world, event, agent, partner, lane):
    first = world.record.first
    if first[agent, event, WHEN, lane] == NEVER:
        first[agent, event, WHEN, lane] = world.state.clock[STEP, lane]
        first[agent, event, WHERE, lane] = partner


@kernel
def goal_distance(state, agent, lane):
    """Return how far [m] the goal under way is."""
    dx = state.goal[agent, X, lane] - state.x[agent, lane]
    dy = state.goal[agent, Y, lane] - state.y[agent, lane]
    return math.sqrt(dx * dx + dy * dy)


@kernel
def goals_hit(world, agent, lane):
    """Return how many goals a HAV has hit."""
    return world.state.goal[agent, PHASE, lane] + (1.0 if world.state.waiting[agent, lane] else 0.0)


@rare_kernel
def assign_goal(world, agent, lane, phase):
    """Put one of a HAV's goals under way; record its Dubins distance with R_min."""
    state = world.state
    state.goal[agent, PHASE, lane] = phase
    state.waiting[agent, lane] = False
    heading = world.goals[agent, phase, 2, lane]
    sine, cosine = sincos(heading)
    state.goal[agent, X, lane] = world.goals[agent, phase, 0, lane]
    state.goal[agent, Y, lane] = world.goals[agent, phase, 1, lane]
    state.goal[agent, HEADING, lane] = heading
    state.goal[agent, COSINE, lane] = cosine
    state.goal[agent, SINE, lane] = sine
    state.goal[agent, DISTANCE, lane] = goal_distance(state, agent, lane)
    dx = state.goal[agent, X, lane] - state.x[agent, lane]
    dy = state.goal[agent, Y, lane] - state.y[agent, lane]
    forward, left = into_truck_frame(state, agent, lane, dx, dy)
    turn = heading - state.heading[agent, 0, lane]
    radius = world.fleet.radius[agent, STABLE, lane]
    goal = world.record.goal
    goal[agent, phase, DUBINS, lane] = path_length(forward, left, turn, radius)
    goal[agent, phase, CLOSEST, lane] = state.goal[agent, DISTANCE, lane]


@kernel
def record_approach(task, world, agent):
    """Record the approach to the goal under way; let the HAV wait when it hits the goal.

    Returns:
        In how many lanes a goal was hit.
    """
    state, near = world.state, 2.0 * task.distance_tolerance
    looks = 0
    for lane in range(world.lanes):
        distance = goal_distance(state, agent, lane)
        state.goal[agent, DISTANCE, lane] = distance
        looks += (distance < near) & (not state.waiting[agent, lane])
    for phase in range(world.goals.shape[1]):
        closest = world.record.goal[agent, fixed(phase), CLOSEST]
        for lane in range(world.lanes):
            least = min(closest[lane], state.goal[agent, DISTANCE, lane])
            closest[lane] = least if state.goal[agent, PHASE, lane] == phase else closest[lane]
    return _look_closely(task, world, agent) if looks > 0 else 0


@rare_kernel
def _look_closely(task, world, agent):
    """Look for hits and close misses in all lanes; return how many hits there are."""
    state, hits = world.state, 0
    for lane in range(world.lanes):
        distance = state.goal[agent, DISTANCE, lane]
        if state.waiting[agent, lane] or distance >= 2.0 * task.distance_tolerance:
            continue
        turn = abs(wrap(state.goal[agent, HEADING, lane] - state.heading[agent, 0, lane]))
        near, aligned = distance < task.distance_tolerance, turn < task.heading_tolerance
        if near and aligned:
            hits += 1
            state.waiting[agent, lane] = True
            _record_hit(world, agent, lane, distance, turn)
        elif near and turn < 2.0 * task.heading_tolerance:
            _record_miss(world, agent, lane, HEADING_MISS, distance, turn)
        elif aligned:
            _record_miss(world, agent, lane, EUCLIDEAN_MISS, distance, turn)
    return hits


@kernel
def _record_hit(world, agent, lane, distance, turn):
    goal, phase = world.record.goal, goal_under_way(world.state, agent, lane)
    goal[agent, phase, HIT_STEP, lane] = world.state.clock[STEP, lane]
    goal[agent, phase, HIT_DISTANCE, lane] = distance
    goal[agent, phase, HIT_HEADING, lane] = turn
    goal[agent, phase, HIT_PATH, lane] = world.record.total[agent, PATH, lane]


@kernel
def _record_miss(world, agent, lane, kind, distance, turn):
    """Count a close miss; keep the narrowest one, by the measure that was missed."""
    heading, miss = world.state.heading, world.record.miss
    at = agent, goal_under_way(world.state, agent, lane), kind
    narrowest, value = miss[(*at, MISS_DISTANCE, lane)], distance
    if kind == HEADING_MISS:
        narrowest, value = miss[(*at, MISS_HEADING, lane)], turn
    miss[(*at, MISS_COUNT, lane)] += 1.0
    if miss[(*at, MISS_COUNT, lane)] == 1.0 or value < narrowest:
        miss[(*at, MISS_DISTANCE, lane)] = distance
        miss[(*at, MISS_HEADING, lane)] = turn
        for joint in range(heading.shape[1] - 1):
            bend = heading[agent, joint + 1, lane] - heading[agent, joint, lane]
            miss[(*at, MISS_ARTICULATION + joint, lane)] = wrap(bend)
