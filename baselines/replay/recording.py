"""This module runs one episode in a compiled loop and keeps its states."""

import functools
import math
from typing import Any, NamedTuple

import numpy as np

from hav_env.compiled import canonical, entry, kernel
from hav_env.policies.interface import allocate_memory, evaded
from hav_env.policies.stepping import act_and_step
from hav_env.simulator.batch import Batch
from hav_env.simulator.transition import ended
from hav_env.world.arrays import NEVER, STEP, goal_under_way, is_removed
from hav_env.world.lanes import block_of

_CHUNK = 2_000  # states: memory follows the episode, and an interrupt waits for no more


class States(NamedTuple):
    """The states that were kept, T of them; shapes as in ``hav_env.world.arrays``."""

    step: np.ndarray  # (T,) steps done
    phase: np.ndarray  # (T, N) which of its goals is under way, from 0
    x: np.ndarray  # (T, N) truck's rear axle [m], of a removed HAV where it was last
    y: np.ndarray  # (T, N) [m]
    heading: np.ndarray  # (T, N, U) of every unit [rad]
    waiting: np.ndarray  # (T, N) bool
    removed: np.ndarray  # (T, N) bool
    speed: np.ndarray  # (T, N) decided in this state [m/s]; nan in the last, where nothing is
    steering: np.ndarray  # (T, N) [rad]
    motion: np.ndarray  # (T, N, 2) what the truck made of it: speed [m/s], steering [rad]
    evaded: np.ndarray  # (T, N) the HAV evaded in this state, NEVER for none


@entry
def record_states(
    first, last, policy, task, vehicle, worlds, memory, speed, steering, every, states, place, count
):
    """Run the episode of world ``first`` on, until it ends or there is no room for a state.

    Args:
        first: the world.
        last: the world behind it.
        policy: drives every HAV.
        task: rules of the episode.
        vehicle: kinematics of the HAVs.
        worlds: of a batch.
        memory: (N, K, W) of the policy.
        speed: (N, W) speeds of the trucks [m/s], overwritten.
        steering: (N, W) steering angles [rad], overwritten.
        every: a state is kept after each so many steps, and the last one.
        states: ``States``, to be written.
        place: (2, N) x and y [m] where the HAVs are, or were when they were removed.
        count: (2,) to be written: how many states were kept, and 1 if the episode has ended.
    """
    for w in range(first, last):
        world, row = block_of(worlds, w, 1, worlds.units), 0
        while row < len(states.step):
            _note_places(world, place)
            if ended(task, world, 0):
                _keep(world, states, row, place)
                row, count[1] = row + 1, 1
                break
            kept = world.state.clock[STEP, 0] % every == 0
            if kept:
                _keep(world, states, row, place)
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
    """Keep the state of a world; nothing is decided yet."""
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
def _keep_decisions(policy, memory, world, states, row, speed, steering):
    """Keep what was decided in a state. A HAV that waits decides nothing: it stands, or brakes."""
    for agent in range(speed.shape[0]):
        waits = states.waiting[row, agent]
        states.speed[row, agent] = 0.0 if waits else speed[agent, 0]
        states.steering[row, agent] = 0.0 if waits else steering[agent, 0]
        # of one that waits and stands, the wheels do not matter
        void = waits and not world.rolls
        states.motion[row, agent, 0] = 0.0 if void else world.state.speed[agent, 0]
        states.motion[row, agent, 1] = 0.0 if void else world.state.steering[agent, 0]
        states.evaded[row, agent] = NEVER if waits else evaded(policy, memory, agent, 0)


def run_and_record(policy: Any, batch: Batch, every: int) -> States:
    """Run the episode that has begun in the only world of a batch to its end.

    Args:
        policy: drives every HAV; it has been checked.
        batch: one world, which ``reset`` has begun; it stands at the end of the episode then.
        every: keep the states after each so many steps, and the last one.

    Returns:
        The states.
    """
    num_havs, num_units, _ = batch.worlds.state.heading.shape
    models = canonical(policy), batch.task, batch.vehicle
    scratch = np.zeros((2, num_havs, 1))
    memory, place = allocate_memory(policy, num_havs, 1), np.zeros((2, num_havs))
    count, chunks = np.zeros(2, np.int64), []
    while not count[1]:
        states = _allocate(num_havs, num_units)
        record_states(
            *(1, *models, batch.worlds, memory, *scratch, every, states, place, count), threads=1
        )
        chunks.append([array[: count[0]].copy() for array in states])
    return States(*map(np.concatenate, zip(*chunks, strict=True)))


def _allocate(num_havs: int, num_units: int) -> States:
    real = functools.partial(np.zeros, (_CHUNK, num_havs))
    whole, flags = functools.partial(real, dtype=np.int64), functools.partial(real, dtype=np.bool_)
    heading = np.zeros((_CHUNK, num_havs, num_units))
    return States(
        *(np.zeros(_CHUNK, np.int64), whole(), real(), real(), heading),
        *(flags(), flags(), real(), real(), np.zeros((_CHUNK, num_havs, 2)), whole()),
    )
