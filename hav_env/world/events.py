"""This module tests and records events: jackknifes and collisions."""

from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import sincos
from hav_env.world.arrays import (
    ACTUAL,
    ARTICULATION,
    FEW,
    JACKKNIFE,
    LARGEST,
    MOVED,
    NEVER,
    PATH,
    POTENTIAL,
    STEP,
    WHEN,
    WHERE,
)
from hav_env.world.collision import actual_collision, boxes_overlap, potential_collision
from hav_env.world.continuous_collision import collision_between
from hav_env.world.task import records


@kernel
def jackknifed(articulation, limit):
    """Tell whether an articulation [rad] is beyond its limit in (0, pi], eq. (cos_delta_lim)."""
    _, cosine = sincos(articulation)
    _, cosine_limit = sincos(limit)
    return cosine < cosine_limit


@kernel
def record_motion(task, world, agent):
    """Record the driven path and the largest articulation, and look for the first jackknife.

    Returns:
        In how many lanes the HAV may have jackknifed.
    """
    state, total = world.state, world.record.total
    for lane in range(world.lanes):
        total[agent, PATH, lane] += state.speed[agent, lane] * task.dt
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
        _record_jackknifes(task, world, agent)
    return news


@kernel
def _may_jackknife(world, agent, lane):
    """Tell whether a HAV that never jackknifed has been beyond its limit; below, none can."""
    beyond = world.record.total[agent, LARGEST, lane] > world.fleet.limit[agent, ARTICULATION, lane]
    return beyond & (world.record.first[agent, JACKKNIFE, WHEN, lane] == NEVER)


@rare_kernel
def _record_jackknifes(task, world, agent):
    first = world.record.first
    for lane in range(world.lanes):
        recorded = records(task, world.state.clock[STEP, lane])
        if not (recorded and _may_jackknife(world, agent, lane)):
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
    # wider circles than the text's may meet out of sensing range
    widened = task.potential_center > 0.0 or task.potential_truck_share > 0.0
    if num_havs <= FEW or widened:
        for agent in range(num_havs):
            for other in range(agent + 1, num_havs):
                news = 0
                for lane in range(world.lanes):
                    news += _may_be_news(task, world, agent, other, lane)
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
def _may_be_news(task, world, agent, other, lane):
    """Tell whether there is a first potential collision, or maybe a first actual one."""
    first = world.record.first
    potential = _is_new(first, POTENTIAL, agent, other, lane)
    actual = _is_new(first, ACTUAL, agent, other, lane)
    return (potential & potential_collision(task, world, agent, other, lane)) | (
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
    if not records(task, world.state.clock[STEP, lane]):
        return
    first = world.record.first
    new_potential = _is_new(first, POTENTIAL, agent, other, lane)
    if new_potential and potential_collision(task, world, agent, other, lane):
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
