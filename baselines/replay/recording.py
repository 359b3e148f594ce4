"""This module runs one episode in a compiled loop and keeps its states."""

import functools
import math
from typing import Any, NamedTuple

import numpy as np

from baselines.replay.reserved_outlines import reserved_outline
from hav_env.compiled import canonical, entry, kernel
from hav_env.maths.kdop import SIDES
from hav_env.policies.interface import allocate_memory, evaded
from hav_env.policies.stepping import act_and_step
from hav_env.simulator.batch import Batch
from hav_env.simulator.transition import ended
from hav_env.world.arrays import NEVER, STEP, goal_under_way, is_removed
from hav_env.world.lanes import block_of

_CHUNK = 2_000  # states in an array: memory grows with the episode, and Ctrl-C waits for one array
_SAME_OUTLINE = 1e-3  # [m] corners of one outline that HAVs report at different times


class States(NamedTuple):
    """The T recorded states; shapes as in ``hav_env.world.arrays``."""

    step: np.ndarray  # (T,) steps done
    phase: np.ndarray  # (T, N) number of the current goal, from 0
    x: np.ndarray  # (T, N) truck's rear axle [m]; a removed HAV has its last position
    y: np.ndarray  # (T, N) [m]
    heading: np.ndarray  # (T, N, U) of every unit [rad]
    waiting: np.ndarray  # (T, N) bool
    removed: np.ndarray  # (T, N) bool
    speed: np.ndarray  # (T, N) decision in this state [m/s]; nan in the last state, which has none
    steering: np.ndarray  # (T, N) [rad]
    motion: np.ndarray  # (T, N, 2) speed [m/s] and steering [rad] of the truck in the next step
    evaded: np.ndarray  # (T, N) the HAV evaded in this state, NEVER for none
    reserved: np.ndarray  # (T, N) number of the reserved outline, NEVER for none


@entry
def record_states(
    first,
    last,
    policy,
    task,
    vehicle,
    worlds,
    memory,
    speed,
    steering,
    every,
    states,
    outlines,
    latest,
    place,
    count,
):
    """Run the episode of world ``first`` on, until it ends or an array is full.

    Args:
        first: The world.
        last: ``first + 1``.
        policy: Policy of all HAVs.
        task: Rules of the episode.
        vehicle: Kinematics of the HAVs.
        worlds: Worlds of a batch.
        memory: (N, K, W) Memory of the policy.
        speed: (N, W) Speeds of the trucks [m/s], overwritten.
        steering: (N, W) Steering angles [rad], overwritten.
        every: Number of steps between recorded states; the last state is always recorded.
        states: ``States``, written.
        outlines: (M + 1, 24, 2) Written: corners of M reserved outlines [m]; the last is scratch.
        latest: (N,) The last outline of each HAV in ``outlines``, or NEVER; updated.
        place: (2, N) x and y [m] of the HAVs; removed HAVs keep their last position.
        count: (3,) Written: the number of recorded states, 1 if the episode has ended, and the
            number of outlines.
    """
    for w in range(first, last):
        world, row, havs = block_of(worlds, w, 1, worlds.units), 0, place.shape[1]
        count[2] = 0
        while row < len(states.step) and count[2] + havs < len(outlines):
            _note_places(world, place)
            if ended(task, world, 0):
                _keep(world, states, row, place)
                _keep_outlines(policy, memory, states, row, outlines, latest, count)
                row, count[1] = row + 1, 1
                break
            kept = world.state.clock[STEP, 0] % every == 0
            if kept:
                _keep(world, states, row, place)
                _keep_outlines(policy, memory, states, row, outlines, latest, count)
            act_and_step(policy, memory, task, vehicle, world, speed, steering)
            if kept:
                _keep_decisions(policy, memory, world, states, row, speed, steering)
                row += 1
        count[0] = row


@kernel
def _note_places(world, place):
    for agent in range(place.shape[1]):
        if not is_removed(world, agent, 0):
            place[0, agent], place[1, agent] = world.state.x[agent, 0], world.state.y[agent, 0]


@kernel
def _keep(world, states, row, place):
    """Record the state of a world, without decisions."""
    state = world.state
    states.step[row] = state.clock[STEP, 0]
    for agent in range(place.shape[1]):
        states.phase[row, agent] = goal_under_way(state, agent, 0)
        states.x[row, agent], states.y[row, agent] = place[0, agent], place[1, agent]
        for unit in range(state.heading.shape[1]):
            states.heading[row, agent, unit] = state.heading[agent, unit, 0]
        states.waiting[row, agent] = state.waiting[agent, 0]
        states.removed[row, agent] = is_removed(world, agent, 0)
        states.speed[row, agent] = states.steering[row, agent] = math.nan
        states.motion[row, agent, 0] = states.motion[row, agent, 1] = math.nan
        states.evaded[row, agent] = NEVER


