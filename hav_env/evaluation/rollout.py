"""This module runs rollouts: whole compiled episodes of a policy, and the table of them."""

import functools
import os

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from hav_env.compiled import (
    VECTOR,
    canonical,
    default_threads,
    entry,
    kernel,
    rare_kernel,
    run_on_threads,
    take,
)
from hav_env.evaluation.episode_table import tabulate
from hav_env.models.protocols import Policy, Scenario, Vehicle
from hav_env.policies.interface import allocate_memory, check_models
from hav_env.policies.names import make_policy
from hav_env.policies.stepping import act_and_step
from hav_env.scenarios.presets import scenario_of
from hav_env.simulator.batch import Batch, read_episodes, worlds_for
from hav_env.simulator.transition import ended
from hav_env.vehicles import VEHICLES, OnAxle
from hav_env.world.arrays import FEW, PHASE
from hav_env.world.lanes import LANES, block_of, exchange_lanes, exchange_worlds
from hav_env.world.task import Task

_SHARES = 4  # fillings of each thread's lanes there should be
_MUCH = 100  # numbers that a HAV remembers


@entry
def rollout_worlds(
    first, last, policy, task, vehicle, worlds, order, queue, stage, places, memory, speed, steering
):
    """Run episodes that have begun in ``worlds[order[first:last]]`` to their ends.

    They take turns in the lanes of the stage: a lane whose episode ended takes the next one that no
    thread has taken, and when there is none, the last lane takes its place.

    Args:
        first: first index into ``order`` to run.
        last: index into ``order`` behind the last one to run.
        policy: parameters of the policy that drives every HAV.
        task: rules of the episodes.
        vehicle: kinematics of the HAVs.
        worlds: all W episodes, each in its place, where it also stands at the end.
        order: (W,) places of the episodes, in the order in which they run.
        queue: (1,) how many of them have been taken, by all threads.
        stage: S worlds, which run at a time.
        places: (S,) place of the episode that runs in each lane of the stage.
        memory: (N, K, S) memory of the policy on the stage.
        speed: (N, S) speeds of the trucks on the stage [m/s], overwritten.
        steering: (N, S) steering angles on the stage [rad], overwritten.
    """
    active, left = 0, True
    while left and active < stage.lanes:
        left = _take_next(first, last, worlds, order, queue, stage, places, active)
        active += left
    while active > 0:
        # idle lanes in a whole vector cost less than odd ones
        lanes = min((active + VECTOR - 1) // VECTOR * VECTOR, stage.lanes)
        block = block_of(stage, 0, lanes, stage.units)
        if act_and_step(policy, memory, task, vehicle, block, speed, steering) == 0:
            continue
        for lane in range(active - 1, -1, -1):
            if not ended(task, stage, lane):
                continue
            exchange_worlds(stage, lane, worlds, places[lane])
            if _take_next(first, last, worlds, order, queue, stage, places, lane):
                memory[..., lane] = 0.0
            else:
                active -= 1
                if lane < active:
                    _exchange(stage, places, memory, lane, active)
        _arrange(stage, places, memory, active)


@rare_kernel
def _take_next(first, last, worlds, order, queue, stage, places, lane):
    """Put the next episode into a lane; return whether there was one left."""
    waiting = first + take(queue)
    if waiting >= last:
        return False
    places[lane] = order[waiting]
    exchange_worlds(worlds, places[lane], stage, lane)
    return True


@kernel
def _exchange(stage, places, memory, lane, other):
    exchange_worlds(stage, lane, stage, other)
    exchange_lanes(places, lane, places, other)
    exchange_lanes(memory, lane, memory, other)


@rare_kernel
def _arrange(stage, places, memory, active):
    """Sort lanes by who waits in them, so that loops may pass over lanes in which a HAV waits.

    In large swarms somebody else waits in every lane, and sorting costs more than it gives; so it
    does where HAVs remember much, which is moved along.
    """
    if not 1 < stage.state.x.shape[0] <= FEW or memory.shape[1] > _MUCH:
        return
    for lane in range(active):
        chosen = lane
        for other in range(lane + 1, active):
            lower = _rank(stage, other) < _rank(stage, chosen)
            if lower or (chosen != lane and _rank(stage, other) == _rank(stage, chosen)):
                chosen = other
        if chosen != lane:
            _exchange(stage, places, memory, lane, chosen)


@kernel
def _rank(stage, lane):
    """Return a number below 0 when the first HAVs wait, above 0 when the last do."""
    num_havs, rank = stage.state.x.shape[0], 0
    for agent in range(num_havs):
        rank += 2 * agent + 1 - num_havs if stage.state.waiting[agent, lane] else 0
    return rank


def rollout(
    policy: Policy | str | os.PathLike[str],
    scenario: Scenario | str | os.PathLike[str],
    seed: int,
    episodes: npt.ArrayLike,
    task: Task = Task(),
    vehicle: Vehicle | str = OnAxle(),
    threads: int | None = None,
) -> pa.Table:
    """Run a policy for whole episodes.

    Args:
        policy: drives every HAV: a policy, or its name.
        scenario: a scenario, or its name.
        seed: seed of the random numbers, a whole number of 64 bits from 0.
        episodes: numbers of the episodes; episode k of a seed is the same whatever else runs.
        task: rules of the episodes.
        vehicle: kinematics of the HAVs, or their name.
        threads: number of threads, on which the table does not depend.

    Returns:
        One row for each HAV and episode, columns as in docs/metrics.md.

    Raises:
        ValueError, TypeError: for parameters that are not allowed, naming them.
        PlacementError: when a scenario has no room for its HAVs.
    """
    policy, scenario = make_policy(policy), scenario_of(scenario)
    moved = VEHICLES.make(vehicle)
    check_models(policy, scenario, task, moved)
    numbers = read_episodes(episodes)
    if numbers.size == 0:
        raise ValueError("episodes is empty, but must hold at least one number")
    batch = Batch(scenario, numbers.size, task, moved, threads)
    batch.reset(seed, numbers)
    state = batch.worlds.state
    start = np.stack([state.x, state.y, state.heading[:, 0]], axis=1)  # (N, 3, W)
    # Loops over units reach to the longest HAV of a block: worlds alike are run side by side, long
    # ones first, for they take longest.
    order, queue = np.lexsort(-batch.worlds.fleet.num_trailers[::-1]), np.zeros(1, np.int64)
    threads = int(threads or default_threads())
    much = allocate_memory(canonical(policy), scenario.num_havs, 1).shape[1] > _MUCH
    lanes = _lanes(scenario.num_havs, much, numbers.size, threads)
    roll = functools.partial(_roll, canonical(policy), batch, order, queue)
    stages = [lanes] * min(threads, -(-numbers.size // lanes))
    run_on_threads(roll, stages, threads, lambda: queue.fill(numbers.size))
    return tabulate(batch.worlds, start, policy, task)


def _lanes(num_havs: int, much: bool, episodes: int, threads: int) -> int:
    """Return in how many lanes a thread runs episodes: whole vectors, few where others take some.

    Whoever has more lanes than the others have episodes left keeps them waiting. Large swarms, and
    HAVs that remember much, leave the nearest cache in many lanes.
    """
    most = LANES if num_havs <= FEW and not much else max(VECTOR, LANES // num_havs)
    share = episodes if threads == 1 else max(VECTOR, -(-episodes // (_SHARES * threads)))
    return min(share, episodes, most)


def _roll(policy, batch: Batch, order: np.ndarray, queue: np.ndarray, lanes: int) -> None:
    """Run episodes to their ends, on this thread, until none is left.

    The stage is the thread's own: threads that write side by side would wait for each other.
    """
    num_havs = batch.scenario.num_havs
    stage = worlds_for(batch.scenario, batch.task, batch.vehicle, lanes)
    # so that nobody moves in lanes that are idle
    stage.state.waiting[:], stage.state.goal[:, PHASE] = True, batch.scenario.num_goals - 1
    rollout_worlds(
        len(order),
        policy,
        batch.task,
        batch.vehicle,
        batch.worlds,
        order,
        queue,
        stage,
        np.zeros(lanes, np.int64),
        allocate_memory(policy, num_havs, lanes),
        *np.zeros((2, num_havs, lanes)),
        threads=1,
    )
