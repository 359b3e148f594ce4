"""This module has Gymnasium's vector environments: W compiled worlds, stepped together."""

import functools
import numbers
from collections.abc import Mapping
from typing import Any, Unpack

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from hav_env.envs.reset_options import check_left_out, warn_of_unknown
from hav_env.envs.screen import RENDER_FPS, Screen
from hav_env.envs.views import EgoView, JointView, Team
from hav_env.maths.random_numbers import SEED_LIMIT
from hav_env.mdp.actions import take_actions
from hav_env.mdp.buffers import Outcome
from hav_env.mdp.central_state import CentralState
from hav_env.mdp.decision_process import DecisionProcess, Settings
from hav_env.models.checks import check_value
from hav_env.models.quantities import Worlds
from hav_env.simulator.batch import check_seed

# a window can show only one world, so only single environments have that mode
_MODES = ["rgb_array", "ansi"]


class _WorldsVectorEnv(VectorEnv):
    """The common part of both environments."""

    metadata: dict[str, Any] = {"render_modes": _MODES, "render_fps": RENDER_FPS}  # noqa: RUF012

    def __init__(
        self,
        process: DecisionProcess,
        view: JointView | EgoView,
        autoreset_mode: AutoresetMode | str,
        render_mode: str | None,
    ) -> None:
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = {**type(self).metadata, "autoreset_mode": self.autoreset_mode}
        self._process, self._view = process, view
        self._screen = Screen(render_mode, process.batch, _MODES)
        self.render_mode = render_mode
        self.num_envs = process.num_worlds
        self.single_observation_space = view.observation_space
        self.single_action_space = view.action_space
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._shape = self.num_envs, *view.action_space.shape
        self._info_keys = *process.info, *(f"_{name}" for name in process.info)
        self._seeds: np.ndarray | None = None
        self._episodes = np.zeros(self.num_envs, np.int64)
        self._note_ends(np.zeros(self.num_envs, np.bool_))

    def reset(  # type: ignore[override]
        self,
        *,
        seed: int | list[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin episodes.

        Args:
            seed: Seed of world 0, from which the seeds of the other worlds follow; or a list with
                one seed for each world. A world begins with the first episode of its seed; with
                None it continues with the next episode. World w of seed s equals world w - 1 of
                seed s + 1. For different episodes in every run, use seeds that are ``num_envs``
                apart, or a list.
            options: "reset_mask", (W,) bool: the worlds to reset; the others continue. The first
                reset begins all worlds.

        Raises:
            ValueError, TypeError: If the seed or an option is invalid; the message names it.
        """
        chosen, seeds = self._chosen(options), self._read_seeds(seed)
        check_left_out("reset_mask", chosen, self._process.begun)
        super().reset(seed=int(seed) if isinstance(seed, numbers.Integral) else None)
        self._set_keys(seeds, chosen)
        outcome = self._process.outcome()
        self._begin(chosen, outcome)
        self._screen.forget(chosen)
        self._note_ends(self._over & ~chosen)
        if not chosen.all():
            self._process.observe_worlds(~chosen, outcome)
        info: dict[str, Any] = {}
        if self._process.always:
            outcome.info[:, :, ~chosen] = 0.0
            info = self._info(outcome.info, chosen)
        return self._view.observations(outcome.observation), info

    def step(
        self, actions: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Take one action in every world.

        Raises:
            TypeError: If the actions are not numbers.
            ValueError: If the shape is wrong or a number is not finite.
            RuntimeError: If ``reset`` has not been called, or the last one failed; with autoreset
                disabled, if a world whose episode has ended was not reset.
            PlacementError: If the next episode of a world cannot begin; call ``reset`` next.
        """
        actions = take_actions("the array of actions", actions, self._shape)
        mode, process = self.autoreset_mode, self._process
        if self._any_over and mode == AutoresetMode.DISABLED:
            ended = self._places.tolist()
            raise RuntimeError(f"reset the worlds {ended} first: their episodes have ended")
        outcome = process.step(actions.reshape(self.num_envs, -1, 2))
        if self._any_over and mode == AutoresetMode.NEXT_STEP:
            self._begin_next(outcome)
        observation, numbers, reward, terminated, truncated = outcome
        self._note_ends(terminated | truncated)
        info: dict[str, Any] = {}
        if self._any_over and mode == AutoresetMode.SAME_STEP:
            info = self._final(outcome)
            # rewards and ends belong to the episodes that have just ended
            apart = map(np.empty_like, (reward, terminated, truncated))
            self._begin_next(Outcome(observation, numbers, *apart))
        if process.always:
            everywhere = np.empty(self.num_envs, np.bool_)
            everywhere.fill(True)
            info |= self._info(numbers, everywhere)
        elif self._any_over and mode != AutoresetMode.SAME_STEP:
            info = self._info(self._of_ended(numbers), self._over.copy())
        rewards = self._view.rewards(reward)
        return self._view.observations(observation), rewards, terminated, truncated, info

    @property
    def columns(self) -> tuple[str, ...]:
        """Return the names of the observation columns of a HAV."""
        return self._process.columns

    def state(self) -> np.ndarray:
        """Return the states of all worlds (W, S) float32, for critics: see ``CentralState``.

        With same-step autoreset, a world whose episode has ended is in its next episode already.

        Raises:
            RuntimeError: If a world has no episode.
        """
        self._process.require_episodes("state")
        return self._central.read_worlds()

    @property
    def single_state_space(self) -> spaces.Box:
        """Return the space of the state of one world (S,)."""
        return self._central.space

    @functools.cached_property
    def _central(self) -> CentralState:
        """Return the reader of states, which is built at its first use."""
        return CentralState(self._process.batch)

    def render(self) -> tuple[Any, ...] | None:
        """Return the picture of each world: a frame (H, W, 3) or a line of text."""
        if self.render_mode is None:
            return None
        self._process.require_episodes("render")
        return tuple(self._screen.show(w) for w in range(self.num_envs))

    def close_extras(self, **kwargs: Any) -> None:
        """Close the viewers."""
        self._screen.close()

    def _chosen(self, options: dict[str, Any] | None) -> np.ndarray:
        options = {} if options is None else options
        if not isinstance(options, Mapping):
            raise TypeError(f"options is {options!r}, but must be a dict or None")
        warn_of_unknown(options, ("reset_mask",))
        if "reset_mask" not in options:
            return np.ones(self.num_envs, np.bool_)
        mask = options["reset_mask"]
        if not isinstance(mask, np.ndarray) or mask.dtype != np.bool_:
            raise TypeError(f"reset_mask is {mask!r}, but must be an array of bool")
        if mask.shape != (self.num_envs,):
            raise ValueError(f"reset_mask has shape {mask.shape}, but must have ({self.num_envs},)")
        if not mask.any():
            raise ValueError("reset_mask is all false, but must be true for at least one world")
        return mask.copy()

    def _read_seeds(self, seed: Any) -> list[int | None]:
        """Return the seed of each world, None where its next episode follows."""
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, list | tuple) or np.ndim(seed) > 0:
            seeds = list(seed)
            if len(seeds) != self.num_envs:
                raise ValueError(f"{len(seeds)} seeds were given for {self.num_envs} worlds")
            for own in seeds:
                if own is not None:
                    check_seed(own)
            return [None if own is None else int(own) for own in seeds]
        check_seed(seed)
        if int(seed) + self.num_envs > SEED_LIMIT:
            most = f"{SEED_LIMIT - self.num_envs}, for world w takes seed + w"
            raise ValueError(f"seed is {seed}, but must be at most {most}")
        return [int(seed) + w for w in range(self.num_envs)]

    def _set_keys(self, seeds: list[int | None], chosen: np.ndarray) -> None:
        """Set seed and number of the episodes that begin next."""
        fresh = self._seeds is None
        if self._seeds is None:
            self._seeds = self.np_random.integers(SEED_LIMIT, size=self.num_envs)
        for w in np.flatnonzero(chosen):
            own = seeds[w]
            self._episodes[w] = 0 if fresh or own is not None else self._episodes[w] + 1
            if own is not None:
                self._seeds[w] = own

    def _note_ends(self, over: np.ndarray) -> None:
        self._over, self._any_over = over, np.count_nonzero(over) > 0
        if self._any_over:
            self._places = np.flatnonzero(over)

    def _begin_next(self, outcome: Outcome) -> None:
        self._episodes[self._places] += 1
        self._begin(self._places, outcome)
        self._screen.forget(self._over)

    def _begin(self, chosen: np.ndarray, outcome: Outcome) -> None:
        assert self._seeds is not None
        self._process.begin(self._seeds, self._episodes, chosen, outcome)

    def _of_ended(self, numbers: np.ndarray) -> np.ndarray:
        """Return numbers (K, C, W) of worlds whose episodes have ended, zeros elsewhere."""
        found = np.zeros(numbers.shape[::-1])  # the numbers of a world are side by side
        found[self._places] = numbers[..., self._places].T
        return found.T

    def _info(self, numbers: np.ndarray, chosen: np.ndarray) -> dict[str, Any]:
        """Return all infos by name, with masks of the worlds that have them."""
        info = dict.fromkeys(self._info_keys, chosen)
        info.update(zip(self._process.info, self._view.numbers(numbers), strict=True))
        return info

    def _final(self, outcome: Outcome) -> dict[str, Any]:
        """Return the last observations and infos of the episodes that have ended."""
        over = self._over.copy()  # a copy: the caller owns all returned arrays
        observations = np.full(self.num_envs, None, object)
        for w in np.flatnonzero(over):
            observations[w] = self._view.observations(outcome.observation)[w].copy()
        numbers = self._of_ended(outcome.info)
        return {
            "final_obs": observations,
            "_final_obs": over,
            "final_info": self._info(numbers, over),
            "_final_info": over.copy(),
        }


class HAVSwarmVectorEnv(_WorldsVectorEnv):
    """W copies of ``HAVSwarmEnv`` with bit-equal results; info: arrays (W, N)."""

    def __init__(
        self,
        num_envs: int = 1,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        render_mode: str | None = None,
        team_reward: Team = "mean",
        flatten: bool = False,
        **settings: Unpack[Settings],
    ) -> None:
        """Build the environments.

        Args:
            num_envs: Number of worlds W.
            autoreset_mode: When a world begins its next episode after the end of one.
            render_mode: None, "rgb_array" or "ansi".
            team_reward: See ``HAVSwarmEnv``.
            flatten: See ``HAVSwarmEnv``.
            settings: See ``HAVSwarmEnv``.

        Raises:
            ValueError, TypeError: If an argument is invalid; the message names it, its value and
                the rule.
        """
        check_value("num_envs", Worlds, num_envs)
        process = DecisionProcess(num_envs, **settings)
        view = JointView(process, team_reward, flatten)
        super().__init__(process, view, autoreset_mode, render_mode)


class HAVSingleVectorEnv(_WorldsVectorEnv):
    """W copies of ``HAVSingleEnv`` with bit-equal results; info: arrays (W,)."""

    def __init__(
        self,
        num_envs: int = 1,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        render_mode: str | None = None,
        others: Any = None,
        **settings: Unpack[Settings],
    ) -> None:
        """Build the environments; arguments as in ``HAVSwarmVectorEnv`` and ``HAVSingleEnv``."""
        settings.setdefault("scenario", "paper-single")
        check_value("num_envs", Worlds, num_envs)
        process = DecisionProcess(num_envs, 1, others, **settings)
        super().__init__(process, EgoView(process), autoreset_mode, render_mode)
