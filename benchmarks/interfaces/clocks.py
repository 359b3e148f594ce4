"""This module times loops that step environments for a number of seconds: agent-steps/s.

The actions are drawn before the clock starts.
"""

import itertools
import time
from collections.abc import Callable, Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector.utils import batch_space
from pettingzoo import ParallelEnv

DRAWN = 16  # actions are drawn before the clock runs and used in turn

Run = Callable[[float], float]  # takes a duration [s]; returns agent-steps/s


def clocked(take: Callable[[Any], int], drawn: Sequence[Any], seconds: float) -> float:
    """Take the drawn actions in turn until the seconds have passed; return agent-steps/s.

    Args:
        take: Function that takes one of ``drawn`` and returns the number of agents that acted.
        drawn: Actions to take.
        seconds: Duration of the loop [s]; it takes at least one action.
    """
    agent_steps, start = 0, time.perf_counter()
    for actions in itertools.cycle(drawn):
        agent_steps += take(actions)
        elapsed = time.perf_counter() - start
        if elapsed >= seconds:
            break
    return agent_steps / elapsed


def draw(space: gym.Space) -> list[Any]:
    """Return ``DRAWN`` actions, the same ones every time."""
    space.seed(0)
    return [space.sample() for _ in range(DRAWN)]


def prepare_parallel(env: ParallelEnv) -> Run:
    """Return a loop over a PettingZoo environment, all of whose agents end together."""
    env.reset(seed=0)
    each = {agent: draw(env.action_space(agent)) for agent in env.agents}
    drawn = [dict(zip(each, actions, strict=True)) for actions in zip(*each.values(), strict=True)]

    def take(actions: dict) -> int:
        env.step(actions)
        if not env.agents:
            env.reset()
        return len(actions)

    def run(seconds: float) -> float:
        env.reset(seed=0)
        return clocked(take, drawn, seconds)

    take(drawn[0])  # compiles
    return run


def prepare_single(env: gym.Env, num_agents: int) -> Run:
    """Return a loop over a Gymnasium environment."""
    drawn = draw(env.action_space)

    def take(action: np.ndarray) -> int:
        _, _, terminated, truncated, _ = env.step(action)
        if terminated or truncated:
            env.reset()
        return num_agents

    def run(seconds: float) -> float:
        env.reset(seed=0)
        return clocked(take, drawn, seconds)

    run(0.0)  # compiles
    return run


def prepare_vector(env: gym.vector.VectorEnv, num_agents: int, length: int | None = None) -> Run:
    """Return a loop over a vector environment that begins ended episodes at the next step.

    The step that does so takes no action in these worlds, so it does not count.

    Args:
        env: Environment to step.
        num_agents: Number of agents in each of its worlds.
        length: Length of its episodes, to spread their ends evenly over the steps. Otherwise all
            worlds begin together, and end together if time ends them.
    """
    drawn, num_over = draw(env.action_space), 0

    def take(actions: np.ndarray) -> int:
        nonlocal num_over
        _, _, terminated, truncated, _ = env.step(actions)
        acted = env.num_envs - num_over
        num_over = int(np.count_nonzero(terminated | truncated))
        return num_agents * acted

    def begin() -> None:
        nonlocal num_over
        env.reset(seed=0)
        num_over = 0
        if length is not None:
            num_over = spread_ends(env, drawn[0], length)

    def run(seconds: float) -> float:
        if length is None:
            begin()
        return clocked(take, drawn, seconds)

    begin()
    take(drawn[0])  # compiles
    return run


def spread_ends(env: gym.vector.VectorEnv, actions: np.ndarray, length: int) -> int:
    """Step through one period of episodes of this length, each world beginning anew on the way.

    Returns:
        Number of worlds whose episode is over, so the next step begins another one.
    """
    over = np.zeros(env.num_envs, np.bool_)
    period = length + 1  # with the step that begins an episode
    for step in range(period):
        _, _, terminated, truncated, _ = env.step(actions)
        over = terminated | truncated
        chosen = np.arange(env.num_envs) % period == step
        if chosen.any():
            env.reset(options={"reset_mask": chosen})
            over &= ~chosen
    return int(np.count_nonzero(over))


def prepare_rows(env: Any) -> Run:
    """Return a loop over a Stable-Baselines3 ``VecEnv``, each of whose rows is an agent."""
    drawn = draw(batch_space(env.action_space, env.num_envs))

    def take(actions: np.ndarray) -> int:
        env.step(actions)
        return len(actions)

    def run(seconds: float) -> float:
        env.seed(0)
        env.reset()
        return clocked(take, drawn, seconds)

    run(0.0)  # compiles
    return run
