"""This module runs rollouts: whole compiled episodes of a policy, and their episode table."""

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
from hav_env.policies.checks import check_driven, check_models
from hav_env.policies.demands import bind, check_guided, guidance_of
from hav_env.policies.interface import allocate_memory
from hav_env.policies.names import make_policy
from hav_env.policies.stepping import act_and_step
from hav_env.scenarios.presets import scenario_of
from hav_env.simulator.batch import Batch, read_episodes, worlds_for
from hav_env.simulator.guiding import Guidance
from hav_env.simulator.transition import ended
from hav_env.vehicles import VEHICLES, OnAxle
from hav_env.world.arrays import HANDFUL, PHASE
from hav_env.world.lanes import LANES, block_of, exchange_lanes, exchange_worlds
from hav_env.world.place.guidance import Dubins
from hav_env.world.task import Task

_SHARES = 4  # episodes per lane that a thread should run at least
_MUCH = 100  # memory size of a HAV from which on moving memory is expensive


@entry
def rollout_worlds(
    first, last, policy, task, vehicle, worlds, order, queue, stage, places, memory, speed, steering
):
    """Run episodes that have begun in ``worlds[order[first:last]]`` to their ends.

    Episodes take turns in the lanes of the stage. When an episode ends, its lane takes the next
    episode that no thread has taken. When none is left, the last lane moves into its place.

    Args:
        first: First index into ``order`` to run.
        last: Index into ``order`` after the last one to run.
        policy: Parameters of the policy that drives every HAV.
        task: Rules of the episodes.
        vehicle: Vehicle model (kinematics).
        worlds: All W episodes, each in its place; their final states are also written there.
        order: (W,) places of the episodes, in the order in which they run.
        queue: (1,) number of episodes that all threads have taken.
        stage: S worlds that run at a time.
        places: (S,) place of the episode in each lane of the stage.
        memory: (N, K, S) memory of the policy in the stage.
        speed: (N, S) speeds of the trucks in the stage [m/s], overwritten.
        steering: (N, S) steering angles in the stage [rad], overwritten.
    """
    active, left = 0, True
    while left and active < stage.lanes:
        left = _take_next(first, last, worlds, order, queue, stage, places, active)
        active += left
    while active > 0:
        # idle lanes that complete a vector cost less than a partial vector
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
    """Put the next episode into a lane; return whether one was left."""
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
    """Sort lanes by their waiting HAVs, so that loops can skip lanes in which a HAV waits.

    In large swarms, different HAVs wait in every lane, and sorting costs more than it saves. The
    same holds for policies with a large memory, because sorting moves the memory too.
    """
    if not 1 < stage.state.x.shape[0] <= HANDFUL or memory.shape[1] > _MUCH:
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
    """Return a number below 0 if the first HAVs wait, above 0 if the last HAVs wait."""
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
    guidance: Guidance | str | None = None,
) -> pa.Table:
    """Run a policy for whole episodes.

    Args:
        policy: Policy that drives every HAV, or its name.
        scenario: Scenario, or its name.
        seed: Seed of the random numbers, a whole number of 64 bits from 0.
        episodes: Numbers of the episodes; episode k of a seed does not depend on the other
            episodes.
        task: Rules of the episodes.
        vehicle: Kinematics of the HAVs, or their name.
        threads: Number of threads; the table does not depend on it.
        guidance: Guidance (routes to the goals): a model or its name; by default the one that the
            policy needs.

    Returns:
        One row for each HAV and episode, columns as in docs/metrics.md.

    Raises:
        ValueError, TypeError: If a parameter is invalid, the message names it; or if the policy
            returned a command that is not finite.
        PlacementError: If a scenario cannot place its HAVs.
    """
    moved = VEHICLES.make(vehicle)
    policy, scenario = bind(make_policy(policy), task, moved), scenario_of(scenario)
    check_models(policy, scenario, task, moved)
    numbers = read_episodes(episodes)
    if numbers.size == 0:
        raise ValueError("episodes is empty, but must hold at least one number")
    ways = (guidance_of(policy) or Dubins()) if guidance is None else guidance
    batch = Batch(scenario, numbers.size, task, moved, threads, ways)
    check_guided(policy, batch.guidance)
    batch.reset(seed, numbers)
    state = batch.worlds.state
    start = np.stack([state.x, state.y, state.heading[:, 0]], axis=1)  # (N, 3, W)
    # Loops over units reach to the longest HAV of a block, so similar worlds run side by side.
    # Worlds with long HAVs come first because they take longest.
    order, queue = np.lexsort(-batch.worlds.fleet.num_trailers[::-1]), np.zeros(1, np.int64)
    threads = int(threads or default_threads())
    much = allocate_memory(canonical(policy), scenario.num_havs, 1).shape[1] > _MUCH
    lanes = _lanes(scenario.num_havs, much, numbers.size, threads)
    roll = functools.partial(_roll, canonical(policy), batch, order, queue)
    stages = [lanes] * min(threads, -(-numbers.size // lanes))
    run_on_threads(roll, stages, threads, lambda: queue.fill(numbers.size))
    check_driven(policy, batch.worlds)
    return tabulate(batch.worlds, start, policy, task)


def _lanes(num_havs: int, much: bool, episodes: int, threads: int) -> int:
    """Return the number of lanes of a thread: whole vectors, few enough to share the episodes.

    A thread with more lanes than there are episodes left would keep other threads waiting. Large
    swarms and large memories exceed the nearest cache if a thread has many lanes.
    """
    most = LANES if num_havs <= HANDFUL and not much else max(VECTOR, LANES // num_havs)
    share = episodes if threads == 1 else max(VECTOR, -(-episodes // (_SHARES * threads)))
    return min(share, episodes, most)


def _roll(policy, batch: Batch, order: np.ndarray, queue: np.ndarray, lanes: int) -> None:
    """Run episodes to their ends on this thread until none is left.

    Every thread has its own stage: threads that write to neighbouring memory slow each other down.
    """
    num_havs = batch.scenario.num_havs
    stage = worlds_for(batch, lanes)
    # HAVs in idle lanes must not move
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
