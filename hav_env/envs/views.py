"""This module presents a decision process to Gymnasium: all HAVs as one agent, or the first HAV."""

import functools
import operator
from typing import Literal, get_args

import numpy as np
from gymnasium import spaces

from hav_env.mdp.decision_process import DecisionProcess
from hav_env.models.annotations import show
from hav_env.observation import list_columns

Team = Literal["mean", "sum", "min"]


def observation_box(process: DecisionProcess, *shape: int) -> spaces.Box:
    """Return the space of observations (*shape, D)."""
    columns = list_columns(process.observation, process.batch.scenario.max_trailers)
    low, high = np.array([(column.low, column.high) for column in columns], np.float32).T
    return spaces.Box(
        np.broadcast_to(low, (*shape, low.size)).copy(),
        np.broadcast_to(high, (*shape, low.size)).copy(),
        dtype=np.float32,
    )


def action_box(*shape: int) -> spaces.Box:
    """Return the space of actions (*shape, 2): speed and steering."""
    return spaces.Box(-1.0, 1.0, (*shape, 2), np.float32)


def _flat(box: spaces.Box) -> spaces.Box:
    return spaces.Box(box.low.ravel(), box.high.ravel(), dtype=np.float32)


class JointView:
    """All HAVs of a world as one agent: observation (N, D), action (N, 2), one reward."""

    def __init__(self, process: DecisionProcess, team_reward: Team, flatten: bool) -> None:
        """Present a process; ``flatten`` makes spaces with one axis.

        Raises:
            ValueError: If ``team_reward`` is unknown; TypeError: if ``flatten`` is not a bool.
        """
        if not isinstance(team_reward, str) or team_reward not in get_args(Team):
            known = ", ".join(get_args(Team))
            raise ValueError(f"team_reward is {show(team_reward)}, but must be one of {known}")
        if not isinstance(flatten, bool):
            raise TypeError(f"flatten is {show(flatten)}, but must be True or False")
        self.team_reward = team_reward
        self.observation_space = observation_box(process, process.num_havs)
        self.action_space = action_box(process.num_havs)
        if flatten:
            self.observation_space = _flat(self.observation_space)
            self.action_space = _flat(self.action_space)
        self._shape = self.observation_space.shape
        self._flat = flatten

    def observation(self, observation: np.ndarray) -> np.ndarray:
        """Return a copy of the observation (N, D) of one world in the shape of the space."""
        seen = observation.copy()
        return seen.ravel() if self._flat else seen

    def observations(self, observation: np.ndarray) -> np.ndarray:
        """Return the observations (W, N, D) as (W, *shape of the space)."""
        return observation.reshape(-1, *self._shape)

    def rewards(self, reward: np.ndarray) -> np.ndarray:
        """Return the team rewards (W,) of (N, W); HAVs are added in order, whatever W is."""
        if self.team_reward == "min":
            return reward.min(axis=0)
        total = reward[0] + reward[1] if len(reward) > 1 else reward[0].copy()
        for own in reward[2:]:
            total += own
        if self.team_reward == "mean":
            total /= float(len(reward))
        return total

    def reward(self, reward: list[float]) -> float:
        """Return the team reward of one world, given (N,): bit-equal to ``rewards``."""
        if self.team_reward == "min":
            return min(reward)
        total = functools.reduce(operator.add, reward)
        return total if self.team_reward == "sum" else total / len(reward)

    def numbers(self, info: np.ndarray) -> np.ndarray:
        """Return the infos (K, N, W) as a view (K, W, N)."""
        return info.transpose(0, 2, 1)


class EgoView:
    """The first HAV of a world as the agent: observation (D,), action (2,)."""

    def __init__(self, process: DecisionProcess) -> None:
        """Present a process."""
        self.observation_space = observation_box(process)
        self.action_space = action_box()

    def observation(self, observation: np.ndarray) -> np.ndarray:
        """Return a copy of the observation (1, D) of one world as (D,)."""
        return observation[0].copy()

    def observations(self, observation: np.ndarray) -> np.ndarray:
        """Return the observations (W, 1, D) as (W, D)."""
        return observation[:, 0]

    def rewards(self, reward: np.ndarray) -> np.ndarray:
        """Return the rewards (1, W) as a view (W,)."""
        return reward[0]

    def reward(self, reward: list[float]) -> float:
        """Return the reward of (1,)."""
        return reward[0]

    def numbers(self, info: np.ndarray) -> np.ndarray:
        """Return the infos (K, 1, W) as a view (K, W)."""
        return info[:, 0]
