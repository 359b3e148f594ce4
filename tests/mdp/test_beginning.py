"""An episode begins with the same bits anywhere: alone, among others, after any other."""

import numpy as np
import pytest

from hav_env import RandomPoses, Task
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.world.lanes import LANES
from tests.support.budgets import budget

# arrays that each search or step writes before it reads them
SCRATCH = {
    "worlds.state.ahead",
    "worlds.nearby.index",  # its first ``count`` are compared
    "worlds.nearby.grid",
    "worlds.nearby.circle",  # a list of candidates holds for any HAVs in its circles
    "worlds.nearby.num_pairs",
    "worlds.nearby.pair",
    "worlds.nearby.box",
    "buffers.command",
    "buffers.before",
}


def kept(process, outcome):
    """Return the persistent state of a world, and all results about it, world first."""
    arrays = process.arrays()
    found = {name: np.moveaxis(arrays[name], -1, 0) for name in set(arrays) - SCRATCH}
    neighbors = arrays["worlds.nearby.index"]
    near = np.arange(neighbors.shape[2]) < found["worlds.nearby.count"][..., None]
    found["neighbors"] = np.where(near, neighbors, -1)
    told = outcome._asdict()
    found["observation"] = told.pop("observation")
    return found | {name: np.moveaxis(array, -1, 0) for name, array in told.items()}


def soil(process):
    """Drive on, and record false close misses."""
    for _ in range(3):
        process.step(np.full((process.num_worlds, process.num_controlled, 2), 0.4))
    miss = process.batch.worlds.record.miss
    miss[..., ::2] = 7.0


@pytest.mark.parametrize("task", [Task(), Task(continuous_collisions=True)])
@pytest.mark.parametrize("num_havs", [1, 2, 5, 18])
@pytest.mark.parametrize("threads", [1, 3])
def test_episodes_begin_as_they_do_alone(num_havs, threads, task):
    num_worlds = budget(LANES + 9, 5) if num_havs <= 5 else 3
    settings = {"scenario": RandomPoses(num_havs=num_havs), "task": task}
    process = DecisionProcess(num_worlds, threads=threads, **settings)
    alone = DecisionProcess(1, **settings)
    rng, outcome = np.random.default_rng(5), process.outcome()
    seeds, episodes = rng.integers(1_000, size=(2, num_worlds))
    process.begin(seeds, episodes, np.ones(num_worlds, np.bool_), outcome)
    for share in (0.1, 0.5, 0.9):
        soil(process)
        chosen = rng.random(num_worlds) < share
        chosen[rng.integers(num_worlds)] = True
        episodes[chosen] += 1
        before, outcome = kept(process, outcome), process.outcome()
        before = {name: array.copy() for name, array in before.items()}
        process.begin(seeds, episodes, chosen, outcome)
        after = kept(process, outcome)
        for w in np.flatnonzero(chosen)[: budget(12, 2)]:
            first = alone.outcome()
            alone.begin(seeds[[w]], episodes[[w]], np.ones(1, np.bool_), first)
            for name, array in kept(alone, first).items():
                assert np.array_equal(after[name][w], array[0], equal_nan=array.dtype != bool), name
        for name in before:
            if name.startswith(("worlds", "buffers")):
                assert np.array_equal(after[name][~chosen], before[name][~chosen], equal_nan=True)


def test_what_is_seen_at_first_is_what_is_seen_later():
    process = DecisionProcess(5)
    everywhere, first, later = np.ones(5, np.bool_), process.outcome(), process.outcome()
    process.begin(np.arange(5), np.zeros(5, np.int64), everywhere, first)
    process.observe_worlds(everywhere, later)
    for one, other in zip(first, later, strict=True):
        assert np.array_equal(one, other)
