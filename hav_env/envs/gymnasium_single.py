"""This module has Gymnasium's environments HAVSwarm-v0 and HAVSingle-v0.

In HAVSwarm-v0 all HAVs are one actor. In HAVSingle-v0 there is one HAV.
"""

from typing import Any, Unpack

import gymnasium as gym
import numpy as np

from hav_env.envs.screen import ENV_RENDER_MODES, RENDER_FPS
from hav_env.envs.single_world import OfOneWorld, Sight, SingleWorld
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
        """Begin an episode; a reset that is refused changes nothing.

        Args:
            seed: begins with the first episode of this seed; None goes on to the next one.
            options: as for ``SingleWorld.plan``.

        Raises:
            ValueError, TypeError: naming what is wrong with seed or options.
        """
        plan = self._world.plan(seed, options, self.np_random)
        super().reset(seed=None if seed is None else int(seed))
        seen = self._world.begin(plan)
        self._over = self._warned = False
        self._show()
        info = self._info(seen) if self._world.process.always else {}
        return self._view.observation(seen.observation), info

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Take an action. After the end of an episode the world goes on, with one warning.

        Raises:
            TypeError: when the action is anything but real numbers.
            ValueError: when its shape is wrong or a number is not finite.
            RuntimeError: before the first ``reset``.
        """
        numbers = list_action("the action", action, self._shape)
        if self._over and not self._warned:
            self._warned = True
            gym.logger.warn("the episode has ended: call reset before step", stacklevel=2)
        world, view = self._world, self._view
        seen = world.step(numbers)
        terminated, truncated = seen.terminated.item(), seen.truncated.item()
        self._over = terminated or truncated
        self._show()
        return (
            view.observation(seen.observation),
            view.reward(seen.reward.tolist()),
            terminated,
            truncated,
            self._info(seen) if self._over or world.process.always else {},
        )

    def _info(self, seen: Sight) -> dict[str, Any]:
        raise NotImplementedError


class HAVSwarmEnv(_WorldEnv):
    """All HAVs of a world under joint control, the paper's pair by default.

    Observation (N, D), columns as in docs/environments.md; action (N, 2): speed from 0 to maximum
    and steering from right to left, each from -1 to 1; reward: one number. Info: arrays (N,). For
    agents that learn one by one: ``hav_env.parallel_env`` and ``hav_env.envs.stable_baselines3``.
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
            team_reward: how the HAVs' rewards become one: "mean", "sum" or "min".
            flatten: spaces with one axis, (N * D,) and (N * 2,).
            settings: as of ``hav_env.mdp.decision_process.DecisionProcess``: scenario, num_havs,
                task, its rules, vehicle, observation, reward, frame_skip, info.

        Raises:
            ValueError, TypeError: naming the argument, its value and what is allowed.
        """
        world = SingleWorld(render_mode, **settings)
        super().__init__(world, JointView(world.process, team_reward, flatten))

    def _info(self, seen: Sight) -> dict[str, Any]:
        return self._world.name_numbers(seen.info.copy())


class HAVSingleEnv(_WorldEnv):
    """One HAV, alone by default: the paper's single-HAV task.

    Observation (D,), action (2,), columns and units as of ``HAVSwarmEnv``. Info: numbers. Among
    others (``num_havs``), the episode ends when this HAV has hit its last goal; goals change by
    the rule ``next_goal``.
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
            others: the policy that drives the other HAVs: its name ("avoid_jack") or an object;
                without one they stand.
            settings: as of ``hav_env.mdp.decision_process.DecisionProcess``.

        Raises:
            ValueError, TypeError: naming the argument, its value and what is allowed.
        """
        settings.setdefault("scenario", "paper-single")
        world = SingleWorld(render_mode, 1, others, **settings)
        super().__init__(world, EgoView(world.process))

    def _info(self, seen: Sight) -> dict[str, Any]:
        return self._world.name_numbers(*seen.rows.tolist())
