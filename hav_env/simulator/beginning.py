"""This module begins episodes, in blocks of worlds whose lanes all begin."""

import math

import numpy as np

from hav_env.compiled import fixed, generic, kernel, rare_kernel
from hav_env.scenarios import populate
from hav_env.world.arrays import HIT_STEP, MISS_COUNT, MISS_DISTANCE, NEVER, STEP
from hav_env.world.continuous_collision import note_axles
from hav_env.world.events import record_collisions
from hav_env.world.goals import assign_goal
from hav_env.world.neighborhood import find_nearby
from hav_env.world.obstacles.collisions import begin_among_obstacles
from hav_env.world.place.guidance import Dubins, OnFeasible, OnLattices, OnRoads, OnWitnesses
from hav_env.world.place.segments import OVERFULL, Obstacles, Plane, clear_place, num_segments
from hav_env.world.units.parts import Hitches, Lines, OnAxles, Outlines


@kernel
def begin(scenario, task, world, placed):
    """Start an episode in every lane of a block of worlds.

    Args:
        scenario: Model of fleets, start poses and goal poses.
        task: Rules of the episode.
        world: Block of worlds; its clock holds the seeds and the numbers of the episodes.
        placed: (W,) bool, to write: whether the scenario placed the HAVs.
    """
    state = world.state
    for lane in range(world.lanes):
        state.clock[STEP, lane] = 0
    for row in range(state.ahead.shape[0]):
        for lane in range(world.lanes):
            state.ahead[row, lane] = 0.0
    _clear_record(world)
    for lane in range(world.lanes):
        clear_place(world.place, lane)
        found = populate(scenario, world, lane)
        placed[lane] = found and num_segments(world.place, lane) != OVERFULL
    for number in range(state.x.shape[0]):
        agent = fixed(number)
        for lane in range(world.lanes):
            state.speed[agent, lane] = 0.0
            state.steering[agent, lane] = 0.0
            assign_goal(world, agent, lane, 0)
        if task.continuous_collisions:
            note_axles(world, agent)
        begin_among_obstacles(world.place, task, world, agent)
    find_nearby(task, world)
    record_collisions(task, world)


@kernel
def _clear_record(world):
    """Clear the records of earlier episodes."""
    record = world.record
    for index in np.ndindex(record.first.shape[:-1]):
        for lane in range(world.lanes):
            record.first[(*index, lane)] = NEVER
    for index in np.ndindex(record.total.shape[:-1]):
        for lane in range(world.lanes):
            record.total[(*index, lane)] = 0.0
    for agent, phase, column in np.ndindex(record.goal.shape[:-1]):
        empty = NEVER if column == HIT_STEP else math.nan
        for lane in range(world.lanes):
            record.goal[agent, phase, column, lane] = empty
    for agent, phase, kind in np.ndindex(record.miss.shape[:-2]):
        for lane in range(world.lanes):
            _clear_misses(record.miss, agent, phase, kind, lane)


@kernel
def _clear_misses(miss, agent, phase, kind, lane):
    """Clear the close misses of one kind, if there were any: they have many entries."""
    if not math.isnan(miss[agent, phase, kind, MISS_DISTANCE, lane]):
        for column in range(miss.shape[3]):
            miss[agent, phase, kind, column, lane] = 0.0 if column == MISS_COUNT else math.nan


