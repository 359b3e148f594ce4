"""This module has Gymnasium's environments HAVSwarm-v0 and HAVSingle-v0.

HAVSwarm-v0 controls all HAVs of a world jointly. HAVSingle-v0 controls one HAV.
"""

from typing import Any, Unpack

import gymnasium as gym
import numpy as np

from hav_env.envs.screen import ENV_RENDER_MODES, RENDER_FPS
from hav_env.envs.single_world import OfOneWorld, SingleWorld
from hav_env.envs.views import EgoView, JointView, Team
from hav_env.mdp.actions import list_action
from hav_env.mdp.decision_process import Settings


class _WorldEnv(OfOneWorld, gym.Env):
    """The common part of both environments."""

    metadata: dict[str, Any] = {"render_modes": ENV_RENDER_MODES, "render_fps": RENDER_FPS}  # noqa: RUF012

    def __init__(self, world: SingleWorld, view: JointView | EgoView) -> None:
        self._world, self._view = world, view
        self.render_mode = world.screen.render_mode
        self.observation_space, self.action_space = view.observation_space, view.action_space
        self._shape = self.action_space.shape
        self._over = self._warned = False

    def reset(
        self, *, seed: int | None = None, options: dict | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin an episode; an invalid reset raises an error and changes nothing.

        Args:
            seed: Start with the first episode of this seed; None continues with the next episode.
            options: See ``SingleWorld.plan``.

        Raises:
            ValueError, TypeError: If the seed or an option is invalid; the message names it.
        """
        plan = self._world.plan(seed, options, self.np_random)
        super().reset(seed=None if seed is None else int(seed))
        self._world.begin(plan)
        self._over = self._warned = False
        self._show()
        info = self._info() if self._world.process.always else {}
        return self._view.observation(self._world.sight.observation), info

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Take an action. After the end of an episode the simulation continues, with one warning.

        Raises:
            TypeError: If the action does not consist of real numbers.
            ValueError: If its shape is wrong or a number is not finite.
            RuntimeError: If ``reset`` has not been called.
        """
        numbers = list_action("the action", action, self._shape)
        if self._over and not self._warned:
            self._warned = True
            gym.logger.warn("the episode has ended: call reset before step", stacklevel=2)
        world, view = self._world, self._view
        world.step(numbers)
        seen = world.sight
        terminated, truncated = seen.terminated.item(), seen.truncated.item()
        self._over = terminated or truncated
        self._show()
        return (
            view.observation(seen.observation),
            view.reward(seen.reward.tolist()),
            terminated,
            truncated,
            self._info() if self._over or world.process.always else {},
        )

    def _info(self) -> dict[str, Any]:
        raise NotImplementedError


class HAVSwarmEnv(_WorldEnv):
    """All HAVs of a world under joint control, the paper's pair by default.

    Observation (N, D), columns as in docs/environments.md. Action (N, 2): speed from 0 to maximum
    and steering from right to left, each from -1 to 1. Reward: one number. Info: arrays (N,). For
    agents that learn independently, use ``hav_env.parallel_env`` or
    ``hav_env.envs.stable_baselines3``.
    """

    def __init__(
        self,
        render_mode: str | None = None,
        team_reward: Team = "mean",
        flatten: bool = False,
        **settings: Unpack[Settings],
    ) -> None:
        """Build the environment.

        Args:
            render_mode: None, "human", "rgb_array" or "ansi".
            team_reward: How to combine the rewards of the HAVs: "mean", "sum" or "min".
            flatten: Flatten the spaces to (N * D,) and (N * 2,).
            settings: See ``hav_env.mdp.decision_process.DecisionProcess``: scenario, num_havs,
                task, its rules, vehicle, observation, reward, frame_skip, info.

        Raises:
            ValueError, TypeError: If an argument is invalid; the message names it, its value and
                the rule.
        """
        world = SingleWorld(render_mode, **settings)
        super().__init__(world, JointView(world.process, team_reward, flatten))

    def _info(self) -> dict[str, Any]:
        return self._world.name_numbers(self._world.sight.info.copy())


class HAVSingleEnv(_WorldEnv):
    """One controlled HAV, by default without others: the paper's single-HAV task.

    Observation (D,), action (2,); columns and units as in ``HAVSwarmEnv``. Info: scalars. With
    other HAVs (``num_havs``), the episode ends when the controlled HAV has hit its last goal; the
    rule ``next_goal`` decides when goals change.
    """

    def __init__(
        self,
        render_mode: str | None = None,
        others: Any = None,
        **settings: Unpack[Settings],
    ) -> None:
        """Build the environment.

        Args:
            render_mode: None, "human", "rgb_array" or "ansi".
            others: Policy of the other HAVs: its name ("avoid_jack") or an object; without one they
                do not move.
            settings: See ``hav_env.mdp.decision_process.DecisionProcess``.

        Raises:
            ValueError, TypeError: If an argument is invalid; the message names it, its value and
                the rule.
        """
        settings.setdefault("scenario", "paper-single")
        world = SingleWorld(render_mode, 1, others, **settings)
        super().__init__(world, EgoView(world.process))

    def _info(self) -> dict[str, Any]:
        return self._world.infos()[0]
