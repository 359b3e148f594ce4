"""This module has the vector environment for Stable-Baselines3, in which HAVs share a policy.

Every HAV of every world is a row.
"""

import functools
import numbers
from collections.abc import Iterable, Sequence
from typing import Any, Unpack

import numpy as np

from hav_env.envs.screen import RENDER_FPS, Screen
from hav_env.envs.views import action_box, observation_box
from hav_env.maths.random_numbers import SEED_LIMIT
from hav_env.mdp.actions import read_action
from hav_env.mdp.buffers import Outcome
from hav_env.mdp.central_state import CentralState
from hav_env.mdp.decision_process import DecisionProcess, Settings
from hav_env.simulator.batch import check_seed

try:
    from stable_baselines3.common.vec_env import VecEnv
except ImportError as error:
    message = (
        "hav_env.envs.stable_baselines3 needs stable-baselines3:"
        " run pip install -e '.[training]' in the clone"
    )
    raise ImportError(message) from error


class HAVVecEnv(VecEnv):
    """W worlds of N HAVs as W x N environments; row w N + k is HAV k of world w.

    The rows of a world end together and begin the next episode in the same step. The info of a row
    is filled only at the end of an episode. It then holds the numbers of ``hav_env.mdp.info``, the
    returns by term, ``terminal_observation`` and ``TimeLimit.truncated``. A time-out is not a
    failure: learners bootstrap from the value of the last observation. The setting ``info``
    therefore has no effect here.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": RENDER_FPS}  # noqa: RUF012

    def __init__(
        self,
        num_worlds: int = 1,
        render_mode: str | None = None,
        **settings: Unpack[Settings],
    ) -> None:
        """Build the worlds.

        Args:
            num_worlds: Number of worlds W.
            render_mode: None or "rgb_array".
            settings: See ``hav_env.mdp.decision_process.DecisionProcess``: scenario, num_havs,
                task, its rules, vehicle, observation, reward, frame_skip.

        Raises:
            ValueError, TypeError: If an argument is invalid; the message names it, its value and
                the rule.
        """
        self.process = DecisionProcess(num_worlds, **settings)
        self.process.report(always=False)
        self.screen = Screen(render_mode, self.process.batch, ["rgb_array"])
        self.render_mode = render_mode
        self._keys = np.zeros((2, num_worlds), np.int64)  # seed and number of the episodes
        self._keyed = False
        self._actions = np.zeros((num_worlds, self.process.num_havs, 2))
        rows = num_worlds * self.process.num_havs
        super().__init__(rows, observation_box(self.process), action_box())

    def reset(self) -> np.ndarray:
        """Begin an episode in every world; return the observations (rows, D).

        After ``seed``, each world starts with the first episode of its seed, otherwise with the
        next one.

        Raises:
            PlacementError: If a world cannot place its HAVs; call ``reset`` again.
        """
        worlds = self.process.num_worlds
        seeds = self._seeds[:: self.process.num_havs]
        if seeds[0] is not None:
            self._keys[0], self._keys[1] = np.array(seeds), 0
        elif self._keyed:
            self._keys[1] += 1
        else:
            self._keys[0] = np.random.default_rng().integers(SEED_LIMIT, size=worlds)
        self._keyed = True
        self._reset_seeds()
        outcome = self.process.outcome()
        self._begin(np.ones(self.process.num_worlds, np.bool_), outcome)
        self.reset_infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        return outcome.observation.reshape(self.num_envs, -1)

    def step_async(self, actions: np.ndarray) -> None:
        """Store the actions (rows, 2)."""
        checked = read_action("the array of actions", actions, (self.num_envs, 2))
        self._actions = checked.reshape(self._actions.shape)

    def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Take the actions; return observations, rewards, ends and infos of all rows."""
        outcome = self.process.step(self._actions)
        rewards = outcome.reward.T.astype(np.float32).reshape(-1)
        ended = outcome.terminated | outcome.truncated
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        if ended.any():
            for w in np.flatnonzero(ended).tolist():
                self._sum_up(outcome, w, infos)
            self._keys[1, ended] += 1
            self._begin(ended, outcome)
        dones = np.repeat(ended, self.process.num_havs)
        return outcome.observation.reshape(self.num_envs, -1), rewards, dones, infos

    def _sum_up(self, outcome: Outcome, w: int, infos: list[dict[str, Any]]) -> None:
        """Write the infos of the episode that ended in a world."""
        rows = outcome.info[:, :, w].T.tolist()
        for agent, row in enumerate(rows):
            info: dict[str, Any] = dict(zip(self.process.info, row, strict=True))
            info["TimeLimit.truncated"] = bool(outcome.truncated[w])
            info["terminal_observation"] = outcome.observation[w, agent].copy()
            infos[w * self.process.num_havs + agent] = info

    def _begin(self, chosen: np.ndarray, outcome: Outcome) -> None:
        self.process.begin(self._keys[0], self._keys[1], chosen, outcome)
        self.screen.forget(chosen)

    def state(self) -> np.ndarray:
        """Return the states of all worlds (W, S) float32, for critics: see ``CentralState``.

        A world whose episode has ended is in its next episode already.

        Raises:
            RuntimeError: If a world has no episode.
        """
        self.process.require_episodes("state")
        return self._central.read_worlds()

    @functools.cached_property
    def _central(self) -> CentralState:
        """Return the reader of states, which is built at its first use."""
        return CentralState(self.process.batch)

    def arrays(self) -> dict[str, np.ndarray]:
        """Return all arrays that change from step to step, by name.

        An environment with the same arguments that is reset and then filled with them continues bit
        for bit.
        """
        return self.process.arrays() | {"keys": self._keys}

    def close(self) -> None:
        """Close the viewers."""
        self.screen.close()

    def get_images(self) -> Sequence[np.ndarray | None]:
        """Return a frame (H, W, 3) of every world."""
        self.process.require_episodes("render")
        return [self.screen.show(w) for w in range(self.process.num_worlds)]  # type: ignore[misc]

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """Make world w begin with the first episode of seed ``seed + w N`` at the next ``reset``.

        World w of a run equals world w - 1 of a run whose seed is N larger. For different episodes
        in every run, use seeds that are ``num_envs`` apart.

        Args:
            seed: From 0 to 2**32 - ``num_envs``; None draws one.

        Raises:
            ValueError, TypeError: If the seed is invalid, or the seed of the last row is too large.
        """
        if seed is None:
            seed = int(np.random.default_rng().integers(SEED_LIMIT - self.num_envs))
        check_seed(seed)
        if int(seed) + self.num_envs > SEED_LIMIT:
            most = f"{SEED_LIMIT - self.num_envs}, for row k takes seed + k"
            raise ValueError(f"seed is {seed}, but must be at most {most}")
        self._seeds = [int(seed) + row for row in range(self.num_envs)]
        return self._seeds

    def set_options(self, options: Any = None) -> None:
        """Raise an error for any option: a reset of these worlds has none.

        Raises:
            ValueError: If there are options.
        """
        given = options if isinstance(options, list) else [options]
        if any(given):
            raise ValueError(f"options is {options!r}, but must be empty: reset takes none here")

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute, the same for all rows."""
        return [getattr(self, attr_name) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set an attribute of all rows.

        Raises:
            ValueError: If ``indices`` leaves rows out.
        """
        self._require_all(indices)
        setattr(self, attr_name, value)

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list:
        """Call a method once, for all rows, and return its result for each of them.

        Raises:
            ValueError: If ``indices`` leaves rows out.
        """
        self._require_all(indices)
        result = getattr(self, method_name)(*args, **kwargs)
        return [result for _ in range(self.num_envs)]

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """Return False for all rows: no row is wrapped."""
        return [False for _ in self._get_indices(indices)]

    def _require_all(self, indices: Any) -> None:
        if set(self._get_indices(indices)) != set(range(self.num_envs)):
            raise ValueError(
                f"indices is {indices!r}, but must be None: all rows share what is set or called"
            )

    def _get_indices(self, indices: Any) -> list[int]:
        """Return the selected rows; raise ValueError or TypeError for invalid indices."""
        if indices is None:
            return list(range(self.num_envs))
        rows = list(indices) if isinstance(indices, Iterable) else [indices]
        for row in rows:
            if not isinstance(row, numbers.Integral) or isinstance(row, bool):
                raise TypeError(f"indices is {indices!r}, but must be whole numbers")
            if not -self.num_envs <= int(row) < self.num_envs:
                raise ValueError(f"indices is {indices!r}, but there are {self.num_envs} rows")
        return [int(row) % self.num_envs for row in rows]
