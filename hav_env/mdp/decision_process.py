"""This module is the decision process of learners: actions, observations, rewards, ends, reports.

Every environment is an interface to it. A single environment is a decision process of one world.
"""

from typing import Any, TypedDict

import numpy as np

from hav_env.compiled import VECTOR, Held, canonical, crew_of, default_threads, narrow
from hav_env.mdp.advance import Actions, advance_worlds, divide_action, observe_worlds
from hav_env.mdp.array_pool import Recycler
from hav_env.mdp.beginning import allocate_stage, begin_episodes
from hav_env.mdp.buffers import Outcome, allocate_buffers, name_arrays, outcome_layout, outcome_size
from hav_env.mdp.info import name_numbers
from hav_env.mdp.reward import Reward, check_reward
from hav_env.mdp.reward_trial import try_reward
from hav_env.mdp.rewards import REWARDS
from hav_env.models.checks import check_value
from hav_env.models.memory import check_memory
from hav_env.models.quantities import Precision, Reports, Skipped
from hav_env.observation import Observation, check_observation, name_columns, settle
from hav_env.policies.backed import check_guarded, memory_behind, put_behind
from hav_env.policies.driver import PolicyDriver
from hav_env.safety import Unfiltered, check_safety, make_safety, scratch_rows
from hav_env.scenarios import segments_of
from hav_env.scenarios.presets import scenario_of
from hav_env.simulator.batch import Batch, check_placed
from hav_env.vehicles import VEHICLES, OnAxle
from hav_env.world.place.guidance import Dubins, of_each_world
from hav_env.world.task import Task, check_at_once, set_rules

_SINGLE = np.dtype(np.float32).itemsize
_HAVS_PER_THREAD = 512  # HAVs per thread whose step takes longer than waking a thread


class Settings(TypedDict, total=False):
    """The arguments of ``DecisionProcess`` that all environments take."""

    scenario: Any
    num_havs: int | None
    site: Any
    fleet: Any
    task: Task
    vehicle: Any
    observation: Observation
    reward: Any
    frame_skip: int
    safety: Any
    backup: Any
    threads: int | None
    info: Reports
    guidance: Any
    precision: Precision


