"""This module has PettingZoo's parallel environment: each HAV is an agent, hav_0, hav_1, ..."""

import numbers
from typing import Any, ClassVar, Unpack

import numpy as np
from gymnasium import spaces
from gymnasium.utils import seeding
from pettingzoo import AECEnv, ParallelEnv
from pettingzoo.utils.wrappers import OrderEnforcingWrapper

from hav_env.envs.one_after_another import OneAfterAnother
from hav_env.envs.screen import ENV_RENDER_MODES, RENDER_FPS
from hav_env.envs.single_world import OfOneWorld, Sight, SingleWorld
from hav_env.envs.views import action_box, observation_box
from hav_env.mdp.actions import are_finite_numbers, check_mapping, read_action
from hav_env.mdp.central_state import CentralState
from hav_env.mdp.decision_process import Settings
from hav_env.models.annotations import show
from hav_env.world.task import REMOVE

Observations = dict[str, np.ndarray]
_KINDS = np.dtype(np.float32), np.dtype(np.float64)


class HAVSwarmParallelEnv(OfOneWorld, ParallelEnv):
    """Every HAV is an agent; all act at the same time.

    Observations (D,), columns as in docs/environments.md. Actions (2,): speed from 0 to maximum and
    steering from right to left, each from -1 to 1. Infos: numbers, with the same names at every
    step. By default, a HAV that hit its last goal remains an agent and an obstacle. Its actions
    have no effect, and all agents end together. With ``on_goal="remove"`` the agent is terminated.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "name": "hav_swarm_v0",
        "render_modes": ENV_RENDER_MODES,
        "render_fps": RENDER_FPS,
        "is_parallelizable": True,
    }

    def __init__(
        self,
        render_mode: str | None = None,
        max_cycles: int | None = None,
        **settings: Unpack[Settings],
    ) -> None:
        """Build the environment.

        Args:
            render_mode: None, "human", "rgb_array" or "ansi".
            max_cycles: Truncate an episode after this many actions. It replaces the task's
                ``max_steps``, which counts simulator steps; do not pass both.
            settings: See ``hav_env.mdp.decision_process.DecisionProcess``: scenario, num_havs,
                task, its rules, vehicle, observation, reward, frame_skip, info.

        Raises:
            ValueError, TypeError: If an argument is invalid; the message names it, its value and
                the rule.
        """
        arguments: dict[str, Any] = dict(settings)
        if max_cycles is not None:
            arguments["max_steps"] = _steps_of(max_cycles, arguments)
        self._world = SingleWorld(render_mode, **arguments)
        process = self._world.process
        self.render_mode = render_mode
        self.max_cycles = -(-process.batch.task.max_steps // process.frame_skip)
        self.possible_agents = [f"hav_{k}" for k in range(process.num_havs)]
        self.agents: list[str] = []
        self._places = {agent: k for k, agent in enumerate(self.possible_agents)}
        self._all = [dict.fromkeys(self._places, flag) for flag in (False, True)]
        # PettingZoo requires the same space object for an agent in every call
        self.observation_spaces = {agent: observation_box(process) for agent in self._places}
        self.action_spaces = {agent: action_box() for agent in self._places}
        self._state = CentralState(process.batch)
        self.state_space = self._state.space
        self._removes, self._always = process.batch.task.on_goal == REMOVE, process.always
        if self._removes:
            process.report(always=True)  # a single agent may end before the others
        self.np_random, _ = seeding.np_random()

    def observation_space(self, agent: str) -> spaces.Box:
        """Return the space of an agent's observations."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> spaces.Box:
        """Return the space of an agent's actions."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict | None = None
    ) -> tuple[Observations, dict[str, dict[str, float]]]:
        """Begin an episode; an invalid reset raises an error and changes nothing.

        Args:
            seed: Start with the first episode of this seed; None continues with the next episode.
            options: See ``SingleWorld.plan``.

        Raises:
            ValueError, TypeError: If the seed or an option is invalid; the message names it.
        """
        plan = self._world.plan(seed, options, self.np_random)
        if seed is not None:
            self.np_random, _ = seeding.np_random(int(seed))
        self._world.begin(plan)
        self.agents = self.possible_agents.copy()
        self._show()
        infos = self._infos() if self._always else {agent: {} for agent in self.agents}
        seen = self._world.sight.observation.copy()
        return dict(zip(self.agents, seen, strict=True)), infos

    def step(
        self, actions: dict[str, np.ndarray]
    ) -> tuple[
        Observations,
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, float]],
    ]:
        """Take one action of every agent.

        After the end of an episode, pass no action; all five dictionaries are then empty.

        Raises:
            TypeError: If the actions are not a dictionary, or one does not consist of real numbers.
            ValueError: If an agent is unknown, has left or has no action, or an action is not two
                finite numbers.
            RuntimeError: If ``reset`` has not been called.
        """
        agents = self.agents
        if not agents:
            self._world.require_episode("step")
        check_mapping(actions)
        if not agents and not actions:
            return {}, {}, {}, {}, {}
        self._world.step(self._gather(actions))
        seen = self._world.sight
        over, late = seen.terminated.item(), seen.truncated.item()
        if self._removes:
            return self._let_leave(seen, over, late)
        infos = self._infos() if over or late or self._always else {a: {} for a in agents}
        if over or late:
            self.agents = []
        self._show()
        return (  # a strict zip is slower, see ``OneWorld.infos``
            dict(zip(agents, seen.observation.copy())),  # noqa: B905
            dict(zip(agents, seen.reward.tolist())),  # noqa: B905
            self._all[over].copy(),
            self._all[late].copy(),
            infos,
        )

    def _let_leave(
        self, seen: Sight, over: bool, late: bool
    ) -> tuple[Observations, dict[str, float], dict[str, bool], dict[str, bool], dict]:
        """Return the results of a step of the present agents, which may end one by one."""
        names, agents, infos = self.possible_agents, self.agents, self._infos()
        observations = dict(zip(names, seen.observation.copy(), strict=True))
        rewards = dict(zip(names, seen.reward.tolist(), strict=True))
        num_goals = self._world.process.batch.scenario.num_goals
        terminations = {a: over or infos[a]["goals_hit"] == num_goals for a in agents}
        truncations = {a: late and not terminations[a] for a in agents}
        self.agents = [a for a in agents if not (terminations[a] or truncations[a])]
        self._show()
        return (
            {a: observations[a] for a in agents},
            {a: rewards[a] for a in agents},
            terminations,
            truncations,
            {a: infos[a] if self._always or a not in self.agents else {} for a in agents},
        )

    def _gather(self, actions: dict[str, np.ndarray]) -> list[float]:
        """Return the actions of all agents in order; agents that have left get a void action."""
        agents, numbers = self.agents, []
        if list(actions) != agents:
            self._check_agents(actions)
            actions = {agent: actions[agent] for agent in agents}
        for agent, action in actions.items():
            legible = type(action) is np.ndarray and action.dtype in _KINDS and action.shape == (2,)
            numbers += (action if legible else _read_action(agent, action)).tolist()
        if not are_finite_numbers(numbers):
            for agent, action in actions.items():
                _read_action(agent, action)
        if len(agents) == len(self._places):
            return numbers
        joint = [0.0] * (2 * len(self._places))
        for k, agent in enumerate(agents):
            place = 2 * self._places[agent]
            joint[place : place + 2] = numbers[2 * k : 2 * k + 2]
        return joint

    def _check_agents(self, actions: dict[str, np.ndarray]) -> None:
        """Raise ValueError unless the actions hold exactly one action for each agent."""
        for agent in actions:
            if agent not in self.agents:
                known = ", ".join(self.agents) or "none"
                raise ValueError(f"there is no agent {show(agent)} to act; agents: {known}")
        if len(actions) < len(self.agents):
            missing = next(agent for agent in self.agents if agent not in actions)
            raise ValueError(f"there is no action for {missing}")

    def _infos(self) -> dict[str, dict[str, float]]:
        return dict(zip(self.possible_agents, self._world.infos()))  # noqa: B905

    def state(self) -> np.ndarray:
        """Return the global state of the world in the world's frame: see ``CentralState``.

        Raises:
            RuntimeError: If ``reset`` has not been called.
        """
        self._world.require_episode("state")
        return self._state.read()


def _read_action(agent: str, action: Any) -> np.ndarray:
    return read_action(f"the action of {agent}", action, (2,))


def _steps_of(max_cycles: Any, arguments: dict[str, Any]) -> int:
    """Return the number of simulator steps in ``max_cycles`` actions."""
    if "max_steps" in arguments:
        raise TypeError("max_cycles and max_steps were both given, but must be one or the other")
    message = f"max_cycles is {show(max_cycles)}, but must be a whole number of at least 1"
    if isinstance(max_cycles, bool) or not isinstance(max_cycles, numbers.Real):
        raise TypeError(message)
    if not isinstance(max_cycles, numbers.Integral) or max_cycles < 1:
        raise ValueError(message)
    frame_skip = arguments.get("frame_skip", 1)
    # the decision process raises the error for a frame_skip that is not a whole number
    return int(max_cycles) * (int(frame_skip) if isinstance(frame_skip, numbers.Integral) else 1)


def parallel_env(
    render_mode: str | None = None, max_cycles: int | None = None, **settings: Unpack[Settings]
) -> HAVSwarmParallelEnv:
    """Return the environment in which all agents act at the same time.

    The rules of the task are arguments too: ``parallel_env(on_goal="remove", dt=0.1)``.

    Args:
        render_mode: (default None) None, "human" (window), "rgb_array" or "ansi" (a line of text).
        max_cycles: (default None) number of actions until truncation. None leaves it to max_steps.
        scenario: (default "paper-pair") start poses, goals and HAVs: a name, the path of a JSON
            file, ``module:Class`` or a model.
        num_havs: (default None) number of agents. None is the scenario's own number.
        site: (default None) obstacles and bounds for random poses: a ``Site`` or its file.
        fleet: (default None) vehicles for the scenario: "wb-67,eurocombi" (catalogue), or a fleet.
        task: (default Task()) the rules of an episode; those below change single ones.
        vehicle: (default OnAxle()) the kinematics: a model, ``module:Class`` or a name, "on_axle",
            "limited", "off_axle" or "realistic".
        observation: (default Observation()) columns that an agent observes.
        reward: (default Reward()) terms and weights: a model, ``module:Class`` or a name.
        frame_skip: (default 1) number of steps of the simulator that an action lasts.
        safety: (default None) what a filter prevents: None, "jackknife", "collision" or "both".
        backup: (default None) policy that drives where an action is unsafe: "reserve", a model.
        threads: (default None) number of threads. None is ``HAV_THREADS``, or all cores.
        info: (default "always") "ends" reports only at the end of an episode, which is faster.
        guidance: (default Dubins()) ways to goals: a model, "dubins", "roads", "feasible", ...
        precision: (default "double") "single" for a state of float32, which is faster.
        dt: (default 0.2) duration of a step [s].
        distance_tolerance: (default 0.5) greatest distance at which a goal is hit [m].
        heading_tolerance: (default 0.1) greatest difference in heading at which it is hit [rad].
        goal_speed: (default inf) greatest speed at which a goal is hit [m/s].
        max_steps: (default 20000) number of steps after which an episode is truncated.
        sensing_range: (default 30.0) greatest gap across which HAVs sense each other [m].
        next_goal: (default "together") "together" waits until all have hit theirs, "alone" not.
        order: (default "at_once") the only order that environments take.
        on_goal: (default "park") "park" keeps HAVs at last goals, "remove" ends their agents.
        on_jackknife: (default "record") "end" terminates the episode at the first jackknife.
        on_collision: (default "record") "end" terminates it at the first actual collision.
        on_obstacle: (default "record") "end" terminates it when a HAV hits an obstacle.
        continuous_collisions: (default False) whether collisions between steps count too.
        record_every: (default 1) number of steps between two looks for events.
        potential_center: (default 0.0) centre of footprints, as a share of the truck from its axle.
        potential_truck_share: (default 0.0) share of the truck's length in potential collisions.

    Raises:
        ValueError: An argument has a value that is not allowed; the error names the rule.
        TypeError: An argument is unknown or of another kind.
        PlacementError: The scenario has no space for its HAVs, at ``reset``.
    """
    return HAVSwarmParallelEnv(render_mode, max_cycles, **settings)


def raw_env(
    render_mode: str | None = None, max_cycles: int | None = None, **settings: Unpack[Settings]
) -> AECEnv:
    """Return the same for agents that act one after the other (AEC)."""
    parallel = parallel_env(render_mode, max_cycles, **settings)
    return OrderEnforcingWrapper(OneAfterAnother(parallel))


def env(
    render_mode: str | None = None, max_cycles: int | None = None, **settings: Unpack[Settings]
) -> AECEnv:
    """Return ``raw_env`` with checks of the order of calls; arguments as of ``parallel_env``."""
    return OrderEnforcingWrapper(raw_env(render_mode, max_cycles, **settings))
