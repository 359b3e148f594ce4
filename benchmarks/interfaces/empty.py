"""This module has empty environments, which measure the cost of Python.

They return the same types as another environment, and simulate nothing.
"""

from typing import Any, ClassVar

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec
from pettingzoo import ParallelEnv


class EmptyParallelEnv(ParallelEnv):
    """Agents, spaces and info names of another environment, whose episodes never end."""

    metadata: ClassVar[dict[str, Any]] = {"name": "empty_v0", "render_modes": []}

    def __init__(self, like: ParallelEnv) -> None:
        """Copy the description of the other environment."""
        observations, infos = like.reset(seed=0)
        self.possible_agents, self.agents = like.possible_agents.copy(), []
        self.observation_spaces = {a: like.observation_space(a) for a in self.possible_agents}
        self.action_spaces = {a: like.action_space(a) for a in self.possible_agents}
        first = self.possible_agents[0]
        self._size, self._names = observations[first].size, tuple(infos[first])

    def observation_space(self, agent: str) -> gym.Space:
        """Return the space of an agent's observations."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gym.Space:
        """Return the space of an agent's actions."""
        return self.action_spaces[agent]

    def reset(self, seed: int | None = None, options: dict | None = None) -> tuple[dict, dict]:
        """Return zeros."""
        self.agents = self.possible_agents.copy()
        return self._observations(), self._infos()

    def step(self, actions: dict[str, Any]) -> tuple[dict, dict, dict, dict, dict]:
        """Return zeros for any actions."""
        return (
            self._observations(),
            dict.fromkeys(self.agents, 0.0),
            dict.fromkeys(self.agents, False),
            dict.fromkeys(self.agents, False),
            self._infos(),
        )

    def _observations(self) -> dict[str, np.ndarray]:
        return {agent: np.zeros(self._size, np.float32) for agent in self.agents}

    def _infos(self) -> dict[str, dict[str, float]]:
        return {agent: dict.fromkeys(self._names, 0.0) for agent in self.agents}


class EmptyEnv(gym.Env):
    """Spaces and info names of another environment, whose episodes never end."""

    def __init__(self, like: str) -> None:
        """Copy the description of the environment with this id."""
        env = gym.make(like)
        _, info = env.reset(seed=0)
        self.observation_space, self.action_space = env.observation_space, env.action_space
        self._names, self._shape = tuple(info), np.shape(next(iter(info.values())))
        env.close()

    def reset(
        self, *, seed: int | None = None, options: dict | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Return zeros."""
        super().reset(seed=seed)
        return self._observation(), self._info()

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Return zeros for any action."""
        return self._observation(), 0.0, False, False, self._info()

    def _observation(self) -> np.ndarray:
        return np.zeros(self.observation_space.shape, np.float32)

    def _info(self) -> dict[str, Any]:
        """Return numbers or arrays of the shapes of the other environment."""
        if not self._shape:
            return dict.fromkeys(self._names, 0.0)
        return dict(zip(self._names, np.zeros((len(self._names), *self._shape)), strict=True))


def make_empty(like: str) -> gym.Env:
    """Make an empty environment by ``gym.make``, with the wrappers of all its environments."""
    return gym.make(EnvSpec("Empty-v0", entry_point=EmptyEnv), like=like)
