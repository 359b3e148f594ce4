"""This module is the decision process of learners: actions, observations, rewards, ends, reports.

Every environment is a face of it. A single environment is a decision process of one world.
"""

from typing import Any, Literal, TypedDict

import numpy as np

from hav_env.compiled import VECTOR, Held, canonical, default_threads, share_out
from hav_env.mdp.advance import Actions, advance_worlds, divide_action, observe_worlds
from hav_env.mdp.array_pool import Recycler
from hav_env.mdp.beginning import allocate_stage, begin_episodes
from hav_env.mdp.buffers import SCRATCH, Outcome, allocate_buffers, outcome_layout, outcome_size
from hav_env.mdp.info import OBSTACLE_REPORT, REPORT
from hav_env.mdp.reward import Reward, check_reward
from hav_env.mdp.reward_trial import try_reward
from hav_env.mdp.rewards import REWARDS
from hav_env.models.checks import check_value
from hav_env.models.memory import check_memory
from hav_env.models.quantities import Skipped
from hav_env.observation import Observation, check_observation, name_columns, settle
from hav_env.policies.driver import PolicyDriver
from hav_env.scenarios import segments_of
from hav_env.scenarios.presets import scenario_of
from hav_env.simulator.batch import Batch, check_placed
from hav_env.vehicles import VEHICLES, OnAxle
from hav_env.world.task import Task, check_at_once, set_rules

Reports = Literal["always", "ends"]

_SINGLE = np.dtype(np.float32).itemsize
_HAVS_PER_THREAD = 1_024  # HAVs for which it is worth to wake a thread


class Settings(TypedDict, total=False):
    """The arguments of ``DecisionProcess`` that all environments take."""

    scenario: Any
    num_havs: int | None
    task: Task
    vehicle: Any
    observation: Observation
    reward: Any
    frame_skip: int
    threads: int | None
    info: Reports


