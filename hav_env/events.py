"""What can happen to a HAV (jackknife, collision, goal hit, close miss), tested and recorded."""

import math

from hav_env.collision import actual_collision, potential_collision
from hav_env.compiled import kernel, world_kernel
from hav_env.dubins import path_length
from hav_env.geometry import into_frame, wrap
from hav_env.world import (
    ACTUAL,
    ARTICULATION,
    CLOSEST,
    DUBINS,
    EUCLIDEAN_MISS,
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
    NEVER,
    PATH,
    PHASE,
    POTENTIAL,
    STABLE,
    STEP,
    WHEN,
    WHERE,
)


@world_kernel
def clear_record(record):
    """Forget everything: the episode begins."""
    record.first[:] = NEVER
    record.total[:] = 0.0
    record.goal[:] = math.nan
    record.goal[:, :, HIT_STEP] = NEVER
    record.miss[:] = math.nan
    record.miss[:, :, :, MISS_COUNT] = 0.0


@kernel
def jackknifed(articulation, limit):
    """Tell whether an articulation [rad] is beyond its limit in (0, pi], eq. (cos_delta_lim)."""
    return math.cos(articulation) < math.cos(limit)


@world_kernel
def record_articulation(world, agent):
    """Record the largest articulation and the first jackknife."""
    state, record = world.state, world.record
    limit = world.fleet.limit[agent, ARTICULATION]
    largest = record.total[agent, LARGEST]
    for unit in range(1, world.fleet.num_trailers[agent] + 1):
        articulation = state.heading[agent, unit] - state.heading[agent, unit - 1]
        size = abs(articulation)
        largest = max(largest, size)
        # a cosine is taken only beyond the limit: angles below it cannot jackknife
        is_first = size > limit and record.first[agent, JACKKNIFE, WHEN] == NEVER
        if is_first and jackknifed(articulation, limit):
            record.first[agent, JACKKNIFE, WHEN] = state.clock[STEP]
            record.first[agent, JACKKNIFE, WHERE] = unit
    record.total[agent, LARGEST] = largest


@world_kernel
def record_collisions(world):
    """Record the first potential and the first actual collision of every HAV."""
    first, step = world.record.first, world.state.clock[STEP]
    for agent in range(world.state.x.shape[0]):
        for k in range(world.nearby.count[agent]):
            other = world.nearby.index[agent, k]
            if other < agent:  # a pair is looked at once
                continue
            if _is_new(first, POTENTIAL, agent, other) and potential_collision(world, agent, other):
                _record_pair(first, POTENTIAL, agent, other, step)
            if _is_new(first, ACTUAL, agent, other) and actual_collision(world, agent, other):
                _record_pair(first, ACTUAL, agent, other, step)


@kernel
def _is_new(first, event, agent, other):
    return first[agent, event, WHEN] == NEVER or first[other, event, WHEN] == NEVER


@kernel
def _record_pair(first, event, agent, other, step):
    if first[agent, event, WHEN] == NEVER:
        first[agent, event, WHEN] = step
        first[agent, event, WHERE] = other
    if first[other, event, WHEN] == NEVER:
        first[other, event, WHEN] = step
        first[other, event, WHERE] = agent


@world_kernel
def goal_difference(world, agent):
    """Return distance [m] and absolute heading difference [rad] to the goal under way."""
    phase = world.state.clock[PHASE]
    dx = world.goals[agent, phase, 0] - world.state.x[agent]
    dy = world.goals[agent, phase, 1] - world.state.y[agent]
    turn = world.goals[agent, phase, 2] - world.state.heading[agent, 0]
    return math.sqrt(dx * dx + dy * dy), abs(wrap(turn))


@world_kernel
def record_assignment(world, agent):
    """Record how far the goal under way is along a Dubins path with the radius R_min."""
    state, phase = world.state, world.state.clock[PHASE]
    forward, left = into_frame(
        world.goals[agent, phase, 0] - state.x[agent],
        world.goals[agent, phase, 1] - state.y[agent],
        state.cosine[agent, 0],
        state.sine[agent, 0],
    )
    turn = world.goals[agent, phase, 2] - state.heading[agent, 0]
    radius = world.fleet.radius[agent, STABLE]
    world.record.goal[agent, phase, DUBINS] = path_length(forward, left, turn, radius)
    world.record.goal[agent, phase, CLOSEST], _ = goal_difference(world, agent)


@world_kernel
def record_goal(task, world, agent):
    """Record the approach to the goal under way; return whether the goal is hit."""
    phase = world.state.clock[PHASE]
    goal = world.record.goal[agent, phase]
    distance, turn = goal_difference(world, agent)
    goal[CLOSEST] = min(goal[CLOSEST], distance)
    near, aligned = distance < task.distance_tolerance, turn < task.heading_tolerance
    if near and aligned:
        goal[HIT_STEP] = world.state.clock[STEP]
        goal[HIT_DISTANCE] = distance
        goal[HIT_HEADING] = turn
        goal[HIT_PATH] = world.record.total[agent, PATH]
        return True
    if near and turn < 2.0 * task.heading_tolerance:
        miss = world.record.miss[agent, phase, HEADING_MISS]
        _record_miss(miss, MISS_HEADING, distance, turn, world.state.heading[agent])
    elif aligned and distance < 2.0 * task.distance_tolerance:
        miss = world.record.miss[agent, phase, EUCLIDEAN_MISS]
        _record_miss(miss, MISS_DISTANCE, distance, turn, world.state.heading[agent])
    return False


@kernel
def _record_miss(miss, measure, distance, turn, headings):
    """Count a close miss; keep the narrowest one, by the measure that was missed."""
    value = turn if measure == MISS_HEADING else distance
    miss[MISS_COUNT] += 1.0
    if miss[MISS_COUNT] == 1.0 or value < miss[measure]:
        miss[MISS_DISTANCE] = distance
        miss[MISS_HEADING] = turn
        for joint in range(headings.shape[0] - 1):
            miss[MISS_ARTICULATION + joint] = wrap(headings[joint + 1] - headings[joint])
