"""This module has PettingZoo's parallel environment: each HAV is an agent, hav_0, hav_1, ..."""

import math
import numbers
from typing import Any, ClassVar, Unpack

import numpy as np
from gymnasium import spaces
from gymnasium.utils import seeding
from pettingzoo import AECEnv, ParallelEnv
from pettingzoo.utils.conversions import parallel_to_aec_wrapper
from pettingzoo.utils.wrappers import OrderEnforcingWrapper

from hav_env.envs.screen import ENV_RENDER_MODES, RENDER_FPS
from hav_env.envs.single_world import OfOneWorld, Sight, SingleWorld
from hav_env.envs.views import action_box, observation_box
from hav_env.mdp.actions import REAL_KINDS, check_mapping, read_action
from hav_env.mdp.central_state import CentralState
from hav_env.mdp.decision_process import Settings
from hav_env.models.annotations import show
from hav_env.world.task import REMOVE

Observations = dict[str, np.ndarray]


class HAVSwarmParallelEnv(OfOneWorld, ParallelEnv):
    """Every HAV is an agent; all act at the same time.

    Observations (D,), columns as in docs/environments.md; actions (2,): speed from 0 to maximum and
    steering from right to left, each from -1 to 1; infos: numbers, the same names at every step.
    By default a HAV that hit its last goal stays an agent and an obstacle, whose actions have no
    effect, and all agents end together; with ``on_goal="remove"`` it is terminated.
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
            max_cycles: after how many actions an episode is truncated, in place of the task's
                ``max_steps``, which counts the simulator's; not together with ``max_steps``.
            settings: as of ``hav_env.mdp.decision_process.DecisionProcess``: scenario, num_havs,
                task, its rules, vehicle, observation, reward, frame_skip, info.

        Raises:
            ValueError, TypeError: naming the argument, its value and what is allowed.
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
        # a space of its own for each agent, always the same object
        self.observation_spaces = {agent: observation_box(process) for agent in self._places}
        self.action_spaces = {agent: action_box() for agent in self._places}
        self._state = CentralState(process.batch)
        self.state_space = self._state.space
        self._removes, self._always = process.batch.task.on_goal == REMOVE, process.always
        if self._removes:
            process.report(always=True)  # an agent may end alone
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
        """Begin an episode; a reset that is refused changes nothing.

        Args:
            seed: begins with the first episode of this seed; None goes on to the next one.
            options: as for ``SingleWorld.plan``.

        Raises:
            ValueError, TypeError: naming what is wrong with seed or options.
        """
        plan = self._world.plan(seed, options, self.np_random)
        if seed is not None:
            self.np_random, _ = seeding.np_random(int(seed))
        seen = self._world.begin(plan)
        self.agents = self.possible_agents.copy()
        self._show()
        infos = self._infos(seen) if self._always else {agent: {} for agent in self.agents}
        return dict(zip(self.agents, seen.observation.copy(), strict=True)), infos

    def step(
        self, actions: dict[str, np.ndarray]
    ) -> tuple[
        Observations,
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, float]],
    ]:
        """Take one action of every agent; after the end, none and five empty dictionaries.

        Raises:
            TypeError: when the actions are no dictionary, or one is anything but real numbers.
            ValueError: when an agent is unknown, has left or has no action, or when an action is
                not two finite numbers.
            RuntimeError: before the first ``reset``.
        """
        agents = self.agents
        if not agents:
            self._world.require_episode("step")
        check_mapping(actions)
        if not agents and not actions:
            return {}, {}, {}, {}, {}
        seen = self._world.step(self._gather(actions))
        over, late = seen.terminated.item(), seen.truncated.item()
        if self._removes:
            return self._let_leave(seen, over, late)
        infos = self._infos(seen) if over or late or self._always else {a: {} for a in agents}
        if over or late:
            self.agents = []
        self._show()
        return (  # a strict zip takes longer, see ``SingleWorld.name_numbers``
            dict(zip(agents, seen.observation.copy())),  # noqa: B905
            dict(zip(agents, seen.reward.tolist())),  # noqa: B905
            dict.fromkeys(agents, over),
            dict.fromkeys(agents, late),
            infos,
        )

    def _let_leave(
        self, seen: Sight, over: bool, late: bool
    ) -> tuple[Observations, dict[str, float], dict[str, bool], dict[str, bool], dict]:
        """Return what a step returns where agents end one by one; who left is not told of."""
        names, agents, infos = self.possible_agents, self.agents, self._infos(seen)
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
        """Return the actions of all agents, one after the other; who has left does nothing."""
        agents, numbers = self.agents, []
        if list(actions) != agents:
            self._check_agents(actions)
        for agent in agents:
            action = actions[agent]
            if not (type(action) is np.ndarray and action.dtype.kind in REAL_KINDS):
                action = _read_action(agent, action)
            if action.shape != (2,):
                _read_action(agent, action)
            numbers += action.tolist()
        if not all(map(math.isfinite, numbers)):
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
        """Raise ValueError unless there is one action for each agent, and no other."""
        for agent in actions:
            if agent not in self.agents:
                known = ", ".join(self.agents) or "none"
                raise ValueError(f"there is no agent {show(agent)} to act; agents: {known}")
        if len(actions) < len(self.agents):
            missing = next(agent for agent in self.agents if agent not in actions)
            raise ValueError(f"there is no action for {missing}")

    def _infos(self, seen: Sight) -> dict[str, dict[str, float]]:
        named = map(self._world.name_numbers, seen.rows.tolist())
        return dict(zip(self.possible_agents, named))  # noqa: B905

    def state(self) -> np.ndarray:
        """Return what is the case in the whole world, in its own frame: see ``CentralState``.

        Raises:
            RuntimeError: before the first ``reset``.
        """
        self._world.require_episode("state")
        return self._state.read()


class _OneAfterAnother(parallel_to_aec_wrapper):
    """The same environment for agents that act one after the other."""

    @property
    def np_random(self) -> np.random.Generator:
        """Return the generator that draws seeds."""
        return self.unwrapped.np_random

    def step(self, action: Any) -> None:
        """Take the action of the agent whose turn it is; None from one that has left.

        Raises:
            TypeError, ValueError: as of ``HAVSwarmParallelEnv.step``, at the turn of the agent.
        """
        agent = self.agent_selection
        if not (self.terminations[agent] or self.truncations[agent]):
            # a copy: the user may write the next action into the same array
            action = _read_action(agent, action)
        elif action is not None:
            told = f"the action of {agent} is {show(action)}"
            raise ValueError(f"{told}, but must be None: its episode has ended")
        super().step(action)


def _read_action(agent: str, action: Any) -> np.ndarray:
    return read_action(f"the action of {agent}", action, (2,))


def _steps_of(max_cycles: Any, arguments: dict[str, Any]) -> int:
    """Return how many steps of the simulator are so many actions."""
    if "max_steps" in arguments:
        raise TypeError("max_cycles and max_steps were both given, but must be one or the other")
    told = f"max_cycles is {show(max_cycles)}, but must be a whole number of at least 1"
    if isinstance(max_cycles, bool) or not isinstance(max_cycles, numbers.Real):
        raise TypeError(told)
    if not isinstance(max_cycles, numbers.Integral) or max_cycles < 1:
        raise ValueError(told)
    frame_skip = arguments.get("frame_skip", 1)
    # the decision process refuses what is no whole number
    return int(max_cycles) * (int(frame_skip) if isinstance(frame_skip, numbers.Integral) else 1)


def parallel_env(
    render_mode: str | None = None, max_cycles: int | None = None, **settings: Unpack[Settings]
) -> HAVSwarmParallelEnv:
    """Return the environment in which all agents act at the same time."""
    return HAVSwarmParallelEnv(render_mode, max_cycles, **settings)


def raw_env(
    render_mode: str | None = None, max_cycles: int | None = None, **settings: Unpack[Settings]
) -> AECEnv:
    """Return the same as an environment in which agents act one after the other (AEC)."""
    parallel = parallel_env(render_mode, max_cycles, **settings)
    return OrderEnforcingWrapper(_OneAfterAnother(parallel))


def env(
    render_mode: str | None = None, max_cycles: int | None = None, **settings: Unpack[Settings]
) -> AECEnv:
    """Return ``raw_env`` with checks that it is used in order."""
    return OrderEnforcingWrapper(raw_env(render_mode, max_cycles, **settings))
