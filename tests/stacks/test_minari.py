"""Minari records a data set from the swarm, from which the environment can be made again."""

import gymnasium as gym
import minari
import numpy as np
import pytest


@pytest.fixture(autouse=True)
def no_other_data_sets(monkeypatch, tmp_path):
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))


@pytest.mark.parametrize("name", ["HAVSwarm-v0", "HAVSingle-v0"])
def test_a_data_set_holds_what_was_seen_and_done(name):
    env = gym.make(f"hav_env:{name}", max_steps=6, scenario="crossing-2")
    collector = minari.DataCollector(env, record_infos=True, data_format="arrow")
    seen, gained = [], []
    for seed in range(3):
        observation, _ = collector.reset(seed=seed)
        seen.append(observation)
        over = False
        while not over:
            observation, reward, terminated, truncated, _ = collector.step(
                env.action_space.sample()
            )
            gained.append(reward)
            over = terminated or truncated
    collector.create_dataset(dataset_id="hav/swarm/random-v0", algorithm_name="random")
    data = minari.load_dataset("hav/swarm/random-v0")
    assert (data.total_episodes, data.total_steps) == (3, 18)
    episodes = list(data.iterate_episodes())
    assert np.concatenate([episode.rewards for episode in episodes]) == pytest.approx(gained)
    for episode, first in zip(episodes, seen, strict=True):
        assert np.array_equal(episode.observations[0], first)
        assert episode.observations.shape == (7, *env.observation_space.shape)
        assert episode.truncations.tolist() == [False] * 5 + [True]
        assert episode.infos["path_length"].shape[0] == 7
    again = data.recover_environment()
    assert np.array_equal(again.reset(seed=0)[0], seen[0])
