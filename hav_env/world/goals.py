"""This module assigns goals, and records how HAVs approach, hit and narrowly miss them."""

from hav_env.compiled import fixed, kernel, rare_kernel
from hav_env.maths.dubins import path_length
from hav_env.maths.elementary import sincos, sqrt
from hav_env.maths.geometry import wrap
from hav_env.world.arrays import (
    CLOSEST,
    COSINE,
    DISTANCE,
    DUBINS,
    EUCLIDEAN_MISS,
    HEADING,
    HEADING_MISS,
    HIT_DISTANCE,
    HIT_HEADING,
    HIT_PATH,
    HIT_STEP,
    MISS_ARTICULATION,
    MISS_COUNT,
    MISS_DISTANCE,
    MISS_HEADING,
    PATH,
    PHASE,
    SINE,
    STABLE,
    STEP,
    X,
    Y,
    goal_under_way,
    into_truck_frame,
)
from hav_env.world.place.guidance import begin_route
from hav_env.world.task import records


@kernel
def goal_distance(state, agent, lane):
    """Return the distance [m] to the goal under way."""
    dx = state.goal[agent, X, lane] - state.x[agent, lane]
    dy = state.goal[agent, Y, lane] - state.y[agent, lane]
    return sqrt(dx * dx + dy * dy)


@kernel
def goals_hit(world, agent, lane):
    """Return the number of goals that a HAV has hit."""
    return world.state.goal[agent, PHASE, lane] + (1.0 if world.state.waiting[agent, lane] else 0.0)


@kernel
def assign_goal(world, agent, lane, phase):
    """Put one of a HAV's goals under way; find the route to it.

    The length that is recorded is that of the Dubins path with R_min, whatever route there is: so
    episodes are compared by one measure.
    """
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
    begin_route(world.guidance, world, agent, lane)
    goal[agent, phase, DUBINS, lane] = path_length(forward, left, turn, radius)
    goal[agent, phase, CLOSEST, lane] = state.goal[agent, DISTANCE, lane]


@kernel
def record_approach(task, world, agent):
    """Record the approach to the goal under way; let the HAV wait when it hits the goal.

    Returns:
        Number of lanes in which a goal was hit.
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
            # a waiting HAV may roll on
            counts = (state.goal[agent, PHASE, lane] == phase) & (not state.waiting[agent, lane])
            closest[lane] = least if counts else closest[lane]
    return _look_closely(task, world, agent) if looks > 0 else 0


@rare_kernel
def _look_closely(task, world, agent):
    """Look for hits and close misses in all lanes; return the number of hits."""
    state, hits = world.state, 0
    for lane in range(world.lanes):
        distance = state.goal[agent, DISTANCE, lane]
        if state.waiting[agent, lane] or distance >= 2.0 * task.distance_tolerance:
            continue
        turn = abs(wrap(state.goal[agent, HEADING, lane] - state.heading[agent, 0, lane]))
        near, aligned = distance < task.distance_tolerance, turn < task.heading_tolerance
        recorded = records(task, state.clock[STEP, lane])
        if near and aligned:
            if state.speed[agent, lane] <= task.goal_speed:
                hits += 1
                state.waiting[agent, lane] = True
                _record_hit(world, agent, lane, distance, turn)
        elif recorded and near and turn < 2.0 * task.heading_tolerance:
            _record_miss(world, agent, lane, HEADING_MISS, distance, turn)
        elif recorded and aligned:
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
    """Count a close miss; record the narrowest one, by the measure that was missed."""
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
