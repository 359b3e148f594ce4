"""Stable-Baselines3 trains on the swarm: rows, ends, seeds, its wrappers and its algorithms."""

import numpy as np
import pytest
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import EvalCallback
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

from hav_env import Task, parallel_env
from hav_env.envs.stable_baselines3 import HAVVecEnv
from tests.support.budgets import budget
from tests.support.comparing import exactly
from tests.support.worlds import side_by_side

AHEAD = np.array([1.0, 0.0], np.float32)


def drive(env, steps, action=AHEAD):
    """Yield the results of every step."""
    for _ in range(steps):
        yield env.step(np.tile(action, (env.num_envs, 1)))


def small_ppo(env, seed=0, **settings):
    return PPO("MlpPolicy", env, n_steps=16, batch_size=16, n_epochs=1, seed=seed, **settings)


def weights_of(model):
    return torch.cat([p.detach().flatten() for p in model.policy.parameters()])


def test_a_row_is_a_hav_as_its_agent_sees_it():
    vec, env = HAVVecEnv(1, num_havs=3, max_steps=30), parallel_env(num_havs=3, max_steps=30)
    vec.seed(4)
    rows, (observations, _) = vec.reset(), env.reset(seed=4)
    rng = np.random.default_rng(0)
    assert vec.observation_space == env.observation_space("hav_0")
    for step in range(1, 31):
        assert np.array_equal(rows, np.stack(list(observations.values())))
        actions = rng.uniform(-1, 1, (3, 2)).astype(np.float32)
        named = dict(zip(env.possible_agents, actions, strict=True))
        observations, rewards, _, truncations, infos_then = env.step(named)
        rows, gained, ends, infos = vec.step(actions)
        assert gained.dtype == np.float32
        assert gained == pytest.approx(list(rewards.values()), rel=1e-6)
        assert ends.tolist() == list(truncations.values()) == [step == 30] * 3
    for k, info in enumerate(infos):
        assert np.array_equal(info["terminal_observation"], observations[f"hav_{k}"])
        assert info["TimeLimit.truncated"] is True
        assert {name: info[name] for name in infos_then["hav_0"]} == infos_then[f"hav_{k}"]


def test_rows_of_a_world_end_together_and_go_on_at_once():
    task = Task(max_steps=30, distance_tolerance=1.5, heading_tolerance=4.0)
    env = HAVVecEnv(3, scenario=side_by_side(2.0, 4.0), task=task)
    env.seed(0)
    begin = env.reset().copy()
    for rows, _, ends, infos in drive(env, 40):
        assert (ends.reshape(3, 2).all(axis=1) == ends.reshape(3, 2).any(axis=1)).all()
        for row in np.flatnonzero(ends):
            assert np.array_equal(rows[row], begin[row])  # every episode of this world is the same
            assert not np.array_equal(infos[row]["terminal_observation"], begin[row])
            assert infos[row]["TimeLimit.truncated"] is False
            assert infos[row]["is_success"] == 1.0
        for row in np.flatnonzero(~ends):
            assert infos[row] == {}


def test_a_time_out_is_told_from_an_end():
    """A time-out does not end the value: it is reported as such, with the last observation."""
    cut = HAVVecEnv(1, scenario=side_by_side(4.0), max_steps=3)
    cut.reset()
    *_, (_, _, ends, infos) = drive(cut, 3)
    assert ends.all()
    assert infos[0]["TimeLimit.truncated"] is True
    assert infos[0]["is_success"] == 0.0
    plain = HAVVecEnv(1, scenario=side_by_side(4.0))
    plain.reset()
    *_, (rows, *_) = drive(plain, 3)
    assert np.array_equal(infos[0]["terminal_observation"], rows[0])


def test_what_is_lost_beyond_a_time_out_is_added_to_the_reward():
    """The algorithm itself reads the flag and the observation: gamma times their value."""
    env = HAVVecEnv(1, scenario=side_by_side(90.0), max_steps=16)
    model = PPO("MlpPolicy", env, n_steps=16, batch_size=16, n_epochs=1, seed=0, gamma=0.5)
    with torch.no_grad():
        model.policy.value_net.weight.zero_()
        model.policy.value_net.bias.fill_(1_000.0)
    _, callback = model._setup_learn(16)
    model.collect_rollouts(env, callback, model.rollout_buffer, 16)
    rewards = model.rollout_buffer.rewards[:, 0]
    assert np.abs(rewards[:-1]).max() < 10.0
    assert rewards[-1] == pytest.approx(500.0, abs=10.0)


def run(seed, worlds=3, steps=budget(40, 8)):
    env, rng = HAVVecEnv(worlds, max_steps=10), np.random.default_rng(0)
    env.seed(seed)
    told = [env.reset()]
    for _ in range(steps):
        told.append(env.step(rng.uniform(-1, 1, (env.num_envs, 2)).astype(np.float32)))
    return exactly(told)


def test_one_seed_gives_one_run_and_every_world_a_seed_of_its_own():
    assert run(7) == run(7)
    assert run(7) != run(8)
    env = HAVVecEnv(50)
    env.seed(3)
    rows = env.reset()
    assert len({row.tobytes() for row in rows}) == len(rows)
    assert not np.array_equal(rows, env.reset())  # the next episodes
    env.seed(3)
    assert np.array_equal(rows, env.reset())


def test_without_a_seed_runs_differ():
    assert not np.array_equal(HAVVecEnv(1).reset(), HAVVecEnv(1).reset())


