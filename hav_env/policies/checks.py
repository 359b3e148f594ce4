"""This module checks policies, and tries those of users once, before they drive."""

import contextlib
import functools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from hav_env.models.annotations import is_number, show
from hav_env.models.checks import check_fields
from hav_env.models.protocols import Policy, Scenario, Vehicle
from hav_env.policies.interface import act, act_lanes, allocate_memory, find_kernel
from hav_env.scenarios import check_scenario
from hav_env.simulator.trial import (
    HAVS_TRIED,
    LANES_TRIED,
    attempt,
    is_users_kernel,
    sample_worlds,
    with_fewer_neighbors,
)
from hav_env.vehicles import OnAxle, check_vehicle
from hav_env.world.arrays import EPISODE, SEED, World
from hav_env.world.task import Task, check_task

_SPARE_MEMORY = 1_000  # numbers of memory beyond its size, to find out whether a policy needs more


def check_policy(
    policy: Any, scenario: Scenario, task: Task = Task(), vehicle: Vehicle = OnAxle()
) -> None:
    """Check a policy against the scenario, the rules and the vehicle model before it is used.

    Those three have already been checked by themselves.

    Raises:
        TypeError: If its type has no kernel, or a parameter has a value of another type.
        ValueError: If a parameter is invalid; the message names it, its value and the rule.
    """
    kernel = find_kernel(type(policy))
    if kernel is None:
        raise TypeError(f"{show(policy)} is not a policy: register its type with act")
    check_fields("policy", policy)
    check_parameters(policy, scenario)
    check_rules(policy, scenario, task, vehicle)
    _try(policy, scenario, kernel)


def _try(policy: Policy, scenario: Scenario, kernel: Callable) -> None:
    """Let the policy decide as plain Python, among fewer and fewer neighbours; see ``attempt``."""
    havs, trailers = min(scenario.num_havs, HAVS_TRIED), scenario.max_trailers

    def call() -> str:
        worlds = sample_worlds(havs, scenario.num_goals, trailers)
        for few in with_fewer_neighbors(worlds):
            memory = allocate_memory(policy, havs, LANES_TRIED)
            try:
                broken = _broken_rule(policy, memory, few)
            except IndexError as error:
                size = memory.shape[1]
                with contextlib.suppress(Exception):
                    _broken_rule(policy, np.zeros((havs, size + _SPARE_MEMORY, LANES_TRIED)), few)
                    told = f"its memory has {size} numbers for each HAV, by memory_size"
                    error.args = (f"{told}: register memory_size for more",)
                raise
            if broken:
                return broken
        return ""

    attempt("policy", policy, kernel, call)


def _broken_rule(policy: Policy, memory: np.ndarray, worlds: World) -> str:
    """Let the policy decide once for each HAV; return the rule that a command breaks, or ""."""
    for agent in range(len(memory)):
        if type(policy) in act_lanes.table:
            speed, steering = np.full((2, *worlds.state.x.shape), np.nan)
            act_lanes(policy, memory, worlds, agent, speed, steering)
            decided = *speed[agent], *steering[agent]
            if not np.isfinite(decided).all():
                return f"writes {decided}, but must write finite speeds and steering angles"
        else:
            decided = act(policy, memory, worlds, agent, 0)
            pair = isinstance(decided, tuple) and len(decided) == 2
            if not (pair and all(map(is_number, decided)) and np.isfinite(decided).all()):
                return f"returns {show(decided)}, but must return speed and steering"
    return ""


def check_commands(policy: Policy, numbers: Sequence[np.ndarray], clock: np.ndarray) -> None:
    """Check numbers that follow from the commands of a policy.

    Args:
        policy: Policy, for the message.
        numbers: Arrays (N, W).
        clock: Keys of the W episodes, for the message: ``worlds.state.clock``.

    Raises:
        ValueError: If a number is not finite.
    """
    for array in numbers:
        finite = np.isfinite(array)
        if not finite.all():
            hav, world = np.argwhere(~finite)[0].tolist()
            told = f"policy {type(policy).__name__} returned a speed or steering that is not finite"
            episode = f"episode {clock[EPISODE, world]} of seed {clock[SEED, world]}"
            raise ValueError(f"{told}: hav_{hav} in {episode}")


def check_driven(policy: Any, worlds: World) -> None:
    """Check, by the last poses of all trucks, the commands of a policy that has driven them.

    Raises:
        ValueError: If a command was not finite.
    """
    state = worlds.state
    check_commands(policy, (state.x, state.heading[:, 0]), state.clock)


def is_of_user(policy: Policy) -> bool:
    """Return whether the code of a policy, or of the policy that it filters, is a user's."""
    kernels = [find_kernel(type(one)) for one in (policy, getattr(policy, "policy", policy))]
    return any(kernel is not None and is_users_kernel(kernel) for kernel in kernels)


def check_models(policy: Any, scenario: Any, task: Any, vehicle: Any) -> None:
    """Check all models of an episode.

    Raises:
        TypeError: If an argument has a type that is not registered as such a model.
        ValueError: If a field is invalid; the message names it, its value and the rule.
    """
    check_scenario(scenario)
    check_task(task)
    check_vehicle(vehicle)
    check_policy(policy, scenario, task, vehicle)


@functools.singledispatch
def check_parameters(policy: Any, scenario: Scenario) -> None:
    """Check the requirements of a policy on its parameters and the scenario's limits.

    A policy with more requirements than the ranges of its fields registers it; it raises
    ValueError.
    """


@functools.singledispatch
def check_rules(policy: Any, scenario: Scenario, task: Task, vehicle: Vehicle) -> None:
    """Check the requirements of a policy on the rules of an episode and on the kinematics.

    A policy that predicts the outcome of a step registers it; it raises ValueError.
    """