class DecisionProcess:
    """W worlds, in each of which the first C of N HAVs are controlled.

    Attributes:
        batch: The worlds.
        columns: Names of the columns of an observation.
        info: Names of the infos of each HAV.
        always: Whether every action reports on every world, or only on worlds whose episodes end.
        begun: (W,) bool, worlds that have an episode.
    """

    def __init__(
        self,
        num_worlds: int = 1,
        controlled: int | None = None,
        others: Any = None,
        /,  # positional-only: environments that forward **settings cannot set them
        *,
        scenario: Any = "paper-pair",
        num_havs: int | None = None,
        site: Any = None,
        fleet: Any = None,
        task: Task = Task(),
        vehicle: Any = OnAxle(),
        observation: Observation = Observation(),
        reward: Any = Reward(),
        frame_skip: int = 1,
        safety: Any = None,
        backup: Any = None,
        threads: int | None = None,
        info: Reports = "always",
        guidance: Any = Dubins(),
        precision: Precision = "double",
        **rules: Any,
    ) -> None:
        """Allocate the worlds; they are empty until ``begin``.

        Args:
            num_worlds: Number of worlds W.
            controlled: Number C of controlled HAVs; all by default.
            others: Policy of the other HAVs, or its name; without one they do not move.
            scenario: Model of the scenario, or its name, its file or ``module:Class``.
            num_havs: Number of HAVs N, if it differs from the scenario's.
            site: Obstacles and bounds of the scenario: a ``Site`` or its file.
            fleet: Vehicles in place of the scenario's: names in the catalogue, or a fleet.
            task: Rules of the episodes.
            vehicle: Kinematics: a model, its name or ``module:Class``.
            observation: Observation of the learners.
            reward: Reward of the learners: a model, its name or ``module:Class``.
            frame_skip: Number of simulator steps for which an action is held.
            safety: None, "jackknife", "collision", "both" or a ``SafetyFilter`` of all commands.
            backup: Policy that takes or replaces the commands of the filter, or its name.
            threads: Number of threads; by default ``HAV_THREADS`` or all cores.
            info: "always" reports after every action; "ends" where episodes end, which is faster.
            guidance: Guidance (routes to the goals): a model or its name.
            precision: "single" for a faster state in training.
            rules: Rules of the task to replace: ``max_steps``, ``on_goal``, ...

        Raises:
            ValueError, TypeError: If an argument is invalid; the message names it and the rule.
        """
        scenario = scenario_of(scenario, num_havs, site, fleet)
        check_observation(observation)
        reward = REWARDS.make(reward) if isinstance(reward, str) else reward
        vehicle = VEHICLES.make(vehicle) if isinstance(vehicle, str) else vehicle
        check_reward(reward)
        try_reward(reward)
        check_value("frame_skip", Skipped, frame_skip)
        check_value("info", Reports, info)
        task = set_rules(task, (*Settings.__annotations__, "max_cycles"), **rules)
        check_at_once(task)
        self.safety = make_safety(safety)
        check_safety(self.safety, task, vehicle)
        self._guard = put_behind(self.safety, backup, scenario, task, vehicle)
        self.precision = precision
        self.batch = Batch(scenario, num_worlds, task, vehicle, threads, guidance, precision)
        n, w = self.batch.scenario.num_havs, self.batch.num_worlds
        c = n if controlled is None else controlled
        self.num_controlled, self.num_havs, self.num_worlds = c, n, w
        self.frame_skip = int(frame_skip)
        self.observation = settle(observation, n)
        self.columns = name_columns(self.observation, scenario.max_trailers)
        check_guarded(self._guard, c, n, precision)
        filtered = not isinstance(self._guard, Unfiltered)
        self.info = name_numbers(reward, segments_of(scenario) > 0, filtered)
        size = self.batch.bytes_per_world + outcome_size(c, len(self.columns), len(self.info))
        check_memory("num_worlds", w, size * w)
        driver = None if others is None else PolicyDriver(others, self.batch, c)
        self.driver = driver if c < n else None  # the learner controls all HAVs
        self._reward = canonical(reward)
        rows = scratch_rows(self._guard, self.batch.worlds.units)
        sizes = n, c, len(reward), len(self.columns), rows
        buffers = allocate_buffers(w, *sizes, -(-w // VECTOR), precision)
        self._buffers = buffers._replace(memory=memory_behind(self._guard, n, w))
        self._compiled: dict[str, Any] = {}  # compiled entries by name
        self.held: tuple[Held, ...] = ()  # see ``hold``; made at first use
        layout = outcome_layout(w, c, len(self.columns), len(self.info))
        # small arrays are allocated apart, so users can keep them without the large ones
        self._recycler, self._small = Recycler(layout[:2]), layout[2:]
        self._no_actions = Actions(np.empty((0, c, 2), np.float32), np.empty((0, c, 2)))
        self.report(info == "always")
        self.begun, self.all_begun = np.zeros(w, np.bool_), False
        self._threads = min(threads or default_threads(), max(1, c * w // _HAVS_PER_THREAD))
        stage = allocate_stage(self.batch, self._threads, sizes, len(self.info))
        arrays = self.batch.worlds, self._buffers, stage
        self._beginning = Held(self.batch.task, self.observation, *arrays)

    def __getstate__(self) -> dict[str, Any]:
        """Leave out compiled entries: a copy loads them again."""
        return self.__dict__ | {"_compiled": {}, "held": ()}

    @property
    def command(self) -> np.ndarray:
        """Return the last command (2, N, W): speed [m/s], steering [rad]; void for waiting HAVs."""
        return self._buffers.command

    def set_reward(self, reward: Any) -> None:
        """Change the weights of the reward, from the next action on.

        Raises:
            ValueError: If a weight is not a finite number.
            TypeError: If the reward has another type than before.
        """
        check_reward(reward)
        if type(reward) is not type(self._reward):
            raise TypeError(f"reward is {reward!r}, but must be a {type(self._reward).__name__}")
        self._reward = canonical(reward)
        self.held = ()

    def report(self, always: bool) -> None:
        """Report on every world after every action, or only on worlds whose episodes end."""
        self.always = always
        self._portions = divide_action(self.frame_skip, self.driver is not None, always)
        self.held = ()

    def begin(
        self, seeds: np.ndarray, episodes: np.ndarray, chosen: np.ndarray, outcome: Outcome
    ) -> None:
        """Begin episodes in the chosen worlds, and write their observations.

        Args:
            seeds: (W,) int64 seeds; only those of the chosen worlds count.
            episodes: (W,) int64 numbers of the episodes; only those of the chosen worlds count.
            chosen: (W,) bool, the worlds to begin; or their indices.
            outcome: Outcome to write for the chosen worlds: no reward, no end; infos if ``always``.

        Raises:
            PlacementError: If the scenario cannot place HAVs of a world; it then has no episode.
            ValueError: See ``Batch.check_places``; no chosen world then has an episode.
        """
        places = np.flatnonzero(chosen) if chosen.dtype == np.bool_ else chosen
        placed = np.zeros(places.size, np.bool_)
        self.begun[places] = self.all_begun = False
        if self.driver is not None:
            self.driver.forget(places)
        if self._buffers.memory.size:
            self._buffers.memory[..., places] = 0.0
        keys = (np.ascontiguousarray(numbers, np.int64) for numbers in (seeds, episodes))
        constant, taken = (self.batch.scenario, self._beginning), np.zeros(1, np.int64)
        args = *constant, outcome, taken, places, *keys, self.always, placed
        try:
            self._run(begin_episodes, places.size, args)
            self.batch.check_places(places, placed)
        finally:  # an interrupt is raised after all worlds are done
            self.begun[places] = placed
            self.all_begun = np.count_nonzero(self.begun) == self.num_worlds
        check_placed(placed, self.batch.scenario)

    def require_episodes(self, use: str) -> None:
        """Raise RuntimeError, naming the use, unless every world has an episode."""
        if self.all_begun:
            return
        missing = np.flatnonzero(~self.begun).tolist()
        if len(missing) == self.num_worlds:
            raise RuntimeError(f"call reset before {use}: there is no episode yet")
        raise RuntimeError(
            f"call reset before {use}: {len(missing)} of {self.num_worlds} worlds have no episode,"
            f" because it could not begin; the first of them is world {missing[0]}"
        )

    def observe_worlds(self, chosen: np.ndarray, outcome: Outcome) -> None:
        """Write the observations of the chosen worlds (W,): no reward, no end."""
        args = self.observation, self.batch.worlds, self._buffers, chosen, outcome
        observe_worlds(self.num_worlds, *args, threads=self._threads)

    def step(self, actions: np.ndarray, outcome: Outcome | None = None) -> Outcome:
        """Take one action in every world.

        Args:
            actions: (W, C, 2) speed and steering from -1 to 1, finite, float64 or float32,
                contiguous; read and not kept.
            outcome: Arrays for the outcome, from an earlier ``step`` or from ``outcome()``; new
                arrays by default.

        Returns:
            The outcome. Without ``always``, the infos of worlds whose episodes continue are void.

        Raises:
            RuntimeError: If a world has no episode.
        """
        if not self.all_begun:
            self.require_episodes("step")
        if outcome is None:
            outcome = self.outcome()
        none = self._no_actions
        single = actions.itemsize == _SINGLE
        told = Actions(actions, none.double) if single else Actions(none.single, actions)
        for held in self.held or self.hold():
            if self.driver is not None:
                self._buffers.command[:] = self.driver.decide()
            self._run(advance_worlds, self.num_worlds, (held, told, outcome))
        return outcome

    def _run(self, loop: Any, count: int, args: tuple) -> None:
        """Run a compiled entry over worlds; the types of its arguments are always the same."""
        name = loop.__name__
        if name not in self._compiled:
            self._compiled[name] = loop.prepare(*args)
        self._compiled[name](crew_of(self._threads), count, args)

    def hold(self) -> tuple[Held, ...]:
        """Make the constant arguments of every step, for each portion of an action."""
        batch, arrays = self.batch, (self.batch.worlds, self._buffers)
        models = batch.task, batch.vehicle, canonical(self._guard), self._reward, self.observation
        told = narrow((*models, *arrays)) if self.precision == "single" else (*models, *arrays)
        self.held = tuple(Held(*told, portion) for portion in self._portions)
        return self.held

    def arrays(self) -> dict[str, np.ndarray]:
        """Return the arrays that persist between actions, by name: worlds and buffers."""
        guidance = of_each_world(self.batch.worlds.guidance)
        worlds = self.batch.worlds._replace(guidance=guidance)
        return name_arrays({"worlds": worlds, "buffers": self._buffers})

    def outcome(self) -> Outcome:
        """Return an uninitialised ``Outcome``.

        It shares no memory with other arrays.
        """
        small: Any = (np.empty(shape, kind) for shape, kind in self._small)
        return Outcome(*self._recycler.arrays(), *small)