def test_what_is_returned_is_not_used_any_more():
    env, before = HAVVecEnv(2, max_steps=3), []
    env.seed(0)
    env.reset()
    for rows, rewards, ends, infos in drive(env, 8):
        arrays = [rows, rewards, ends, *(info["terminal_observation"] for info in infos if info)]
        for array in arrays:
            assert not any(np.shares_memory(array, earlier) for earlier in before)
        before += arrays


def test_episodes_are_monitored():
    env = VecMonitor(HAVVecEnv(2, max_steps=5))
    env.reset()
    total = np.zeros(env.num_envs)
    told = list(drive(env, 5))
    for _, rewards, *_ in told:
        total += rewards
    *_, ends, infos = told[-1]
    assert ends.all()
    assert [info["episode"]["l"] for info in infos] == [5] * env.num_envs
    assert [info["episode"]["r"] for info in infos] == pytest.approx(total, abs=1e-5)


def test_normalisation_can_be_saved_and_loaded(tmp_path):
    env = VecNormalize(HAVVecEnv(2, max_steps=5))
    env.reset()
    for rows, *_ in drive(env, 12):
        assert np.isfinite(rows).all()
    env.save(tmp_path / "scales.pkl")
    fresh = VecNormalize.load(tmp_path / "scales.pkl", HAVVecEnv(2, max_steps=5))
    original = env.get_original_obs()
    assert np.array_equal(fresh.normalize_obs(original), env.normalize_obs(original))


def test_training_counts_evaluates_and_keeps_the_best(tmp_path):
    env = VecMonitor(HAVVecEnv(2, max_steps=20))
    callback = EvalCallback(
        VecMonitor(HAVVecEnv(2, max_steps=20)),
        n_eval_episodes=4,
        eval_freq=16,
        log_path=str(tmp_path),
        best_model_save_path=str(tmp_path),
        verbose=0,
    )
    model = small_ppo(env)
    model.learn(budget(512, 128), callback=callback)
    assert len(model.ep_info_buffer) > 0
    assert len(model.ep_success_buffer) > 0  # of "is_success"
    found = np.load(tmp_path / "evaluations.npz")
    assert found["successes"].shape == found["results"].shape
    mean, _ = evaluate_policy(
        PPO.load(tmp_path / "best_model"), VecMonitor(HAVVecEnv(2, max_steps=20)), 4
    )
    assert np.isfinite(mean)


def test_training_without_a_monitor_is_possible_too():
    small_ppo(HAVVecEnv(2, max_steps=5)).learn(128)


@pytest.mark.parametrize("settings", [{}, {"on_goal": "remove", "num_havs": 3}])
def test_two_trainings_with_one_seed_are_the_same(settings):
    def learn(seed):
        model = small_ppo(HAVVecEnv(2, max_steps=10, **settings), seed)
        before = weights_of(model)
        after = weights_of(model.learn(budget(512, 64)))
        assert torch.isfinite(after).all()
        assert not torch.equal(before, after)
        return after

    assert torch.equal(learn(1), learn(1))
    assert not torch.equal(learn(1), learn(2))


def test_training_goes_on_where_it_was_saved(tmp_path):
    model = small_ppo(HAVVecEnv(2, max_steps=10))
    model.learn(64)
    model.save(tmp_path / "model")
    loaded = PPO.load(tmp_path / "model", env=HAVVecEnv(2, max_steps=10))
    assert torch.equal(weights_of(model), weights_of(loaded))
    loaded.learn(64, reset_num_timesteps=False)
    assert loaded.num_timesteps == 128
    assert not torch.equal(weights_of(model), weights_of(loaded))


def test_the_joint_environment_trains_by_its_name():
    model = PPO(
        "MlpPolicy", "hav_env:HAVSingle-v0", n_steps=16, batch_size=16, n_epochs=1, device="cpu"
    )
    before = weights_of(model)
    assert not torch.equal(before, weights_of(model.learn(32)))


def test_the_swarm_trains_as_one_actor():
    import gymnasium as gym

    env = gym.make("hav_env:HAVSwarm-v0", flatten=True, max_steps=10)
    model = small_ppo(env)
    before = weights_of(model)
    model.learn(128)
    assert not torch.equal(before, weights_of(model))
    assert len(model.ep_info_buffer) > 0


def test_attributes_and_methods_are_found_by_row():
    env = HAVVecEnv(2)
    assert env.get_attr("render_mode") == [None] * 4
    assert env.get_attr("render_mode", [1, 2]) == [None] * 2
    assert env.env_is_wrapped(VecMonitor) == [False] * 4
    assert env.env_method("close") == [None] * 4
    assert env.env_method("close", indices=[3, 2, 1, 0]) == [None] * 4
    env.set_attr("note", 5)
    assert env.get_attr("note", 3) == [5]
    assert env.get_attr("note", -1) == [5]


@pytest.mark.parametrize(
    ("kind", "indices"),
    [(ValueError, 1), (ValueError, [0, 1, 2]), (ValueError, 4), (TypeError, 1.0), (TypeError, "0")],
)
def test_what_all_rows_share_is_not_set_for_some(kind, indices):
    env = HAVVecEnv(2)
    with pytest.raises(kind, match="indices"):
        env.set_attr("note", 5, indices)
    with pytest.raises(kind, match="indices"):
        env.env_method("close", indices=indices)
    assert not hasattr(env, "note")
