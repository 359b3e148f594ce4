"""This module converts actions from physical units: speed [m/s] and steering [rad]."""

from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from pettingzoo.utils.wrappers import BaseParallelWrapper

from hav_env.envs.gymnasium_single import HAVSingleEnv, HAVSwarmEnv
from hav_env.envs.hav_swarm_v0 import HAVSwarmParallelEnv
from hav_env.mdp.actions import check_mapping, read_action
from hav_env.world.arrays import SPEED, STEERING
from hav_env.world.sensing import own_speed, own_steering


class _Units:
    """Converts m/s and rad to [-1, 1] by the limits of each HAV.

    The space covers the HAV with the largest limits; actions of other HAVs are clipped to theirs.
    """

    def __init__(self, env: HAVSwarmEnv | HAVSingleEnv | HAVSwarmParallelEnv) -> None:
        limits = env.scenario.fleet
        self.most = np.array([limits.speed_max, limits.steering_max])
        self._process = env._world.process

    def _limits(self) -> np.ndarray:
        """Return the largest speed [m/s] and steering [rad] of every HAV, (N, 2)."""
        return self._process.batch.worlds.fleet.limit[:, [SPEED, STEERING], 0]

    def actual(self) -> np.ndarray:
        """Return speed [m/s] and steering [rad] of every HAV in the last step, (N, 2)."""
        worlds, havs = self._process.batch.worlds, range(self._process.num_havs)
        pairs = [(own_speed(worlds, hav, 0), own_steering(worlds, hav, 0)) for hav in havs]
        return np.array(pairs)

    def box(self, shape: tuple[int, ...]) -> spaces.Box:
        """Return the space of actions in physical units."""
        pairs = np.prod(shape, dtype=int) // 2
        low, high = np.tile(self.most * [0.0, -1.0], pairs), np.tile(self.most, pairs)
        return spaces.Box(low.reshape(shape), high.reshape(shape), dtype=np.float64)

    def normalize(self, name: str, action: Any, shape: tuple[int, ...], hav: int = 0) -> np.ndarray:
        """Return an action (..., 2) or (2 N,) from -1 to 1, for the HAVs from ``hav`` on.

        Raises:
            TypeError, ValueError: See ``read_action``, which has the same first three arguments.
        """
        action = read_action(name, action, shape)
        pairs = action.reshape(-1, 2)
        shares = pairs / self._limits()[hav : hav + len(pairs)]
        return (shares * [2.0, 1.0] - [1.0, 0.0]).reshape(action.shape)


class PhysicalActions(gym.ActionWrapper):
    """HAVSwarm-v0 or HAVSingle-v0 with speed [m/s] and steering [rad] as actions."""

    def __init__(self, env: gym.Env) -> None:
        """Wrap an environment, which may have other wrappers."""
        super().__init__(env)
        self._units = _Units(env.unwrapped)  # type: ignore[arg-type]
        assert isinstance(env.action_space, spaces.Box)
        self.action_space = self._units.box(env.action_space.shape)

    @property
    def actual(self) -> np.ndarray:
        """Return the executed speed [m/s] and steering [rad] of the last step, (N, 2)."""
        return self._units.actual()

    def action(self, action: Any) -> np.ndarray:
        """Return the action in the units of the environment."""
        assert self.action_space.shape is not None
        return self._units.normalize("the action", action, self.action_space.shape)


class PhysicalParallelActions(BaseParallelWrapper):
    """The PettingZoo environment with speed [m/s] and steering [rad] as actions."""

    def __init__(self, env: HAVSwarmParallelEnv) -> None:
        """Wrap an environment."""
        super().__init__(env)
        self._units = _Units(env)
        self._spaces = {agent: self._units.box((2,)) for agent in env.possible_agents}
        self._havs = {agent: hav for hav, agent in enumerate(env.possible_agents)}

    @property
    def actual(self) -> np.ndarray:
        """Return the executed speed [m/s] and steering [rad] of the last step, (N, 2)."""
        return self._units.actual()

    def action_space(self, agent: str) -> spaces.Box:
        """Return the space of an agent's actions."""
        return self._spaces[agent]

    def step(self, actions: dict[str, Any]) -> Any:
        """Take one action of every agent."""
        check_mapping(actions)
        normal = {
            agent: self._units.normalize(
                f"the action of {agent}", action, (2,), self._havs.get(agent, 0)
            )
            for agent, action in actions.items()
        }
        return super().step(normal)
