"""This module steps one world for environments: its resets, their options, its pictures."""

import copy
import struct
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from hav_env.envs.reset_options import read_episode, read_options, warn_of_unknown
from hav_env.envs.screen import Screen
from hav_env.maths.random_numbers import SEED_LIMIT
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.scenarios import Explicit, explicit
from hav_env.scenarios.clearance import site_in
from hav_env.scenarios.given_vehicles import bends_in, vehicle_in
from hav_env.simulator.batch import begin_worlds, check_parts, check_placed, check_seed
from hav_env.simulator.beginning import begin
from hav_env.world.arrays import ARTICULATION, SEED, SPEED, STEERING

_HERE = np.ones(1, np.bool_)
_WRITABLE = ("lengths", "start", "goals", "bends")  # options that are written into a world


class Plan(NamedTuple):
    """An episode that may begin: everything about it has been checked."""

    key: tuple[int, int]
    """Seed and number."""
    written: Explicit | None
    """The scenario to begin, in place of a drawn one."""


class Sight(NamedTuple):
    """An outcome of one world; the next step or reset writes into the same arrays."""

    observation: np.ndarray  # (C, D) float32
    info: np.ndarray  # (K, C)
    rows: np.ndarray  # (C, K) the same
    reward: np.ndarray  # (C,)
    terminated: np.ndarray  # (1,) bool
    truncated: np.ndarray  # (1,) bool


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
            controlled: as of ``DecisionProcess``.
            others: as of ``DecisionProcess``.
            **arguments: as of ``DecisionProcess``.

        Raises:
            ValueError, TypeError: naming the argument, its value and what is allowed.
        """
        self.process = DecisionProcess(1, controlled, others, **arguments)
        self.screen = Screen(render_mode, self.process.batch, command=self.process.command)
        self._key: tuple[int, int] | None = None  # of the last episode
        self._blank: dict[str, Any] = dict.fromkeys(self.process.info)
        self._allocate()

    def _allocate(self) -> None:
        """Make the arrays of all steps: to make them anew takes as long as to copy from them."""
        self._outcome = outcome = self.process.outcome()
        self._actions = np.zeros((1, self.process.num_controlled, 2))
        self._write_actions = struct.Struct(f"{self._actions.size}d").pack_into
        info = outcome.info[..., 0]
        self._sight = Sight(
            *(outcome.observation[0], info, info.T, outcome.reward[:, 0]),
            *(outcome.terminated, outcome.truncated),
        )

    def __getstate__(self) -> dict[str, Any]:
        """Leave out views, for in a copy they would be arrays by themselves."""
        own = ("_outcome", "_actions", "_write_actions", "_sight")
        return {name: value for name, value in self.__dict__.items() if name not in own}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Make them anew."""
        self.__dict__ |= state
        self._allocate()

    def plan(
        self, seed: int | None, options: Mapping[str, Any] | None, generator: np.random.Generator
    ) -> Plan:
        """Check what a reset was given and return which episode it asks for; nothing changes.

        Args:
            seed: asks for the first episode of this seed; None for the one after the last.
            options: "episode": its number. "lengths", "start", "goals": as for ``explicit``, what
                is to be instead of what the scenario draws. Others are ignored, with a warning.
            generator: draws the seed when none was ever given.

        Raises:
            ValueError, TypeError: naming what is wrong with seed or options.
            PlacementError: when the scenario has no room for HAVs of which only a part is written.
        """
        if seed is not None:
            check_seed(seed)
        given = read_options(options)
        warn_of_unknown(given, ("episode", *_WRITABLE))
        if seed is not None:
            key = int(seed), 0
        else:
            if self._key is None:  # a refused reset does not draw again: the next one has this seed
                self._key = int(generator.integers(SEED_LIMIT)), -1
            key = self._key[0], self._key[1] + 1
        if "episode" in given:
            key = key[0], read_episode(given["episode"])
        written = {name: given[name] for name in _WRITABLE if name in given}
        return Plan(key, self._write(written, key) if written else None)

    def begin(self, plan: Plan) -> Sight:
        """Begin an episode.

        Raises:
            PlacementError: when the scenario has no room; the next reset takes the next number.
        """
        self._key = plan.key
        keys = np.array([plan.key], np.int64).T
        self.process.begin(keys[0], keys[1], _HERE, self._outcome)
        if plan.written is not None:
            batch = self.process.batch
            batch.worlds.state.clock[SEED:, 0] = plan.key
            begin(plan.written, batch.task, batch.worlds, np.empty(1, np.bool_))
            self.process.observe_worlds(_HERE, self._outcome)
        self.screen.forget(_HERE)
        return self._sight

    def step(self, actions: list[float]) -> Sight:
        """Take the actions of all HAVs, one after the other; finite.

        Raises:
            RuntimeError: before the first episode has begun.
        """
        self._write_actions(self._actions.data, 0, *actions)
        self.process.step(self._actions, self._outcome)
        return self._sight

    def name_numbers(self, numbers: Iterable) -> dict[str, Any]:
        """Return what is reported by name; to fill a copy takes less time than to build anew."""
        named = self._blank.copy()
        # a strict zip takes longer: a tenth of the step, in all places without it
        named.update(zip(self.process.info, numbers))  # noqa: B905
        return named

    def require_episode(self, what: str) -> None:
        """Raise RuntimeError, naming what the user called, unless an episode has begun."""
        self.process.require_episodes(what)

    def _write(self, written: dict[str, Any], key: tuple[int, int]) -> Explicit:
        """Return what an episode is with other lengths, start poses or goals."""
        batch, scenario = self.process.batch, self.process.batch.scenario
        # the episode is drawn beside the world, which stays as it is until all has been checked
        worlds, placed = copy.deepcopy(batch.worlds), np.zeros(1, np.bool_)
        worlds.state.clock[SEED:, 0] = key
        begin_worlds(1, scenario, batch.task, worlds, placed, threads=1)
        check_placed(placed, scenario)
        state, fleet, goals = worlds.state, worlds.fleet, worlds.goals
        drawn = {
            "lengths": [vehicle_in(fleet, agent, 0) for agent in range(scenario.num_havs)],
            "start": np.stack([state.x[:, 0], state.y[:, 0], state.heading[:, 0, 0]], axis=-1),
            "goals": goals[..., 0],
            "bends": None if "lengths" in written else bends_in(worlds, 0),
        }
        limit = fleet.limit[0, :, 0]
        found = explicit(
            **drawn | written,
            speed_max=limit[SPEED],
            steering_max=limit[STEERING],
            articulation_max=limit[ARTICULATION],
            footprint_truck_share=scenario.fleet.footprint_truck_share,
            site=site_in(scenario, worlds.place, 0),
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
        check_parts(found, batch.task, batch.vehicle)
        return found


class OfOneWorld:
    """The common part of environments of one world, whatever their interface."""

    _world: SingleWorld

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns of the observation of a HAV."""
        return self._world.process.columns

    @property
    def scenario(self) -> Any:
        """The scenario of the world: fleets, start poses and goal poses."""
        return self._world.process.batch.scenario

    def render(self) -> Any:
        """Return what is seen: an array (H, W, 3), a line of text, or nothing (a window).

        Raises:
            RuntimeError: before the first ``reset``.
            OSError: when there is no display for a window.
        """
        self._world.require_episode("render")
        return self._world.screen.show()

    def close(self) -> None:
        """Close the window, if there is one."""
        self._world.screen.close()

    def _show(self) -> None:
        if self._world.screen.render_mode == "human":
            self._world.screen.show()
