"""This module tests and records events: jackknifes and collisions."""

from hav_env.compiled import fixed, kernel, rare_kernel
from hav_env.maths.elementary import sincos
from hav_env.world.arrays import (
    ACTUAL,
    ARTICULATION,
    CLOSE,
    HANDFUL,
    HIGHER,
    JACKKNIFE,
    LARGEST,
    LOWER,
    MOVED,
    NEVER,
    PATH,
    POTENTIAL,
    STEP,
    WHEN,
    WHERE,
)
from hav_env.world.bodies import bodies_meet, box_at, boxes_overlap, enclose, enclose_in
from hav_env.world.collision import potential_collision
from hav_env.world.continuous_collision import box_of_way, collision_between, may_meet
from hav_env.world.neighborhood import as_place, in_range, may_touch
from hav_env.world.task import records
from hav_env.world.units.joints import joint_limit

# boxes of all HAVs are found in lanes if there are as many close pairs as HAVs over this number
_SEVERAL = 4


@kernel
def jackknifed(articulation, limit):
    """Return whether an articulation [rad] is beyond its limit in (0, pi], eq. (4)."""
    _, cosine = sincos(articulation)
    _, cosine_limit = sincos(limit)
    return cosine < cosine_limit


@kernel
def record_motion(task, world, agent):
    """Record the driven path and the largest articulation."""
    state, total = world.state, world.record.total
    for lane in range(world.lanes):
        total[agent, PATH, lane] += state.speed[agent, lane] * task.dt
        total[agent, MOVED, lane] += 0.0 if state.waiting[agent, lane] else 1.0
    for unit in range(1, world.units):
        for lane in range(world.lanes):
            size = abs(state.heading[agent, unit, lane] - state.heading[agent, unit - 1, lane])
            size = size if unit <= world.fleet.num_trailers[agent, lane] else 0.0
            total[agent, LARGEST, lane] = max(total[agent, LARGEST, lane], size)


@kernel
def record_jackknifes(task, world, agent):
    """Look for the first jackknife of a HAV in every lane.

    Returns:
        Number of lanes in which the HAV may have jackknifed.
    """
    news = 0
    for lane in range(world.lanes):
        news += _may_jackknife(world, agent, lane)
    if news > 0:
        _record_those_beyond(task, world, agent)
    return news


@kernel
def _may_jackknife(world, agent, lane):
    """Return whether a HAV without a jackknife has exceeded its limit; below it, none can occur.

    If joints have limits of their own, the HAV's limit is the least of them.
    """
    beyond = world.record.total[agent, LARGEST, lane] > world.fleet.limit[agent, ARTICULATION, lane]
    return beyond & (world.record.first[agent, JACKKNIFE, WHEN, lane] == NEVER)


@rare_kernel
def _record_those_beyond(task, world, agent):
    first = world.record.first
    for lane in range(world.lanes):
        recorded = records(task, world.state.clock[STEP, lane])
        if not (recorded and _may_jackknife(world, agent, lane)):
            continue
        usual = world.fleet.limit[agent, ARTICULATION, lane]
        for unit in range(1, world.fleet.num_trailers[agent, lane] + 1):
            limit = joint_limit(world.fleet.joints, usual, agent, unit, lane)
            ahead = world.state.heading[agent, unit - 1, lane]
            articulation = world.state.heading[agent, unit, lane] - ahead
            if abs(articulation) > limit and jackknifed(articulation, limit):
                first[agent, JACKKNIFE, WHEN, lane] = world.state.clock[STEP, lane]
                first[agent, JACKKNIFE, WHERE, lane] = unit
                break


@kernel
def record_collisions(task, world):
    """Record the first potential and the first actual collision of every HAV.

    Actual collisions between steps count if the task states so. In larger swarms, the candidates of
    the neighbour search, which comes first, include all pairs that may have collided.

    Returns:
        Number of pairs of HAVs that collided for the first time.
    """
    num_havs = world.state.x.shape[0]
    few = num_havs <= HANDFUL
    close = _mark_close_pairs(task, world) if few else _count_candidates(world)
    if close == 0:
        return 0
    enclosed = _SEVERAL * close >= num_havs * world.lanes
    if enclosed:
        for agent in range(num_havs):
            enclose(world, fixed(agent))
    if few:
        return _record_marked_pairs(task, world, enclosed)
    return _record_candidates(task, world, enclosed)


