"""Whole episodes in a closed loop, compiled, and the table of what happened in them."""

import numpy as np
import pyarrow as pa

from baselines.metrics import tabulate
from baselines.policy import act, allocate_memory, check_policy
from hav_env import Batch, Task
from hav_env.batch import check_placed, check_seed
from hav_env.compiled import entry
from hav_env.transition import begin, ended, step
from hav_env.vehicles import OnAxle
from hav_env.world import world_at

# Worlds that a thread takes at a time: their arrays are neighbours in memory, and threads that
# write into one line of the cache wait for each other.
_CHUNK = 16


@entry
def rollout_worlds(
    first,
    last,
    policy,
    scenario,
    task,
    vehicle,
    worlds,
    memory,
    action,
    start,
    seed,
    episodes,
    placed,
):
    """Run an episode to its end in each of a range of worlds."""
    for w in range(first, last):
        world = world_at(worlds, w)
        own_memory, speed, steering = memory[:, :, w], action[0, :, w], action[1, :, w]
        placed[w] = begin(scenario, task, world, seed, episodes[w])
        for agent in range(speed.shape[0]):
            start[agent, 0, w] = world.state.x[agent]
            start[agent, 1, w] = world.state.y[agent]
            start[agent, 2, w] = world.state.heading[agent, 0]
        while placed[w] and not ended(task, world):
            for agent in range(speed.shape[0]):
                if not world.state.waiting[agent]:
                    speed[agent], steering[agent] = act(policy, own_memory, world, agent)
            step(task, vehicle, world, speed, steering)


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
    check_policy(policy)
    check_seed(seed)
    episodes = np.ascontiguousarray(episodes, np.int64)
    batch = Batch(scenario, len(episodes), task, vehicle)
    num_havs, num_worlds = batch.worlds.state.x.shape
    start = np.zeros((num_havs, 3, num_worlds))
    placed = np.zeros(num_worlds, np.bool_)
    rollout_worlds(
        num_worlds,
        policy,
        scenario,
        task,
        vehicle,
        batch.worlds,
        allocate_memory(policy, num_havs, num_worlds),
        np.zeros((2, num_havs, num_worlds)),
        start,
        seed,
        episodes,
        placed,
        threads=threads,
        chunk=_CHUNK,
    )
    check_placed(placed, scenario)
    return tabulate(batch.worlds, start, policy)
