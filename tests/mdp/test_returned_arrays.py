"""Returned arrays of an environment never change, however the environment was copied."""

import copy
import pickle

import cloudpickle
import gymnasium as gym
import numpy as np
import pytest

import hav_env
from hav_env.envs.stable_baselines3 import HAVVecEnv
from hav_env.mdp.array_pool import Recycler
from tests.support.budgets import budget

SHORT = {"max_steps": 6}
MANY = budget(400, 3)  # worlds: compiled, their arrays are so large that memory is used again


def out_of_band(env):
    """Copy as Ray and joblib do: buffers apart from the rest."""
    buffers = []
    stream = pickle.dumps(env, protocol=5, buffer_callback=buffers.append)
    return pickle.loads(stream, buffers=[bytearray(buffer.raw()) for buffer in buffers])


COPIES = {
    "itself": lambda env: env,
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    **{
        f"pickle {k}": lambda env, k=k: pickle.loads(pickle.dumps(env, protocol=k))
        for k in range(6)
    },
    "cloudpickle": lambda env: pickle.loads(cloudpickle.dumps(env)),
    "out of band": out_of_band,
    "copied twice": lambda env: out_of_band(copy.deepcopy(out_of_band(env))),
}


class Stable:
    """Stable-Baselines3's worlds behind Gymnasium's calls."""

    def __init__(self, env):
        """Take Stable-Baselines3's worlds."""
        self.env = env

    def reset(self, seed=None):
        return self.env.reset()

    def step(self, action):
        return self.env.step(action)


FACES = {
    "swarm": lambda: gym.make("hav_env:HAVSwarm-v0", **SHORT).unwrapped,
    "single": lambda: gym.make("hav_env:HAVSingle-v0", **SHORT).unwrapped,
    "parallel": lambda: hav_env.parallel_env(**SHORT),
    "vector": lambda: gym.make_vec("hav_env:HAVSwarm-v0", num_envs=MANY, **SHORT).unwrapped,
    "vector, same step": lambda: (
        gym.make_vec(
            "hav_env:HAVSwarm-v0",
            num_envs=MANY,
            autoreset_mode=gym.vector.AutoresetMode.SAME_STEP,
            **SHORT,
        ).unwrapped
    ),
    "vector, ends alone": lambda: (
        gym.make_vec("hav_env:HAVSwarm-v0", num_envs=MANY, info="ends", **SHORT).unwrapped
    ),
    "stable-baselines3": lambda: Stable(HAVVecEnv(MANY, **SHORT)),
}


def actions_of(env):
    if isinstance(env, Stable):
        return np.ones((env.env.num_envs, 2), np.float32)
    if hasattr(env, "possible_agents"):
        return {agent: np.ones(2, np.float32) for agent in env.agents}
    return np.ones(env.action_space.shape, np.float32)


def arrays_in(value):
    """Yield all arrays in the results of an environment."""
    if isinstance(value, np.ndarray):
        if value.dtype == object:
            value = list(value)
        else:
            yield value
            return
    parts = value.values() if isinstance(value, dict) else value
    if isinstance(value, dict | tuple | list):
        for part in parts:
            yield from arrays_in(part)


@pytest.mark.parametrize("how", COPIES)
@pytest.mark.parametrize("face", FACES)
def test_returned_arrays_stay_what_they_were(face, how):
    env = FACES[face]()
    env.reset(seed=0)
    env.step(actions_of(env))
    env = COPIES[how](env)
    kept = []  # views alone: their base arrays are released
    for turn in range(9):  # over the ends of episodes
        told = env.reset() if turn == 4 else env.step(actions_of(env))
        for array in arrays_in(told):
            view = array[..., :1] if array.ndim else array
            kept.append((view, view.copy()))
        del told, array
        if face == "parallel" and not env.agents:
            env.reset()
    assert len(kept) >= 9
    assert all(np.array_equal(view, before, equal_nan=True) for view, before in kept)


@pytest.mark.parametrize("face", ["swarm", "vector", "vector, same step", "stable-baselines3"])
def test_what_a_caller_does_to_returned_arrays_changes_no_later_step(face):
    env, twin = FACES[face](), FACES[face]()
    for one in (env, twin):
        one.reset(seed=5) if not isinstance(one, Stable) else (one.env.seed(5), one.reset())
    for _ in range(5 if face == "swarm" else 9):  # a vector environment continues after the end
        told, expected = env.step(actions_of(env)), twin.step(actions_of(twin))
        for mine, theirs in zip(arrays_in(told), arrays_in(expected), strict=True):
            assert np.array_equal(mine, theirs, equal_nan=True)
            mine[...] = 1


def test_memory_is_used_again_when_nobody_holds_any_part_of_it():
    lender = Recycler([((1_000, 70), np.float64), ((3, 5), np.float32)])
    large, small = lender.arrays()
    place = large.ctypes.data
    view = memoryview(large[3:5].T)
    del large
    assert lender.arrays()[0].ctypes.data != place
    del small
    assert lender.arrays()[0].ctypes.data != place
    del view
    assert place in {lender.arrays()[0].ctypes.data for _ in range(2)}
    assert pickle.loads(pickle.dumps(lender)).arrays()[0].shape == (1_000, 70)


def test_lent_arrays_are_as_compiled_code_wants_them():
    for array in Recycler([((999, 71), np.float32), ((4, 5, 6), np.float64)]).arrays():
        assert array.flags.c_contiguous
        assert array.flags.aligned
        assert array.flags.writeable