@kernel
def _mark_close_pairs(task, world):
    """Find the pairs that may touch in small worlds: a bit for each pair, in every lane.

    Returns:
        Number of such pairs in all lanes: none in most steps, as lane loops find out.
    """
    num_havs, marks, found = world.state.x.shape[0], world.nearby.num_pairs, 0
    for lane in range(world.lanes):
        marks[lane] = 0
    for number in range(num_havs):
        for second in range(number + 1, num_havs):
            agent, other, bit = fixed(number), fixed(second), _bit_of(world, number, second)
            for lane in range(world.lanes):
                near = 1 if may_touch(task, world, agent, other, lane) else 0
                marks[lane] += bit * near
                found += near
    return found


@kernel
def _bit_of(world, agent, other):
    """Return the bit of a pair of HAVs in the marks of a small world."""
    return 1 << (agent * world.state.x.shape[0] + other)


@kernel
def _record_marked_pairs(task, world, enclosed):
    """Record the collisions of marked pairs in small worlds; see ``record_collisions``."""
    num_havs, marks, news = world.state.x.shape[0], world.nearby.num_pairs, 0
    for number in range(num_havs):
        for second in range(number + 1, num_havs):
            agent, other, bit = fixed(number), fixed(second), _bit_of(world, number, second)
            if enclosed:
                for lane in range(world.lanes):
                    due = _may_be_news(task, world, agent, other, lane)
                    marks[lane] &= -1 if due else ~bit
            for lane in range(world.lanes):
                if marks[lane] & bit and records(task, world.state.clock[STEP, lane]):
                    news += _record_close_pair(task, world, number, second, lane, enclosed)
    for lane in range(world.lanes):
        marks[lane] = 0
    return news


@kernel
def _may_be_news(task, world, agent, other, lane):
    """Return whether two HAVs whose boxes are known may have collided for the first time."""
    first = world.record.first
    potential = _is_new(first, POTENTIAL, agent, other, lane) & (
        potential_collision(task, world, agent, other, lane)
    )
    overlap = boxes_overlap(box_at(world, agent, lane), box_at(world, other, lane))
    overlap = overlap | (task.continuous_collisions != 0)
    return potential | (_is_new(first, ACTUAL, agent, other, lane) & overlap)


@kernel
def _count_candidates(world):
    """Return the number of pairs on the lists of candidates that may touch, in all lanes."""
    found = 0
    for lane in range(world.lanes):
        pair = world.nearby.pair[world.first + lane]
        for place in range(world.nearby.num_pairs[lane]):
            found += 1 if pair[place, CLOSE] else 0
    return found


@kernel
def _record_candidates(task, world, enclosed):
    """Record the collisions of the pairs on the lists of candidates; see ``record_collisions``."""
    news = 0
    for lane in range(world.lanes):
        if not records(task, world.state.clock[STEP, lane]):
            continue
        pair = world.nearby.pair[world.first + lane]
        for place in range(world.nearby.num_pairs[lane]):
            agent, other = as_place(pair[place, LOWER]), as_place(pair[place, HIGHER])
            if pair[place, CLOSE]:
                news += _record_close_pair(task, world, agent, other, lane, enclosed)
    return news


@kernel
def _record_close_pair(task, world, agent, other, lane, enclosed):
    """Record the new collisions of two HAVs that may touch; ``enclosed``: their boxes are known.

    A call passes on every array of a world, so it comes after the quick tests.
    """
    if not enclosed:
        for hav in (agent, other):
            enclose_in(world, hav, lane)
    if not _may_be_news(task, world, agent, other, lane):
        return 0
    return _record_pair(task, world, agent, other, lane)


@rare_kernel
def _record_pair(task, world, agent, other, lane):
    """Record the new potential and actual collisions of two HAVs; return their number."""
    first, news = world.record.first, 0
    if _is_new(first, POTENTIAL, agent, other, lane) and (
        potential_collision(task, world, agent, other, lane)
    ):
        _record_both(world, POTENTIAL, agent, other, lane)
        news += 1
    if _is_new(first, ACTUAL, agent, other, lane) and _collided(task, world, agent, other, lane):
        _record_both(world, ACTUAL, agent, other, lane)
        news += 1
    return news


@kernel
def _collided(task, world, agent, other, lane):
    """Return whether two HAVs touch, now or, if it counts, at any time since the step before."""
    bodies = world.fleet.bodies
    if task.continuous_collisions:
        return (
            in_range(task, world, agent, other, lane)
            and may_meet(world, agent, other, lane)
            and boxes_overlap(box_of_way(world, agent, lane), box_of_way(world, other, lane))
            and collision_between(world, agent, other, lane)
        )
    return boxes_overlap(box_at(world, agent, lane), box_at(world, other, lane)) and bodies_meet(
        bodies, world, agent, other, lane
    )


@kernel
def _is_new(first, event, agent, other, lane):
    own, others = first[agent, event, WHEN, lane], first[other, event, WHEN, lane]
    return (own == NEVER) | (others == NEVER)


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
