"""This module handles lanes: blocks of worlds, worlds that change places, views of one world."""

from typing import Any

import numpy as np

from hav_env.compiled import VECTOR, generic, kernel, lanes_from, rare_kernel
from hav_env.world.arrays import Fleet, Nearby, Record, State, World
from hav_env.world.place.guidance import Dubins, OnFeasible, OnLattices, OnRoads, OnWitnesses
from hav_env.world.place.segments import Obstacles, Plane
from hav_env.world.units.parts import Hitches, Lines, OnAxles, Outlines, part_from

LANES = 64  # worlds of a block: few enough for the nearest cache, many enough for whole vectors
# the same for kernels that also write observations and rewards: they have many rows, and the
# processor prefetches longer ones
OBSERVED_LANES = 128
APART = OBSERVED_LANES + VECTOR  # rows at this distance do not evict each other from the cache


@kernel
def block_of(worlds, first, lanes, units):
    """Return ``lanes`` worlds of a batch, from world ``first`` on, with loops to ``units``."""
    state, fleet, nearby, record = worlds.state, worlds.fleet, worlds.nearby, worlds.record
    return World(
        State(
            lanes_from(state.x, first),
            lanes_from(state.y, first),
            lanes_from(state.heading, first),
            lanes_from(state.cosine, first),
            lanes_from(state.sine, first),
            lanes_from(state.speed, first),
            lanes_from(state.steering, first),
            lanes_from(state.ahead, first),
            lanes_from(state.goal, first),
            lanes_from(state.waiting, first),
            lanes_from(state.clock, first),
        ),
        Fleet(
            lanes_from(fleet.num_trailers, first),
            lanes_from(fleet.length, first),
            lanes_from(fleet.radius, first),
            lanes_from(fleet.limit, first),
            part_from(fleet.joints, first),
            part_from(fleet.bodies, first),
        ),
        lanes_from(worlds.goals, first),
        Nearby(
            lanes_from(nearby.count, first),
            nearby.index,
            lanes_from(nearby.circle, first),
            lanes_from(nearby.num_pairs, first),
            nearby.pair,
            nearby.grid,
            lanes_from(nearby.were, first),
            lanes_from(nearby.box, first),
        ),
        Record(
            lanes_from(record.first, first),
            lanes_from(record.total, first),
            lanes_from(record.goal, first),
            lanes_from(record.miss, first),
        ),
        part_from(worlds.place, first),
        part_from(worlds.guidance, first),
        worlds.first + first,
        lanes,
        units,
        worlds.rolls,
    )


@kernel
def moving_block(world, agent):
    """Return the lanes in which a HAV moves, as a block whose loops reach to its last unit there.

    The HAV may wait in some lanes between, and in lanes that extend the block to whole vectors.
    """
    first, end = 0, world.lanes
    while first < end and world.state.waiting[agent, first]:
        first += 1
    while first < end and world.state.waiting[agent, end - 1]:
        end -= 1
    return _block_between(world, agent, first, end)


@kernel
def rolling_block(world, agent):
    """Return the lanes in which a HAV does not wait, or waits and still rolls: see above."""
    first, end, state = 0, world.lanes, world.state
    while first < end and state.waiting[agent, first] and state.speed[agent, first] == 0.0:
        first += 1
    while first < end and state.waiting[agent, end - 1] and state.speed[agent, end - 1] == 0.0:
        end -= 1
    return _block_between(world, agent, first, end)


