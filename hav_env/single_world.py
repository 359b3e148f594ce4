"""One world for environments that step one: its episodes, what may be written into it, pictures."""

import math
import numbers
from typing import Any

import numpy as np

from hav_env.advance import Outcome
from hav_env.batch import check_seed
from hav_env.decision_process import DecisionProcess, check_finite, warn_of_unknown
from hav_env.randomness import SEED_LIMIT
from hav_env.scenarios import explicit
from hav_env.screen import Screen
from hav_env.transition import begin
from hav_env.world import ARTICULATION, SPEED, STEERING

_HERE = np.ones(1, np.bool_)
_WRITTEN = ("lengths", "start", "goals")  # options that are written into a world


class SingleWorld:
    """A decision process of one world.

    The first episode of seed s is number 0 of that seed, the next one number 1, and so on: the
    pair (s, k) names the same episode as in a rollout.
    """

    def __init__(
        self,
        render_mode: str | None,
        controlled: int | None = None,
        others: Any = None,
        /,
        **arguments: Any,
    ) -> None:
        """Build the world.

        Args:
            render_mode: how the screen shows it.
            controlled, others, arguments: as of ``DecisionProcess``.

        Raises:
            ValueError, TypeError: naming the argument, its value and what is allowed.
        """
        self.process = DecisionProcess(1, controlled, others, **arguments)
        self.screen = Screen(render_mode, self.process.batch)
        self._key: tuple[int, int] | None = None

    def reset(
        self, seed: int | None, options: dict | None, generator: np.random.Generator
    ) -> Outcome:
        """Begin an episode.

        Args:
            seed: begins with the first episode of this seed; None goes on to the next one.
            options: "episode": its number. "lengths", "start", "goals": as for ``explicit``, what
                is to be instead of what the scenario drew. Others are ignored, with a warning.
            generator: draws the seed when none was ever given.

        Raises:
            ValueError: naming what is wrong with seed or options.
        """
        options = {name: value for name, value in (options or {}).items() if value is not None}
        warn_of_unknown(options, ("episode", *_WRITTEN))
        key = self._next_key(seed, options.get("episode"), generator)
        self._key = None  # until the episode has begun
        told = self.process.outcome()
        keys = np.array([key], np.int64).T
        self.process.begin(keys[0], keys[1], _HERE)
        written = {name: options[name] for name in _WRITTEN if name in options}
        if written:
            self._write(written, key)
        self.process.look(_HERE, told)
        self._key = key
        self.screen.forget(_HERE)
        return told

    def step(self, actions: np.ndarray) -> Outcome:
        """Take an action (1, C, 2).

        Raises:
            RuntimeError: before the first ``reset``; ValueError: when a number is not finite.
        """
        if self._key is None:
            raise RuntimeError("call reset before step: there is no episode yet")
        # of a few numbers, a list is looked at in half the time
        if not all(map(math.isfinite, actions.ravel().tolist())):
            check_finite(actions)
        return self.process.step(actions)

    def _next_key(
        self, seed: int | None, episode: int | None, generator: np.random.Generator
    ) -> tuple[int, int]:
        if seed is not None:
            check_seed(seed)
            key = int(seed), 0
        elif self._key is None:
            key = int(generator.integers(SEED_LIMIT)), 0
        else:
            key = self._key[0], self._key[1] + 1
        if episode is None:
            return key
        if not isinstance(episode, numbers.Integral) or not 0 <= episode < SEED_LIMIT:
            raise ValueError(f"episode is {episode!r}, but must be from 0 to {SEED_LIMIT - 1}")
        return key[0], int(episode)

    def _write(self, written: dict[str, Any], key: tuple[int, int]) -> None:
        """Begin the episode anew with other lengths, start poses or goals."""
        batch, scenario = self.process.batch, self.process.batch.scenario
        state, fleet, goals = batch.worlds.state, batch.worlds.fleet, batch.worlds.goals
        drawn = {
            "lengths": [
                fleet.length[agent, : fleet.num_trailers[agent, 0] + 1, 0].tolist()
                for agent in range(scenario.num_havs)
            ],
            "start": np.stack([state.x[:, 0], state.y[:, 0], state.heading[:, 0, 0]], axis=-1),
            "goals": goals[..., 0],
        }
        limit = fleet.limit[0, :, 0]
        found = explicit(
            **drawn | written,
            speed_max=limit[SPEED],
            steering_max=limit[STEERING],
            articulation_max=limit[ARTICULATION],
            footprint_truck_share=getattr(scenario, "fleet", scenario).footprint_truck_share,
        )
        for field, name in (("num_havs", "HAVs"), ("num_goals", "goals of each HAV")):
            if getattr(found, field) != getattr(scenario, field):
                least = getattr(scenario, field)
                raise ValueError(f"reset got {getattr(found, field)} {name}, but needs {least}")
        if found.max_trailers > scenario.max_trailers:
            raise ValueError(
                f"reset got a HAV with {found.max_trailers} trailers, but this environment has"
                f" room for {scenario.max_trailers}"
            )
        begin(found, batch.task, batch.worlds, 0, *key)


class OfOneWorld:
    """What environments of one world have in common, whatever their interface."""

    _world: SingleWorld

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns of the observation of a HAV."""
        return self._world.process.columns

    @property
    def scenario(self) -> Any:
        """Who starts where and must go where."""
        return self._world.process.batch.scenario

    def render(self) -> Any:
        """Return what is seen: an array (H, W, 3), a line of text, or nothing (a window)."""
        return self._world.screen.show()

    def close(self) -> None:
        """Close the window, if there is one."""
        self._world.screen.close()

    def _show(self) -> None:
        if self._world.screen.render_mode == "human":
            self._world.screen.show()