class DecisionProcess:
    """W worlds, in each of which the first C of N HAVs are controlled.

    Attributes:
        batch: the worlds.
        columns: names of the columns of an observation.
        info: names of the numbers that are reported of each HAV.
        always: whether every world is reported on after every action, not only where its episode
            ends.
    """

    def __init__(
        self,
        num_worlds: int = 1,
        controlled: int | None = None,
        others: Any = None,
        /,  # so that these are no arguments of environments that do not name them
        *,
        scenario: Any = "paper-pair",
        num_havs: int | None = None,
        task: Task = Task(),
        vehicle: Any = OnAxle(),
        observation: Observation = Observation(),
        reward: Any = Reward(),
        frame_skip: int = 1,
        threads: int | None = None,
        info: Reports = "always",
        **rules: Any,
    ) -> None:
        """Allocate the worlds; they are empty until ``begin``.

        Args:
            num_worlds: W.
            controlled: C, all HAVs by default.
            others: the policy that drives the other HAVs, or its name; without one they stand.
            scenario: a model, or its name, its file or ``module:Class``.
            num_havs: N, if it is to be another than the scenario's.
            task: the rules.
            vehicle: the kinematics: a model, or its name or ``module:Class``.
            observation: observation of the learners.
            reward: reward of the learners: a model, or its name or ``module:Class``.
            frame_skip: for how many steps of the simulator an action is held.
            threads: how many step the worlds; by default ``HAV_THREADS`` or all cores.
            info: "always" reports on the HAVs after every action, "ends" only on those of worlds
                whose episodes end, which is faster.
            rules: rules of the task that are to be others: ``max_steps``, ``on_goal``, ...

        Raises:
            ValueError, TypeError: naming the argument, its value and what is allowed.
        """
        scenario = scenario_of(scenario, num_havs)
        check_observation(observation)
        reward = REWARDS.make(reward) if isinstance(reward, str) else reward
        vehicle = VEHICLES.make(vehicle) if isinstance(vehicle, str) else vehicle
        check_reward(reward)
        try_reward(reward)
        check_value("frame_skip", Skipped, frame_skip)
        check_value("info", Reports, info)
        task = set_rules(task, **rules)
        check_at_once(task)
        self.batch = Batch(scenario, num_worlds, task, vehicle, threads)
        n, w = self.batch.scenario.num_havs, self.batch.num_worlds
        c = n if controlled is None else controlled
        self.num_controlled, self.num_havs, self.num_worlds = c, n, w
        self.frame_skip = int(frame_skip)
        self.observation = settle(observation, n)
        self.columns = name_columns(self.observation, scenario.max_trailers)
        obstacles = OBSTACLE_REPORT if segments_of(scenario) > 0 else ()
        self.info = (*REPORT, *(f"return_{term}" for term in reward._fields), *obstacles)
        size = outcome_size(c, len(self.columns), len(self.info))
        check_memory("num_worlds", w, (self.batch.bytes_per_world + size) * w)
        driver = None if others is None else PolicyDriver(others, self.batch, c)
        self._driver = driver if c < n else None  # nobody is left to be driven
        self._reward = canonical(reward)
        sizes = n, c, len(reward), len(self.columns)
        self._buffers = allocate_buffers(w, *sizes, -(-w // VECTOR))
        self._compiled: dict[str, Any] = {}  # entries, by name
        self._held: tuple[Held, ...] = ()  # made when it is needed
        layout = outcome_layout(w, c, len(self.columns), len(self.info))
        # what is small stands alone: it can be kept without the rest
        self._recycler, self._small = Recycler(layout[:2]), layout[2:]
        self._no_actions = Actions(np.empty((0, c, 2), np.float32), np.empty((0, c, 2)))
        self.report(info == "always")
        self._begun = np.zeros(w, np.bool_)  # worlds that have an episode
        self._all_begun = False
        self._threads = min(threads or default_threads(), max(1, c * w // _HAVS_PER_THREAD))
        self._stage = allocate_stage(self.batch, self._threads, sizes, len(self.info))

    def __getstate__(self) -> dict[str, Any]:
        """Leave out what is compiled: a copy asks for it again."""
        return self.__dict__ | {"_compiled": {}, "_held": ()}

    @property
    def command(self) -> np.ndarray:
        """(2, N, W) what was commanded last: speed [m/s], steering [rad]; void for who waits."""
        return self._buffers.command

    def set_reward(self, reward: Any) -> None:
        """Change the weights of the reward from the next action on.

        Raises:
            ValueError: when a weight is not a finite number.
            TypeError: when the reward is of another type than before.
        """
        check_reward(reward)
        if type(reward) is not type(self._reward):
            raise TypeError(f"reward is {reward!r}, but must be a {type(self._reward).__name__}")
        self._reward = canonical(reward)
        self._held = ()

    def report(self, always: bool) -> None:
        """Report on every world after every action, or only on those whose episodes end."""
        self.always = always
        self._portions = divide_action(self.frame_skip, self._driver is not None, always)
        self._held = ()

    def begin(
        self, seeds: np.ndarray, episodes: np.ndarray, chosen: np.ndarray, outcome: Outcome
    ) -> None:
        """Begin episodes in the worlds that are chosen, and write what is seen there.

        Args:
            seeds: (W,) int64; those of the chosen worlds count.
            episodes: (W,) int64, their numbers; likewise.
            chosen: (W,) bool.
            outcome: written for the chosen worlds: no reward, no end.

        Raises:
            PlacementError: when a world has no room for its HAVs; it then has no episode.
        """
        places = np.flatnonzero(chosen)
        placed = np.zeros(places.size, np.bool_)
        self._begun[places] = self._all_begun = False
        if self._driver is not None:
            self._driver.forget(chosen)
        batch = self.batch
        models = batch.scenario, batch.task, self.observation
        arrays = batch.worlds, self._buffers, outcome, self._stage
        keys = (np.ascontiguousarray(numbers, np.int64) for numbers in (seeds, episodes))
        args = *models, *arrays, np.zeros(1, np.int64), places, *keys, placed
        try:
            self._run(begin_episodes, places.size, args)
        finally:  # an interrupt comes when all worlds are done
            self._begun[places] = placed
            self._all_begun = np.count_nonzero(self._begun) == self.num_worlds
        check_placed(placed, batch.scenario)

    def require_episodes(self, use: str) -> None:
        """Raise RuntimeError unless every world has an episode, naming what needs it."""
        if self._all_begun:
            return
        missing = np.flatnonzero(~self._begun).tolist()
        if len(missing) == self.num_worlds:
            raise RuntimeError(f"call reset before {use}: there is no episode yet")
        raise RuntimeError(
            f"call reset before {use}: {len(missing)} of {self.num_worlds} worlds have no episode,"
            f" for it could not begin, the first of them world {missing[0]}"
        )

    def observe_worlds(self, chosen: np.ndarray, outcome: Outcome) -> None:
        """Write what is seen in the worlds (W,) that are chosen: no reward, no end."""
        args = self.observation, self.batch.worlds, self._buffers, chosen, outcome
        observe_worlds(self.num_worlds, *args, threads=self._threads)

    def step(self, actions: np.ndarray, outcome: Outcome | None = None) -> Outcome:
        """Take one action in every world.

        Args:
            actions: (W, C, 2) speed and steering from -1 to 1, finite, float64 or float32,
                contiguous; read and not kept.
            outcome: arrays to write the outcome into, of a ``step`` or ``outcome()`` before; fresh
                ones by default.

        Returns:
            The outcome. Without ``always``, what its info holds of a world whose episode goes on
            means nothing.

        Raises:
            RuntimeError: when a world has no episode.
        """
        if not self._all_begun:
            self.require_episodes("step")
        if outcome is None:
            outcome = self.outcome()
        none = self._no_actions
        single = actions.itemsize == _SINGLE
        told = Actions(actions, none.double) if single else Actions(none.single, actions)
        for held in self._held or self._hold():
            if self._driver is not None:
                self._buffers.command[:] = self._driver.decide()
            self._run(advance_worlds, self.num_worlds, (held, told, outcome))
        return outcome

    def _run(self, loop: Any, count: int, args: tuple) -> None:
        """Run an entry over worlds; the types of its arguments are always the same."""
        name = loop.__name__
        if name not in self._compiled:
            self._compiled[name] = loop.prepare(*args)
        if self._threads == 1:  # there is nothing to share out
            self._compiled[name](0, count, *args)
        else:
            share_out(self._compiled[name], count, args, self._threads)

    def _hold(self) -> tuple[Held, ...]:
        """Return what stays the same from step to step, for each portion of an action."""
        models = self.batch.task, self.batch.vehicle, self._reward, self.observation
        self._held = tuple(
            Held(*models, self.batch.worlds, self._buffers, portion) for portion in self._portions
        )
        return self._held

    def arrays(self) -> dict[str, np.ndarray]:
        """Return the arrays of the worlds and of what is kept from action to action, by name."""
        found = _name_arrays({"worlds": self.batch.worlds, "buffers": self._buffers})
        return {name: array for name, array in found.items() if not name.startswith(SCRATCH)}

    def outcome(self) -> Outcome:
        """Return arrays for an outcome; what is in them means nothing yet.

        Nobody else holds any part of them.
        """
        small: Any = (np.empty(shape, kind) for shape, kind in self._small)
        return Outcome(*self._recycler.arrays(), *small)


def _name_arrays(parts: dict[str, Any]) -> dict[str, np.ndarray]:
    """Return the arrays in named tuples, each under the names that lead to it."""
    found: dict[str, np.ndarray] = {}
    for name, part in parts.items():
        if isinstance(part, np.ndarray):
            found[name] = part
        elif hasattr(part, "_asdict"):
            inner = _name_arrays(part._asdict())
            found |= {f"{name}.{field}": array for field, array in inner.items()}
    return found
