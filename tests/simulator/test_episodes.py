"""An episode has a seed and a number, and is the same in every interface."""

import copy
import pickle

import gymnasium as gym
import numpy as np
import pettingzoo
import pytest

from hav_env import Batch, RandomFleet, RandomPoses, find_scenario, parallel_env
from hav_env.envs.stable_baselines3 import HAVVecEnv
from hav_env.world.arrays import FOOTPRINT
from tests.support.budgets import budget
from tests.support.comparing import exactly

SWARM = "hav_env:HAVSwarm-v0"


def start_of(worlds, w=0):
    return worlds.state.x[:, w].tolist(), worlds.goals[..., w].tolist()


def drawn(seed, episode, scenario="paper-pair"):
    """Return the starts and goals of an episode of the simulator."""
    batch = Batch(find_scenario(scenario), 1)
    batch.reset(seed, np.array([episode]))
    return start_of(batch.worlds)


def test_resets_go_through_the_episodes_of_a_seed():
    for env in (parallel_env(), gym.make(SWARM).unwrapped):
        env.reset(seed=11)
        for episode in range(3):
            assert start_of(env._world.process.batch.worlds) == drawn(11, episode)
            env.reset()
        env.reset(seed=11, options={"episode": 40})
        assert start_of(env._world.process.batch.worlds) == drawn(11, 40)
        env.reset()
        assert start_of(env._world.process.batch.worlds) == drawn(11, 41)


def test_a_vector_goes_through_the_episodes_of_its_seeds():
    env = gym.make_vec(SWARM, num_envs=3, max_steps=2, autoreset_mode="SameStep")
    env.reset(seed=20)
    for episode in range(3):
        for w in range(3):
            assert start_of(env._process.batch.worlds, w) == drawn(20 + w, episode)
        for _ in range(2):
            env.step(np.zeros(env.action_space.shape))


def test_rows_of_stable_baselines_go_through_the_episodes_of_a_seed():
    env = HAVVecEnv(1, max_steps=2)
    env.seed(20)
    env.reset()
    for episode in range(3):
        assert start_of(env.process.batch.worlds) == drawn(20, episode)
        for _ in range(2):
            env.step(np.zeros((2, 2)))


def test_the_episode_is_told():
    env = parallel_env(num_havs=3)
    _, infos = env.reset(seed=2**32 - 1, options={"episode": 7})
    for info in infos.values():
        assert (info["seed"], info["episode_number"]) == (2.0**32 - 1, 7.0)


def test_without_a_seed_the_first_episode_is_any():
    seeds = {parallel_env().reset()[1]["hav_0"]["seed"] for _ in range(3)}
    assert len(seeds) == 3


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_what_is_written_in_does_not_change_what_is_not(share):
    """The footprint of a HAV follows the rule of its fleet, also where its start is another."""
    fleet = RandomFleet(footprint_truck_share=share)
    env = parallel_env(scenario=RandomPoses(num_havs=1, fleet=fleet))
    env.reset(seed=3)
    worlds = env._world.process.batch.worlds
    radius, lengths = worlds.fleet.radius.copy(), worlds.fleet.length.copy()
    goals, limits = worlds.goals.copy(), worlds.fleet.limit.copy()
    env.reset(seed=3, options={"start": [[1.0, 2.0, 3.0]]})
    assert worlds.state.x[0, 0] == 1.0
    assert np.array_equal(worlds.fleet.length, lengths)
    assert np.array_equal(worlds.fleet.limit, limits)
    assert np.array_equal(worlds.goals, goals)
    assert worlds.fleet.radius[0, FOOTPRINT] == pytest.approx(radius[0, FOOTPRINT])


@pytest.mark.parametrize("begun", [False, True])
@pytest.mark.parametrize("copied", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_a_copy_goes_on_by_itself(copied, begun):
    env = gym.make(SWARM).unwrapped
    env.reset(seed=1)
    action = np.full((2, 2), 0.5)
    if begun:
        env.step(action)
    other = copied(env)
    for _ in range(budget(20, 3)):
        assert exactly(env.step(action)) == exactly(other.step(action))


def test_environments_are_found_by_their_names():
    assert {"HAVSwarm-v0", "HAVSingle-v0"} <= set(gym.registry)
    if hasattr(pettingzoo, "make"):  # from 1.27 on
        env = pettingzoo.make("parallel", "hav/swarm-v0", max_cycles=3)
        env.reset(seed=0)
        assert env.unwrapped.max_cycles == 3


@pytest.mark.parametrize("mode", ["sync", "async"])
def test_gymnasium_can_run_single_worlds_side_by_side(mode):
    env = gym.make_vec(SWARM, num_envs=2, vectorization_mode=mode, max_steps=3)
    native = gym.make_vec(SWARM, num_envs=2, max_steps=3)
    assert np.array_equal(env.reset(seed=4)[0], native.reset(seed=4)[0])
    for _ in range(5):
        actions = np.full(env.action_space.shape, 0.5, np.float32)
        assert np.array_equal(env.step(actions)[0], native.step(actions)[0])
    env.close()
