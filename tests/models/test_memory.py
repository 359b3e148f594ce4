"""Worlds that do not fit into memory are rejected before any allocation."""

import re
import sys
import tracemalloc

import gymnasium as gym
import numpy as np
import pytest

from baselines.policies.reserve import Reserve
from hav_env import Batch, Observation, RandomPoses, parallel_env
from hav_env.envs.stable_baselines3 import HAVVecEnv
from hav_env.models.memory import available_memory
from hav_env.policies.interface import allocate_memory
from hav_env.world.arrays import allocate_worlds, world_size
from hav_env.world.units.parts import arrays_in

LITTLE = 2**26  # bytes


@pytest.fixture
def little_memory(monkeypatch):
    """Simulate a machine with almost no memory."""
    monkeypatch.setattr("hav_env.models.memory.available_memory", lambda: LITTLE)


@pytest.mark.parametrize("shape", [(1, 2, 1), (2, 11, 2), (20, 5, 3), (300, 11, 2)])
def test_a_world_takes_what_its_arrays_take(shape):
    worlds = allocate_worlds(3, *shape)
    arrays = arrays_in(worlds)
    # three numbers for each lane are scratch of a block, all others belong to a world
    assert 3 * world_size(*shape) == sum(array.nbytes for array in arrays)


def test_the_size_of_a_world_is_found_without_allocating_it():
    tracemalloc.start()
    try:
        assert world_size(10_000, 101, 1_000) > 2**33
        assert tracemalloc.get_traced_memory()[1] < 2**25
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: Batch(RandomPoses(), 10**6), "num_worlds is 1000000"),
        (lambda: Batch(RandomPoses(num_havs=10_000)), "num_havs is 10000"),
        (lambda: parallel_env(num_havs=10_000), "num_havs is 10000"),
        (lambda: gym.make_vec("hav_env:HAVSwarm-v0", num_envs=10**5), "num_worlds is 100000"),
        (lambda: HAVVecEnv(10**5), "num_worlds is 100000"),
        (
            lambda: parallel_env(num_havs=1_000, observation=Observation(1_000, chains=True)),
            "num_worlds is 1",
        ),
        (lambda: allocate_memory(Reserve(), 100, 1_000), "num_worlds is 1000"),
    ],
)
def test_more_than_there_is_is_refused_by_name(little_memory, make, name):
    with pytest.raises(ValueError, match=re.escape(name) + ", which takes .* GiB, but must take"):
        make()


def test_what_fits_is_allowed(little_memory):
    assert Batch(RandomPoses(), 1_000).num_worlds == 1_000
    parallel_env(num_havs=np.int64(50)).reset(seed=0)


def test_there_is_some_memory_and_not_more_than_an_address_can_name():
    assert 2**28 < available_memory() < sys.maxsize
