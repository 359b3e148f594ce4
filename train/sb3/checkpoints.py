"""This module writes and reads checkpoints of PPO: everything that changes during learning.

A resumed run continues bit for bit. The file holds tensors, numbers and text, and no code:
``train.sb3.tensor_files`` reads it.
"""

import functools
import json
import pathlib
from collections.abc import Callable
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecNormalize

from baselines.storage.atomic_files import whole_file
from train.sb3.tensor_files import array_like, check_worlds, read_plain

_TWISTER = 624  # words of the state of NumPy's Mersenne Twister


def write_checkpoint(
    path: pathlib.Path, learner: PPO, env: VecNormalize, curve: list[dict], seconds: float
) -> None:
    """Write learner, normalizer, worlds and random numbers to a file, whole or not at all.

    Args:
        path: Path of the file.
        learner: The learner, between two iterations.
        env: The environment of the learner.
        curve: The evaluations so far, as values for JSON.
        seconds: Time of learning so far [s].
    """
    _, words, place, has_gauss, gauss = np.random.get_state()  # noqa: NPY002 (SB3 shuffles with it)
    worlds: Any = env.unwrapped
    arrays = {
        **{
            f"{holder} {name}": getattr(owner, name)
            for holder, (owner, names) in _owners(learner, env).items()
            for name in names
        },
        **worlds.arrays(),
        "numpy": np.asarray(words, np.int64),
    }
    state = {
        "policy": dict(learner.policy.state_dict()),
        "moments": learner.policy.optimizer.state_dict()["state"],
        "arrays": {name: torch.as_tensor(np.asarray(array)) for name, array in arrays.items()},
        "torch": torch.get_rng_state(),
        "noise": _noise_of(learner),
        "numbers": {
            "decisions": int(learner.num_timesteps),
            "updates": int(learner._n_updates),
            "place": int(
                place
            ),  # in the words of the twister, then the number it has drawn in advance
            "has_gauss": int(has_gauss),
            "gauss": float(gauss),
        },
        "curve": json.dumps(curve),
        "seconds": float(seconds),
    }
    with whole_file(path) as unfinished:
        torch.save(state, unfinished)


def read_checkpoint(
    path: pathlib.Path, learner: PPO, env: VecNormalize
) -> tuple[list[dict], float, Callable[[], None]]:
    """Restore the state of a checkpoint.

    Args:
        path: Path of the file.
        learner: A learner from the arguments of the run; the function overwrites its state.
        env: The environment of the learner; the function overwrites its state.

    Returns:
        The curve; the seconds; a function that restores the random numbers. The caller calls it at
        the start of the next rollout, after Stable-Baselines3 has drawn the noise that it holds.

    Raises:
        ValueError: If the file is broken, or from another version.
    """
    try:
        state = read_plain(path)
        first = env.reset()
        if "learner _last_obs" in state["arrays"]:
            learner._last_obs, learner._last_episode_starts = first, np.zeros(env.num_envs, bool)
        _restore_learner(state, learner)
        _restore_arrays(state["arrays"], learner, env)
        restore = functools.partial(_restore_random_numbers, state, learner)
        restore()
        return _read_curve(state["curve"]), float(state["seconds"]), restore
    except Exception as error:  # a broken file may raise any error
        told = error if isinstance(error, ValueError) else repr(error)
        raise ValueError(f"cannot go on from {path}: {told}") from None


def _read_curve(text: str) -> list[dict]:
    curve = json.loads(text)
    if not all(isinstance(row["score"], float) for row in curve):
        raise ValueError("its curve has a row without a score")
    return list(curve)


def _owners(learner: PPO, env: VecNormalize) -> dict[str, tuple[Any, tuple[str, ...]]]:
    """Return the objects that hold the arrays of learner and normalizer, and their attributes."""
    moments = ("mean", "var", "count")
    begun = learner._last_obs is not None
    return {
        "learner": (learner, ("_last_obs", "_last_episode_starts") if begun else ()),
        "seen": (env.obs_rms, moments),
        "gained": (env.ret_rms, moments),
        "normalizer": (env, ("returns",)),
    }


def _restore_learner(state: dict[str, Any], learner: PPO) -> None:
    """Copy weights and moments into the learner; their shapes must match."""
    policy, numbers = learner.policy, state["numbers"]
    policy.load_state_dict(state["policy"])
    parameters = list(policy.parameters())
    for number, moments in state["moments"].items():
        for name, moment in moments.items():
            if moment.shape not in {torch.Size(), parameters[number].shape}:
                raise ValueError(f"moment {name} of weights {number} has shape {moment.shape}")
    groups = policy.optimizer.state_dict()["param_groups"]
    policy.optimizer.load_state_dict({"state": state["moments"], "param_groups": groups})
    learner.num_timesteps, learner._n_updates = int(numbers["decisions"]), int(numbers["updates"])


def _restore_arrays(arrays: dict[str, Any], learner: PPO, env: VecNormalize) -> None:
    for holder, (owner, names) in _owners(learner, env).items():
        for name in names:
            value = array_like(getattr(owner, name), arrays, f"{holder} {name}")
            setattr(owner, name, value if value.ndim else value[()])
    worlds: Any = env.unwrapped
    for name, array in worlds.arrays().items():
        array[...] = array_like(array, arrays, name)
    check_worlds(worlds.process.batch.worlds)


def _noise_of(learner: PPO) -> dict[str, torch.Tensor]:
    """Return the noise that is held over actions; empty if each action draws its own."""
    held, names = learner.policy.action_dist, ("exploration_mat", "exploration_matrices")
    return {name: getattr(held, name).detach() for name in names} if learner.use_sde else {}


def _restore_random_numbers(state: dict[str, Any], learner: PPO) -> None:
    numbers = state["numbers"]
    words = array_like(np.zeros(_TWISTER, np.int64), state["arrays"], "numpy").astype(np.uint32)
    place = int(numbers["place"])
    if not 0 <= place <= _TWISTER:  # NumPy would read beyond the words
        raise ValueError(f"the place in NumPy's random numbers is {place}")
    told = ("MT19937", words, place, int(numbers["has_gauss"]), float(numbers["gauss"]))
    np.random.set_state(told)  # noqa: NPY002
    for name, held in _noise_of(learner).items():
        like = held.numpy()
        # a new learner holds the noise of a single row
        shape = (learner.n_envs, *like.shape[1:]) if like.ndim == 3 else like.shape
        value = array_like(np.zeros(shape, like.dtype), state["noise"], name)
        setattr(learner.policy.action_dist, name, torch.from_numpy(value))
    torch.set_rng_state(state["torch"])