@rare_kernel
def put_worlds(block, worlds, places):
    """Copy worlds whose episodes have just begun to their places.

    It copies one array after another, row by row. The rows of many worlds are far apart, and the
    entries that one row gives to neighbouring places share a cache line.

    Args:
        block: Worlds in which the episodes have begun; scratch and lists of candidates are not
            copied.
        worlds: Batch of the same shapes.
        places: (W,) index of the world for each lane.
    """
    lanes = block.lanes
    copy_rows(block.state.x, worlds.state.x, places, lanes)
    copy_rows(block.state.y, worlds.state.y, places, lanes)
    copy_rows(block.state.heading, worlds.state.heading, places, lanes)
    copy_rows(block.state.cosine, worlds.state.cosine, places, lanes)
    copy_rows(block.state.sine, worlds.state.sine, places, lanes)
    copy_rows(block.state.speed, worlds.state.speed, places, lanes)
    copy_rows(block.state.steering, worlds.state.steering, places, lanes)
    copy_rows(block.state.goal, worlds.state.goal, places, lanes)
    copy_rows(block.state.waiting, worlds.state.waiting, places, lanes)
    copy_rows(block.state.clock, worlds.state.clock, places, lanes)
    copy_rows(block.fleet.num_trailers, worlds.fleet.num_trailers, places, lanes)
    copy_rows(block.fleet.length, worlds.fleet.length, places, lanes)
    copy_rows(block.fleet.radius, worlds.fleet.radius, places, lanes)
    copy_rows(block.fleet.limit, worlds.fleet.limit, places, lanes)
    copy_parts(block.fleet.joints, worlds.fleet.joints, places, lanes)
    copy_parts(block.fleet.bodies, worlds.fleet.bodies, places, lanes)
    copy_parts(block.place, worlds.place, places, lanes)
    copy_parts(block.guidance, worlds.guidance, places, lanes)
    for lane in range(lanes):
        _put_dues(block.place, block.first + lane, worlds.place, worlds.first + places[lane])
    copy_rows(block.goals, worlds.goals, places, lanes)
    copy_rows(block.nearby.count, worlds.nearby.count, places, lanes)
    _put_neighbors(block, worlds, places)
    copy_rows(block.nearby.were, worlds.nearby.were, places, lanes)
    copy_rows(block.record.first, worlds.record.first, places, lanes)
    copy_rows(block.record.total, worlds.record.total, places, lanes)
    copy_rows(block.record.goal, worlds.record.goal, places, lanes)
    miss = worlds.record.miss
    for agent, phase, kind in np.ndindex(miss.shape[:-2]):
        for lane in range(lanes):
            _clear_misses(miss, agent, phase, kind, places[lane])


@kernel
def _put_neighbors(block, worlds, places):
    """Copy the neighbours of worlds, as many as there are."""
    for lane in range(block.lanes):
        own = block.nearby.index[block.first + lane]
        theirs = worlds.nearby.index[worlds.first + places[lane]]
        for agent in range(own.shape[0]):
            for k in range(block.nearby.count[agent, lane]):
                theirs[agent, k] = own[agent, k]


@rare_kernel
def copy_rows(block, worlds, places, lanes):
    """Copy lanes of an array to their places in the array of all worlds, row by row."""
    for index in np.ndindex(block.shape[:-1]):
        for lane in range(lanes):
            worlds[(*index, places[lane])] = block[(*index, lane)]


@generic
def copy_parts(part, worlds, places, lanes):
    """Copy lanes of a part of a fleet to their places in that of all worlds."""


@copy_parts.register(OnAxles)
@copy_parts.register(Lines)
@copy_parts.register(Plane)
@copy_parts.register(Dubins)
def _copy_nothing(part, worlds, places, lanes):
    pass


@copy_parts.register(Hitches)
def _copy_hitches(part, worlds, places, lanes):
    copy_rows(part.offset, worlds.offset, places, lanes)
    copy_rows(part.limit, worlds.limit, places, lanes)


@copy_parts.register(Outlines)
def _copy_outlines(part, worlds, places, lanes):
    copy_rows(part.shape, worlds.shape, places, lanes)
    copy_rows(part.reach, worlds.reach, places, lanes)


@copy_parts.register(Obstacles)
def _copy_obstacles(part, worlds, places, lanes):
    copy_rows(part.segment, worlds.segment, places, lanes)
    copy_rows(part.count, worlds.count, places, lanes)
    copy_rows(part.driven, worlds.driven, places, lanes)


@copy_parts.register(OnLattices)
def _copy_on_lattices(part, worlds, places, lanes):
    copy_rows(part.table, worlds.table, places, lanes)
    copy_rows(part.route, worlds.route, places, lanes)


@copy_parts.register(OnRoads)
def _copy_on_roads(part, worlds, places, lanes):
    copy_rows(part.under_way, worlds.under_way, places, lanes)
    copy_rows(part.route, worlds.route, places, lanes)


@copy_parts.register(OnWitnesses)
def _copy_on_witnesses(part, worlds, places, lanes):
    copy_rows(part.route, worlds.route, places, lanes)


@copy_parts.register(OnFeasible)
def _copy_on_feasible(part, worlds, places, lanes):
    copy_rows(part.route, worlds.route, places, lanes)
    copy_rows(part.plan, worlds.plan, places, lanes)


@generic
def _put_dues(place, w, places, to):
    """Copy the distances at which segments are due, of one world by index."""


@_put_dues.register(Plane)
def _put_no_dues(place, w, places, to):
    pass


@_put_dues.register(Obstacles)
def _put_dues_of_world(place, w, places, to):
    due, to_due = place.due[w], places.due[to]
    for index in np.ndindex(due.shape):
        to_due[index] = due[index]
