"""Everything that changes while a PPO learns, in one file: who reads it goes on bit for bit.

The file holds numbers and text alone: reading it runs no code, whoever wrote it.
"""

import json
import pathlib
import pickle
import zipfile
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecNormalize

from baselines.files import whole_file
from train.sb3_env import HAVVecEnv

_ENGINE = "MT19937"  # of NumPy's global random numbers


def write_checkpoint(path: pathlib.Path, learner: PPO, env: VecNormalize, more: Any) -> None:
    """Write down learner, normalizer, worlds and random numbers; there is never half a file.

    Args:
        path: of the file.
        learner, env: between two iterations.
        more: whatever else is to be kept, as JSON knows it.
    """
    if learner._last_obs is None:
        _begin(learner, env)
    _, numbers, *places = np.random.get_state()  # noqa: NPY002 (SB3 shuffles with it)
    arrays = {name: torch.from_numpy(array) for name, array in _arrays(learner, env).items()}
    state = {
        "policy": learner.policy.state_dict(),
        "optimizer": learner.policy.optimizer.state_dict(),
        "decisions": int(learner.num_timesteps),
        "updates": int(learner._n_updates),
        "arrays": arrays,
        "counts": [float(seen.count) for seen in _statistics(env)],
        "torch": torch.get_rng_state(),
        "numpy": torch.from_numpy(np.asarray(numbers, np.int64)),
        "numpy places": [float(place) for place in places],
        "more": json.dumps(more),
    }
    with whole_file(path) as unfinished:
        torch.save(state, unfinished)


def read_checkpoint(path: pathlib.Path, learner: PPO, env: VecNormalize) -> Any:
    """Go back to where a checkpoint was written; return what else was kept.

    Args:
        path: of the file.
        learner, env: made anew by the same arguments.

    Raises:
        ValueError: when it is broken, or was written by another version.
    """
    try:
        state = _load(path)
        _begin(learner, env)  # episodes, which are then overwritten
        _fill(_arrays(learner, env), state["arrays"])
        learner.policy.load_state_dict(state["policy"])
        _set_moments(learner.policy.optimizer, state["optimizer"])
        learner.num_timesteps, learner._n_updates = state["decisions"], state["updates"]
        for seen, count in zip(_statistics(env), state["counts"], strict=True):
            seen.count = count
        torch.set_rng_state(state["torch"])
        position, has_gauss, gauss = state["numpy places"]
        numbers = state["numpy"].numpy().astype(np.uint32)
        np.random.set_state((_ENGINE, numbers, int(position), int(has_gauss), gauss))  # noqa: NPY002
        return json.loads(state["more"])
    except pickle.UnpicklingError:
        raise ValueError(f"cannot go on from {path}: it holds more than numbers") from None
    except Exception as error:  # what is broken may break the reading anywhere
        told = " ".join(f"{type(error).__name__}: {error}".split())
        raise ValueError(f"cannot go on from {path}: {told:.300}") from None


def _load(path: pathlib.Path) -> dict[str, Any]:
    """Read numbers and text; PyTorch does not pack them, so that they are no larger than the file.

    Raises:
        ValueError, pickle.UnpicklingError: when the file holds anything else.
    """
    with zipfile.ZipFile(path) as archive:
        if any(member.compress_type != zipfile.ZIP_STORED for member in archive.infolist()):
            raise ValueError("it is packed, which PyTorch does not do")
    state = torch.load(path, map_location="cpu", weights_only=True)
    if not isinstance(state, dict):
        raise ValueError(f"it holds a {type(state).__name__}, but must hold a dict")
    return state


def _begin(learner: PPO, env: VecNormalize) -> None:
    """Begin the first episodes, as the learner does where there are none."""
    learner._last_obs = env.reset()
    learner._last_episode_starts = np.ones(env.num_envs, np.bool_)


def _statistics(env: VecNormalize) -> tuple[Any, Any]:
    return env.obs_rms, env.ret_rms


def _arrays(learner: PPO, env: VecNormalize) -> dict[str, np.ndarray]:
    """Return all arrays that change, by name, to be read and to be overwritten."""
    worlds = env.unwrapped
    assert isinstance(worlds, HAVVecEnv)
    told: dict[str, Any] = {
        "observation": learner._last_obs,
        "starts": learner._last_episode_starts,
        "returns": env.returns,
    }
    for name, seen in zip(("seen", "gained"), _statistics(env), strict=True):
        told |= {f"{name}.mean": seen.mean, f"{name}.var": seen.var}
    told |= worlds.arrays()
    return {name: np.asarray(array) for name, array in told.items()}


def _fill(arrays: dict[str, np.ndarray], kept: dict[str, torch.Tensor]) -> None:
    """Overwrite arrays with those that were kept.

    Raises:
        ValueError: when they are others, or of another shape or type.
    """
    if set(arrays) != set(kept):
        odd = sorted(set(arrays) ^ set(kept), key=str)[0]
        raise ValueError(f"it does not hold the same arrays: {odd!r:.80}")
    for name, array in arrays.items():
        found = kept[name].numpy()
        if (found.shape, found.dtype) != (array.shape, array.dtype):
            rule = f"but must be {array.dtype} of shape {array.shape}"
            raise ValueError(f"{name} is {found.dtype} of shape {found.shape}, {rule}")
    for name, array in arrays.items():
        array[...] = kept[name].numpy()


def _set_moments(optimizer: torch.optim.Optimizer, kept: dict[str, Any]) -> None:
    """Set what an optimizer remembers of its parameters.

    Raises:
        ValueError: when a shape is not that of its parameter.
    """
    optimizer.load_state_dict(kept)
    for parameter, moments in optimizer.state.items():
        for name, moment in moments.items():
            if moment.shape not in (parameter.shape, ()):
                raise ValueError(f"{name} of the optimizer is of shape {tuple(moment.shape)}")