@kernel
def _keep_outlines(policy, memory, states, row, outlines, latest, count):
    """Record the outlines that HAVs have reserved, each of them once."""
    corners = outlines[len(outlines) - 1]
    for agent in range(len(latest)):
        states.reserved[row, agent] = NEVER
        absent = states.removed[row, agent] or states.waiting[row, agent]
        if absent or not reserved_outline(policy, memory, agent, 0, corners):
            continue
        heading = states.heading[row, agent, 0]
        cosine, sine = math.cos(heading), math.sin(heading)
        known, same = outlines[max(latest[agent], 0)], latest[agent] != NEVER
        for side in range(SIDES):
            forward, left = corners[side, 0], corners[side, 1]
            corners[side, 0] = states.x[row, agent] + forward * cosine - left * sine
            corners[side, 1] = states.y[row, agent] + forward * sine + left * cosine
            for axis in range(2):
                same = same and abs(corners[side, axis] - known[side, axis]) <= _SAME_OUTLINE
        if not same:
            for side in range(SIDES):
                outlines[count[2], side, 0] = corners[side, 0]
                outlines[count[2], side, 1] = corners[side, 1]
            latest[agent], count[2] = count[2], count[2] + 1
        states.reserved[row, agent] = latest[agent]


@kernel
def _keep_decisions(policy, memory, world, states, row, speed, steering):
    """Record the decisions in a state. A waiting HAV decides nothing: it stands, or brakes."""
    for agent in range(speed.shape[0]):
        waits = states.waiting[row, agent]
        states.speed[row, agent] = 0.0 if waits else speed[agent, 0]
        states.steering[row, agent] = 0.0 if waits else steering[agent, 0]
        # the steering of a HAV that waits and stands has no meaning
        void = waits and not world.rolls
        states.motion[row, agent, 0] = 0.0 if void else world.state.speed[agent, 0]
        states.motion[row, agent, 1] = 0.0 if void else world.state.steering[agent, 0]
        states.evaded[row, agent] = NEVER if waits else evaded(policy, memory, agent, 0)


def run_and_record(policy: Any, batch: Batch, every: int) -> tuple[States, np.ndarray]:
    """Run the current episode of a batch of one world to its end, and record its states.

    Args:
        policy: Policy of all HAVs, already checked.
        batch: A batch of one world after ``reset``; the function runs it to the end of the episode.
        every: Number of steps between recorded states; the last state is always recorded.

    Returns:
        The recorded states, and the corners (K, 24, 2) of all outlines that they refer to [m].
    """
    num_havs, num_units, _ = batch.worlds.state.heading.shape
    models = canonical(policy), batch.task, batch.vehicle
    scratch = np.zeros((2, num_havs, 1))
    memory, place = allocate_memory(policy, num_havs, 1), np.zeros((2, num_havs))
    count, chunks, outlines, before = np.zeros(3, np.int64), [], [], 0
    corners = np.zeros((_CHUNK + num_havs + 1, SIDES, 2))
    while not count[1]:
        states, latest = _allocate(num_havs, num_units), np.full(num_havs, NEVER)
        kept = every, states, corners, latest, place, count
        record_states(1, *models, batch.worlds, memory, *scratch, *kept, threads=1)
        reserved = states.reserved
        reserved[reserved != NEVER] += before
        chunks.append([array[: count[0]].copy() for array in states])
        outlines.append(corners[: count[2]].copy())
        before += int(count[2])
    return States(*map(np.concatenate, zip(*chunks, strict=True))), np.concatenate(outlines)


def _allocate(num_havs: int, num_units: int) -> States:
    real = functools.partial(np.zeros, (_CHUNK, num_havs))
    whole, flags = functools.partial(real, dtype=np.int64), functools.partial(real, dtype=np.bool_)
    heading, motion = np.zeros((_CHUNK, num_havs, num_units)), np.zeros((_CHUNK, num_havs, 2))
    return States(
        *(np.zeros(_CHUNK, np.int64), whole(), real(), real(), heading),
        *(flags(), flags(), real(), real(), motion, whole(), whole()),
    )
