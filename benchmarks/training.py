"""This module measures the speed of PPO, beside the same PPO on worlds that cost nothing.

``python -m benchmarks.training`` prints the table of benchmarks/README.md. Both learn in turns, so
a shared machine slows both equally.
"""

import dataclasses
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import tyro
from rich.console import Console
from stable_baselines3.common.vec_env import VecEnv, VecNormalize

from benchmarks.tables import new_table, rate_text
from benchmarks.turns import medians_in_turns
from train.loops.arguments import LoopArguments
from train.sb3.arguments import PPO_PRESETS, Arguments
from train.sb3.learner import make_learner, make_worlds


class EmptyVecEnv(VecEnv):
    """Rows and spaces of other worlds; nothing is simulated and no episode ends."""

    render_mode = None

    def __init__(self, like: VecEnv) -> None:
        """Copy the rows and spaces of other worlds.

        Args:
            like: Worlds to imitate.
        """
        super().__init__(like.num_envs, like.observation_space, like.action_space)
        shape = (like.num_envs, *(like.observation_space.shape or ()))
        self._observation = np.random.default_rng(0).random(shape, np.float32)

    def reset(self) -> np.ndarray:
        """Return the same values as ``step``."""
        return self._observation.copy()

    def step_async(self, actions: np.ndarray) -> None:
        """Do nothing."""

    def step_wait(self) -> Any:
        """Return the observations of the beginning."""
        nothing = np.zeros(self.num_envs, np.float32)
        infos: list[dict] = [{} for _ in range(self.num_envs)]
        return self._observation.copy(), nothing, np.zeros(self.num_envs, bool), infos

    def close(self) -> None:
        """Do nothing."""

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute, the same for all rows."""
        return [getattr(self, attr_name)] * self.num_envs

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set an attribute."""
        setattr(self, attr_name, value)

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list:
        """Raise an error: there are no methods."""
        raise AttributeError(method_name)

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """Return False for all rows: no row is wrapped."""
        return [False] * self.num_envs


def prepare(
    arguments: Arguments | LoopArguments,
    empty: bool,
    iterations: int,
    clock: Callable[[], float] = time.perf_counter,
) -> Callable[[], float]:
    """Return a warm function that learns for some iterations and returns decisions/s by a clock."""
    worlds: VecEnv = make_worlds(arguments)
    if empty:
        worlds = EmptyVecEnv(worlds)
    env = VecNormalize(worlds, gamma=arguments.discount)
    env.seed(1)
    learner = make_learner(arguments, env)
    each = env.num_envs * arguments.rollout_decisions
    learner.learn(each)

    def run() -> float:
        begun = clock()
        learner.learn(iterations * each, reset_num_timesteps=False)
        return iterations * each / (clock() - begun)

    return run


def main(iterations: int = 3, repetitions: int = 5) -> None:
    """Measure the presets.

    Args:
        iterations: Rollouts with their updates in one turn.
        repetitions: Number of turns, whose median counts.
    """
    import torch  # noqa: PLC0415 (the number of threads is the arguments')

    runs = {}
    for name in ("single", "pair"):
        arguments = dataclasses.replace(PPO_PRESETS[name], threads=1)
        torch.set_num_threads(arguments.threads)
        for empty in (False, True):
            runs[name, empty] = prepare(arguments, empty, iterations)
    rates = medians_in_turns(runs, repetitions)
    table = new_table("PPO, one thread, decisions/s", "preset", "HAVs", "nothing", "ratio")
    for name in ("single", "pair"):
        ours, empty = rates[name, False], rates[name, True]
        table.add_row(name, rate_text(ours), rate_text(empty), f"{ours / empty:.2f}")
    Console().print(table)


if __name__ == "__main__":
    tyro.cli(main)
