"""RLlib steps and trains the swarm through its own wrapper."""

import os

import numpy as np
import pytest

# read when Ray is loaded: no token in the home directory, no report of its use
os.environ["RAY_AUTH_MODE"] = "disabled"
os.environ["RAY_USAGE_STATS_ENABLED"] = "0"

import ray
from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.env.wrappers.pettingzoo_env import ParallelPettingZooEnv
from ray.tune.registry import register_env

from hav_env import Task, explicit, parallel_env

LEAVING = {
    "scenario": explicit(
        [[3.0, 4.0]] * 2, [[0, 0, 0], [0, 30, 0]], [[[2.0, 0, 0]], [[4.0, 30, 0]]]
    ),
    "task": Task(distance_tolerance=1.5, heading_tolerance=4.0),
    "on_goal": "remove",
}
AHEAD = np.array([1.0, 0.0], np.float32)


@pytest.mark.parametrize("settings", [{}, {"num_havs": 3}])
def test_an_episode_ends_for_all_together(settings):
    env = ParallelPettingZooEnv(parallel_env(max_cycles=5, **settings))
    observations, _ = env.reset(seed=0)
    for step in range(1, 6):
        observations, _, ends, cuts, _ = env.step(dict.fromkeys(observations, AHEAD))
        assert cuts["__all__"] == (step == 5)
        assert not ends["__all__"]


def test_who_has_left_is_not_asked_any_more():
    env = ParallelPettingZooEnv(parallel_env(**LEAVING))
    observations, _ = env.reset(seed=0)
    agents, told = sorted(env.agents), []
    assert agents == ["hav_0", "hav_1"]
    for _ in range(100):
        acting = [agent for agent in observations if agent not in told]
        if not acting:
            break
        observations, _, ends, _, _ = env.step(dict.fromkeys(acting, AHEAD))
        told += [agent for agent in acting if ends[agent]]
    assert told == ["hav_0", "hav_1"]
    assert ends["__all__"]


@pytest.fixture
def cluster(monkeypatch, tmp_path):
    """Run Ray in this process, and keep its results out of the home directory."""
    place = "ray.tune.trainable.trainable.DEFAULT_STORAGE_PATH"
    monkeypatch.setattr(place, str(tmp_path), raising=False)
    ray.init(num_cpus=1, include_dashboard=False, log_to_driver=False)
    yield
    ray.shutdown()


@pytest.mark.parametrize("settings", [{"num_havs": 2}, LEAVING], ids=["together", "leaving"])
def test_ppo_trains_one_policy_for_all(cluster, settings):
    register_env("hav", lambda _: ParallelPettingZooEnv(parallel_env(max_cycles=20, **settings)))
    config = (
        PPOConfig()
        .environment("hav")
        .env_runners(num_env_runners=0)
        .training(train_batch_size=128, minibatch_size=64, num_epochs=1)
        .multi_agent(policies={"all"}, policy_mapping_fn=lambda agent, episode, **_: "all")
    )
    algorithm = config.build_algo()
    result = algorithm.train()
    assert np.isfinite(result["env_runners"]["episode_return_mean"])
    assert result["env_runners"]["num_env_steps_sampled_lifetime"] >= 128
    assert np.isfinite(result["learners"]["all"]["total_loss"])
    algorithm.stop()
