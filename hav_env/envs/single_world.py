"""This module steps one world for environments: resets, their options, rendering."""

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from hav_env.envs.reset_options import read_episode, read_options, warn_of_unknown
from hav_env.envs.screen import Screen
from hav_env.maths.random_numbers import SEED_LIMIT
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.mdp.one_world import OneWorld
from hav_env.scenarios import Explicit, explicit
from hav_env.scenarios.clearance import site_in
from hav_env.scenarios.given_vehicles import bends_in, vehicle_in
from hav_env.simulator.batch import (
    begin_worlds,
    check_parts,
    check_placed,
    check_seed,
    worlds_for,
)
from hav_env.simulator.beginning import begin
from hav_env.simulator.single_precision import check_near_origin
from hav_env.world.arrays import ARTICULATION, SEED, SPEED, STEERING

_HERE = np.ones(1, np.bool_)
_WRITABLE = ("lengths", "start", "goals", "bends")  # options that set parts of a world


class Plan(NamedTuple):
    """An episode that is ready to begin: all its settings have been checked."""

    key: tuple[int, int]
    """Seed and number."""
    written: Explicit | None
    """Explicit scenario that replaces the drawn one."""


class Sight(NamedTuple):
    """Outcome of one world; the next step or reset overwrites the same arrays."""

    observation: np.ndarray  # (C, D) float32
    info: np.ndarray  # (K, C)
    reward: np.ndarray  # (C,)
    terminated: np.ndarray  # (1,) bool
    truncated: np.ndarray  # (1,) bool


class SingleWorld:
    """A decision process of one world.

    Episode k of seed s, counted from 0, is the same episode as in a rollout.

    Attributes:
        process: The decision process.
        screen: Its pictures.
        step: Takes the actions of all HAVs: see ``OneWorld.step``.
        infos: Returns the infos of each HAV by name: see ``OneWorld.infos``.
        sight: The outcome, which ``step`` and ``begin`` overwrite.
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
            render_mode: Render mode of the screen.
            controlled: See ``DecisionProcess``.
            others: See ``DecisionProcess``.
            **arguments: See ``DecisionProcess``.

        Raises:
            ValueError, TypeError: If an argument is invalid; the message names it, its value and
                the rule.
        """
        self.process = DecisionProcess(1, controlled, others, **arguments)
        self.screen = Screen(render_mode, self.process.batch, command=self.process.command)
        self._key: tuple[int, int] | None = None  # of the last episode
        self._blank: dict[str, Any] = dict.fromkeys(self.process.info)
        self._allocate()

    def _allocate(self) -> None:
        """Make the arrays of all steps once: creating them takes as long as copying from them."""
        self._one = one = OneWorld(self.process)
        self.step, self.infos, outcome = one.step, one.infos, one.outcome
        self.sight = Sight(
            *(outcome.observation[0], outcome.info[..., 0], outcome.reward[:, 0]),
            *(outcome.terminated, outcome.truncated),
        )

    def __getstate__(self) -> dict[str, Any]:
        """Leave out views: a copy would turn them into independent arrays."""
        own = "_one", "step", "infos", "sight"
        return {name: value for name, value in self.__dict__.items() if name not in own}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Create the views again."""
        self.__dict__ |= state
        self._allocate()

    def plan(
        self, seed: int | None, options: Mapping[str, Any] | None, generator: np.random.Generator
    ) -> Plan:
        """Check the arguments of a reset and return the episode that they select; nothing changes.

        Args:
            seed: Select the first episode of this seed; None selects the one after the last.
            options: "episode": number of the episode. "lengths", "start", "goals", "bends": values
                that replace those of the scenario, as for ``explicit``. Others are ignored, with a
                warning.
            generator: Draws the seed if the user never passed one.

        Raises:
            ValueError, TypeError: If the seed or an option is invalid; the message names it. Also
                if the last episode was the last one of its seed, and there is no new seed.
            PlacementError: If the scenario cannot place the HAVs that the options do not place.
        """
        if seed is not None:
            check_seed(seed)
        given = read_options(options)
        warn_of_unknown(given, ("episode", *_WRITABLE))
        if seed is not None:
            key = int(seed), 0
        else:
            # an invalid reset does not draw again: the next reset uses this seed
            if self._key is None:
                self._key = int(generator.integers(SEED_LIMIT)), -1
            key = self._key[0], self._key[1] + 1
            if key[1] == SEED_LIMIT and "episode" not in given:
                raise ValueError(
                    f"reset needs a seed: the last episode of seed {key[0]} was {SEED_LIMIT - 1}"
                )
        if "episode" in given:
            key = key[0], read_episode(given["episode"])
        written = {name: given[name] for name in _WRITABLE if name in given}
        return Plan(key, self._write(written, key) if written else None)

    def begin(self, plan: Plan) -> None:
        """Begin an episode.

        Raises:
            PlacementError: If the scenario cannot place the HAVs; the next reset takes the next
                number.
        """
        self._key = plan.key
        keys = np.array([plan.key], np.int64).T
        outcome = self._one.outcome
        self.process.begin(keys[0], keys[1], _HERE, outcome)
        if plan.written is not None:
            batch = self.process.batch
            batch.worlds.state.clock[SEED:, 0] = plan.key
            begin(plan.written, batch.task, batch.worlds, np.empty(1, np.bool_))
            self.process.observe_worlds(_HERE, outcome)
        self._one.begin()
        self.screen.forget(_HERE)

    def name_numbers(self, numbers: Iterable) -> dict[str, Any]:
        """Return the infos by name; filling a copy is faster than building a new dictionary."""
        named = self._blank.copy()
        # a strict zip is slower: with it, a step would take about a tenth longer
        named.update(zip(self.process.info, numbers))  # noqa: B905
        return named

    def require_episode(self, what: str) -> None:
        """Raise RuntimeError, naming what the user called, unless an episode has begun."""
        self.process.require_episodes(what)

    def _write(self, written: dict[str, Any], key: tuple[int, int]) -> Explicit:
        """Return the episode with other lengths, start poses or goals."""
        batch, scenario = self.process.batch, self.process.batch.scenario
        # draw the episode in other arrays: the world must not change before all checks have passed,
        # and other episodes are drawn in double precision too
        worlds, placed = worlds_for(batch, 1), np.zeros(1, np.bool_)
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
                f" space for {scenario.max_trailers}"
            )
        check_parts(found, batch.task, batch.vehicle)
        if self.process.precision == "single":
            check_near_origin(found)
        return found


class OfOneWorld:
    """Common part of environments with one world, whatever their interface."""

    _world: SingleWorld

    @property
    def columns(self) -> tuple[str, ...]:
        """Return the names of the observation columns of a HAV."""
        return self._world.process.columns

    @property
    def scenario(self) -> Any:
        """Return the scenario of the world: fleets, start poses and goal poses."""
        return self._world.process.batch.scenario

    def render(self) -> Any:
        """Return the picture: an array (H, W, 3), a line of text, or None (a window).

        Raises:
            RuntimeError: If ``reset`` has not been called.
            OSError: If there is no display for a window.
        """
        self._world.require_episode("render")
        return self._world.screen.show()

    def close(self) -> None:
        """Close the window, if there is one."""
        self._world.screen.close()

    def _show(self) -> None:
        if self._world.screen.render_mode == "human":
            self._world.screen.show()
