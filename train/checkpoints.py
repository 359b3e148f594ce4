"""Everything that changes while a PPO learns, in one file: who reads it goes on bit for bit."""

import pathlib
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecNormalize

from baselines.files import whole_file


def write_checkpoint(path: pathlib.Path, learner: PPO, env: VecNormalize, more: Any) -> None:
    """Write down learner, normalizer, worlds and random numbers; there is never half a file.

    Args:
        path: of the file.
        learner, env: between two iterations.
        more: whatever else is to be kept.
    """
    state = {
        "policy": learner.policy.state_dict(),
        "optimizer": learner.policy.optimizer.state_dict(),
        "decisions": learner.num_timesteps,
        "updates": learner._n_updates,
        "observation": learner._last_obs,
        "starts": learner._last_episode_starts,
        "normalizer": (env.obs_rms, env.ret_rms, env.returns),
        "worlds": env.unwrapped,
        "torch": torch.get_rng_state(),
        "numpy": np.random.get_state(),  # noqa: NPY002 (SB3 shuffles with it)
        "more": more,
    }
    with whole_file(path) as unfinished:
        torch.save(state, unfinished)


def read_checkpoint(path: pathlib.Path, learner: PPO, env: VecNormalize) -> Any:
    """Go back to where a checkpoint was written; return what else was kept.

    Raises:
        ValueError: when it is broken, or was written by another version.
    """
    try:
        state = torch.load(path, weights_only=False)
        learner.policy.load_state_dict(state["policy"])
        learner.policy.optimizer.load_state_dict(state["optimizer"])
        learner.num_timesteps, learner._n_updates = state["decisions"], state["updates"]
        learner._last_obs, learner._last_episode_starts = state["observation"], state["starts"]
        env.obs_rms, env.ret_rms, env.returns = state["normalizer"]
        env.venv = state["worlds"]
        torch.set_rng_state(state["torch"])
        np.random.set_state(state["numpy"])  # noqa: NPY002
        return state["more"]
    except Exception as error:  # a broken pickle can raise anything
        raise ValueError(f"cannot go on from {path}: {error!r}") from None
