"""Whole episodes in a closed loop, compiled, and the table of what happened in them."""

import functools

import numpy as np
import pyarrow as pa

from baselines.metrics import tabulate
from baselines.policy import act_all, allocate_memory, check_policy
from hav_env import Batch, Task
from hav_env.compiled import canonical, entry, run_on_threads
from hav_env.transition import ended, step
from hav_env.vehicles import OnAxle
from hav_env.world import world_at

_BLOCK = 32  # HAVs in the worlds that a thread takes at a time


@entry
def rollout_worlds(first, last, policy, task, vehicle, worlds, memory, speed, steering):
    """Run the episode that has begun in each of a range of worlds to its end."""
    for w in range(first, last):
        world = world_at(worlds, w)
        while not ended(task, world):
            act_all(policy, memory[:, :, w], world, speed[:, w], steering[:, w])
            step(task, vehicle, world, speed[:, w], steering[:, w])


def rollout(
    policy,
    scenario,
    seed: int,
    episodes: np.ndarray,
    task: Task = Task(),
    vehicle=OnAxle(),
    threads: int | None = None,
) -> pa.Table:
    """Run a policy for whole episodes.

    Args:
        policy: a registered policy, which drives every HAV.
        scenario, seed, episodes: episode k of a seed is the same whatever else is run.
        task, vehicle: rules and kinematics.
        threads: how many; the table does not depend on it.

    Returns:
        One row for each HAV and episode, columns as in docs/metrics.md.

    Raises:
        ValueError, TypeError: for parameters that are not allowed, naming them.
        PlacementError: when a scenario has no room for its HAVs.
    """
    check_policy(policy, scenario)
    if len(episodes) == 0:
        raise ValueError("episodes is empty, but must hold at least one number")
    policy = canonical(policy)
    size = max(1, _BLOCK // max(1, scenario.num_havs))
    blocks = [episodes[first : first + size] for first in range(0, len(episodes), size)]
    roll = functools.partial(_roll, policy, scenario, seed, task, vehicle)
    return pa.concat_tables(run_on_threads(roll, blocks, threads)).combine_chunks()


def _roll(policy, scenario, seed: int, task: Task, vehicle, episodes: np.ndarray) -> pa.Table:
    """Run the episodes of one block, on this thread."""
    batch = Batch(scenario, len(episodes), task, vehicle, threads=1)
    batch.reset(seed, episodes)
    state = batch.worlds.state
    start = np.stack([state.x, state.y, state.heading[:, 0]], axis=1)  # (N, 3, W)
    num_havs, num_worlds = state.x.shape
    rollout_worlds(
        num_worlds,
        policy,
        batch.task,
        batch.vehicle,
        batch.worlds,
        allocate_memory(policy, num_havs, num_worlds),
        *np.zeros((2, num_havs, num_worlds)),
        threads=1,
    )
    return tabulate(batch.worlds, start, policy)