@kernel
def _block_between(world, agent, first, end):
    """Return the lanes from ``first`` to before ``end`` as a block of whole vectors if possible."""
    longest = 0
    first = first // VECTOR * VECTOR
    end = min((end + VECTOR - 1) // VECTOR * VECTOR, world.lanes)
    for lane in range(first, end):
        longest = max(longest, world.fleet.num_trailers[agent, lane])
    return block_of(world, first, max(end - first, 0), longest + 1)


@kernel
def exchange_lanes(one, lane, other, to):
    """Exchange a lane of an array with a lane of another array, or of the same one."""
    for index in np.ndindex(one.shape[:-1]):
        kept = other[(*index, to)]
        other[(*index, to)] = one[(*index, lane)]
        one[(*index, lane)] = kept


@generic
def exchange_parts(one, other, lane, to):
    """Exchange a lane of a part of a fleet with a lane of another part, or of the same one."""


@exchange_parts.register(OnAxles)
@exchange_parts.register(Lines)
@exchange_parts.register(Plane)
@exchange_parts.register(Dubins)
def _exchange_nothing(one, other, lane, to):
    pass


@exchange_parts.register(Hitches)
def _exchange_hitches(one, other, lane, to):
    exchange_lanes(one.offset, lane, other.offset, to)
    exchange_lanes(one.limit, lane, other.limit, to)


@exchange_parts.register(Outlines)
def _exchange_outlines(one, other, lane, to):
    exchange_lanes(one.shape, lane, other.shape, to)
    exchange_lanes(one.reach, lane, other.reach, to)


@exchange_parts.register(Obstacles)
def _exchange_obstacles(one, other, lane, to):
    exchange_lanes(one.segment, lane, other.segment, to)
    exchange_lanes(one.count, lane, other.count, to)
    exchange_lanes(one.driven, lane, other.driven, to)


@exchange_parts.register(OnLattices)
def _exchange_on_lattices(one, other, lane, to):
    exchange_lanes(one.table, lane, other.table, to)
    exchange_lanes(one.route, lane, other.route, to)


@exchange_parts.register(OnRoads)
def _exchange_on_roads(one, other, lane, to):
    exchange_lanes(one.under_way, lane, other.under_way, to)
    exchange_lanes(one.route, lane, other.route, to)


@exchange_parts.register(OnWitnesses)
def _exchange_on_witnesses(one, other, lane, to):
    exchange_lanes(one.route, lane, other.route, to)


@exchange_parts.register(OnFeasible)
def _exchange_on_feasible(one, other, lane, to):
    exchange_lanes(one.route, lane, other.route, to)
    exchange_lanes(one.plan, lane, other.plan, to)


@rare_kernel
def exchange_worlds(one, lane, other, to):
    """Exchange the worlds in two lanes of batches of the same shapes, or of one batch.

    Scratch is not exchanged: its users initialise it. Nor are lists of candidates, which hold for
    any HAVs in their circles.
    """
    exchange_lanes(one.state.x, lane, other.state.x, to)
    exchange_lanes(one.state.y, lane, other.state.y, to)
    exchange_lanes(one.state.heading, lane, other.state.heading, to)
    exchange_lanes(one.state.cosine, lane, other.state.cosine, to)
    exchange_lanes(one.state.sine, lane, other.state.sine, to)
    exchange_lanes(one.state.speed, lane, other.state.speed, to)
    exchange_lanes(one.state.steering, lane, other.state.steering, to)
    exchange_lanes(one.state.goal, lane, other.state.goal, to)
    exchange_lanes(one.state.waiting, lane, other.state.waiting, to)
    exchange_lanes(one.state.clock, lane, other.state.clock, to)
    exchange_lanes(one.fleet.num_trailers, lane, other.fleet.num_trailers, to)
    exchange_lanes(one.fleet.length, lane, other.fleet.length, to)
    exchange_lanes(one.fleet.radius, lane, other.fleet.radius, to)
    exchange_lanes(one.fleet.limit, lane, other.fleet.limit, to)
    exchange_parts(one.fleet.joints, other.fleet.joints, lane, to)
    exchange_parts(one.fleet.bodies, other.fleet.bodies, lane, to)
    exchange_lanes(one.goals, lane, other.goals, to)
    exchange_parts(one.place, other.place, lane, to)
    exchange_parts(one.guidance, other.guidance, lane, to)
    _exchange_neighbors(one, lane, other, to)
    exchange_dues(one.place, one.first + lane, other.place, other.first + to)
    exchange_lanes(one.nearby.were, lane, other.nearby.were, to)
    exchange_lanes(one.record.first, lane, other.record.first, to)
    exchange_lanes(one.record.total, lane, other.record.total, to)
    exchange_lanes(one.record.goal, lane, other.record.goal, to)
    exchange_lanes(one.record.miss, lane, other.record.miss, to)


@generic
def exchange_dues(one, w, other, to):
    """Exchange the distances at which segments are due, of two worlds by index."""


@exchange_dues.register(Plane)
def _exchange_no_dues(one, w, other, to):
    pass


@exchange_dues.register(Obstacles)
def _exchange_dues_of_worlds(one, w, other, to):
    due, to_due = one.due[w], other.due[to]
    for index in np.ndindex(due.shape):
        kept = to_due[index]
        to_due[index] = due[index]
        due[index] = kept


@kernel
def _exchange_neighbors(one, lane, other, to):
    """Exchange the neighbours of two worlds, as many as there are."""
    counts, to_counts = one.nearby.count, other.nearby.count
    index, to_index = one.nearby.index[one.first + lane], other.nearby.index[other.first + to]
    for agent in range(counts.shape[0]):
        for k in range(max(counts[agent, lane], to_counts[agent, to])):
            kept = to_index[agent, k]
            to_index[agent, k] = index[agent, k]
            index[agent, k] = kept
    exchange_lanes(counts, lane, to_counts, to)


def view_of(worlds: World, w: int) -> World:
    """Return the view of one world in Python: the arrays without their last axis."""

    def view(part: Any) -> Any:
        if isinstance(part, tuple):
            return type(part)(*map(view, part))
        return part[..., w] if isinstance(part, np.ndarray) else part

    nearby = worlds.nearby
    of_world = nearby.index[w], nearby.circle[..., w], nearby.num_pairs[w], nearby.pair[w]
    return World(
        view(worlds.state),
        view(worlds.fleet),
        worlds.goals[..., w],
        Nearby(
            nearby.count[..., w], *of_world, nearby.grid[w], *(part[..., w] for part in nearby[-2:])
        ),
        view(worlds.record),
        _view_of_place(worlds.place, w),
        _view_of_guidance(worlds.guidance, w),
        w,
        1,
        worlds.units,
        worlds.rolls,
    )


def _view_of_place(place: Any, w: int) -> Any:
    """Return the place of one world, as ``view_of`` does; ``due`` has the world first."""
    if isinstance(place, Plane):
        return place
    parts = place._asdict().items()
    return Obstacles(*(part[w] if name == "due" else part[..., w] for name, part in parts))


def _view_of_guidance(guidance: Any, w: int) -> Any:
    """Return the guidance of one world, as ``view_of`` does; all worlds share lattices."""
    shared = "lattices", "widening"
    fields = guidance._asdict().items()
    return guidance._replace(**{k: part[..., w] for k, part in fields if k not in shared})
