"""This module defines policies: parameters, and a kernel that acts on what one HAV senses.

It checks policies, allocates their memory, and lets HAVs hear the memory of others.
"""

import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from hav_env.compiled import canonical, entry, fixed, generic, kernel, lanes_from
from hav_env.models.annotations import is_number, show
from hav_env.models.checks import check_fields
from hav_env.models.memory import check_memory
from hav_env.models.protocols import Policy, Scenario, Vehicle
from hav_env.scenarios import check_scenario
from hav_env.simulator.batch import Batch
from hav_env.simulator.trial import HAVS_TRIED, LANES_TRIED, attempt, sample_worlds
from hav_env.vehicles import OnAxle, check_vehicle
from hav_env.world.arrays import NEVER, World
from hav_env.world.lanes import LANES, block_of, moving_block
from hav_env.world.sensing import neighbor_id
from hav_env.world.task import Task, check_at_once, check_task


@generic
def act(
    policy: Any, memory: np.ndarray, world: World, agent: int, lane: int
) -> tuple[float, float]:
    """Decide what one HAV does in this step: return speed [m/s] and steering [rad].

    This is what a policy registers. One whose loops over units or neighbours should run several
    worlds at once registers with ``act_lanes`` instead.

    Args:
        policy: the parameters; their type selects the kernel.
        memory: (N, K, W); ``memory[agent, :, lane]`` is the HAV's own. It belongs to whoever runs
            the episode and is zero at its beginning.
        world: a block of worlds, to be read through ``hav_env.world.sensing`` only.
        agent: number of the HAV.
        lane: which world of the block.
    """
    raise NotImplementedError


@generic
def act_lanes(
    policy: Any,
    memory: np.ndarray,
    world: World,
    agent: int,
    speed: np.ndarray,
    steering: np.ndarray,
) -> None:
    """Decide for one HAV in every lane of a block of worlds.

    The simulator ignores decisions for HAVs that wait. Their memory must not change.

    Args:
        policy: the parameters; their type selects the kernel.
        memory: (N, K, W); ``memory[agent]`` is the HAV's own in all lanes.
        world: a block of worlds, to be read through ``hav_env.world.sensing`` only.
        agent: number of the HAV.
        speed: (N, W) speeds of the trucks [m/s]; the policy writes row ``agent``.
        steering: (N, W) steering angles [rad]; the policy writes row ``agent``.
    """


@act_lanes.otherwise
def act_one_by_one(policy, memory, world, agent, speed, steering):
    """Ask a policy that is registered with ``act`` in lane after lane."""
    for lane in range(world.lanes):
        if not world.state.waiting[agent, lane]:
            speed[agent, lane], steering[agent, lane] = act(policy, memory, world, agent, lane)


@kernel
def act_all(policy, memory, world, speed, steering, first_agent):
    """Let the HAVs of a block of worlds from one on decide, (N, W) each.

    Values for a HAV that waits are void.
    """
    for hav in range(first_agent, speed.shape[0]):
        act_for(policy, memory, world, fixed(hav), speed, steering)


@kernel
def act_for(policy, memory, world, agent, speed, steering):
    """Let one HAV of a block of worlds decide, in the lanes where it does not wait."""
    moving = moving_block(world, agent)
    first = moving.first - world.first
    act_lanes(
        policy,
        lanes_from(memory, first),
        moving,
        agent,
        lanes_from(speed, first),
        lanes_from(steering, first),
    )


@entry
def act_worlds(first, last, policy, memory, worlds, speed, steering, first_agent):
    """Let the HAVs from ``first_agent`` on of a range of worlds decide, block by block."""
    for start in range(first, last, LANES):
        block = block_of(worlds, start, min(LANES, last - start), worlds.units)
        act_all(
            policy,
            lanes_from(memory, start),
            block,
            lanes_from(speed, start),
            lanes_from(steering, start),
            first_agent,
        )


@functools.singledispatch
def memory_size(policy: Any) -> int:
    """Return K, how many numbers a HAV under this policy keeps between steps."""
    return 0


@functools.singledispatch
def broadcast_size(policy: Any) -> int:
    """Return B, how many of the numbers that a HAV keeps are for others to hear: its first ones.

    Everybody else's other numbers are private. HAVs decide one after another, in the order of
    their numbers, on the state before the step: of those before it a HAV hears what they have just
    decided, of those behind it what they decided in the step before.
    """
    return 0


@kernel
def heard(memory: np.ndarray, world: World, agent: int, k: int, number: int, lane: int) -> float:
    """Return one of the numbers that neighbour ``k`` broadcasts; nobody out of range is heard."""
    return memory[neighbor_id(world, agent, k, lane), number, lane]


def allocate_memory(policy: Policy, num_havs: int, num_worlds: int) -> np.ndarray:
    """Return the memory (N, K, W) of a policy at the beginning of an episode; W is at least 2.

    The numbers of all lanes lie together for a policy that acts on lanes, otherwise those of a HAV.
    """
    size = memory_size(policy)
    check_memory("num_worlds", num_worlds, 8 * num_havs * (size + 1) * num_worlds)
    if type(policy) in act_lanes.table:
        return np.zeros((num_havs, size, num_worlds))
    # a gap, and never one lane, so that NumPy never finds them in order: that is compiled anew
    return np.zeros((num_havs, max(num_worlds, 2), size + 1)).transpose(0, 2, 1)[:, :size]


def find_kernel(model_class: type) -> Callable | None:
    """Return the kernel that a class of policies is registered with, None if it is no policy."""
    return act.table.get(model_class) or act_lanes.table.get(model_class)


def check_policy(
    policy: Any, scenario: Scenario, task: Task = Task(), vehicle: Vehicle = OnAxle()
) -> None:
    """Check a policy before it is used in a scenario, under rules, on a kind of vehicle.

    These have been checked by themselves.

    Raises:
        TypeError: when its type has no kernel, or a parameter has a value of another kind.
        ValueError: naming the parameter, its value and what is allowed.
    """
    kernel = find_kernel(type(policy))
    if kernel is None:
        raise TypeError(f"{show(policy)} is not a policy: register its type with act")
    check_fields("policy", policy)
    check_parameters(policy, scenario)
    check_rules(policy, scenario, task, vehicle)
    _try(policy, scenario, kernel)


def _try(policy: Policy, scenario: Scenario, kernel: Callable) -> None:
    """Let the policy decide once as plain Python; see ``hav_env.simulator.trial``."""
    havs, trailers = min(scenario.num_havs, HAVS_TRIED), scenario.max_trailers

    def call() -> str:
        worlds = sample_worlds(havs, scenario.num_goals, trailers)
        memory = allocate_memory(policy, havs, LANES_TRIED)
        speed, steering = np.full((2, havs, LANES_TRIED), np.nan)
        for agent in range(havs):
            if type(policy) in act_lanes.table:
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

    attempt("policy", policy, kernel, call)


def check_models(policy: Any, scenario: Any, task: Any, vehicle: Any) -> None:
    """Check all that an episode is run with.

    Raises:
        TypeError: when one of them is none of its kind.
        ValueError: naming the field, its value and what is allowed.
    """
    check_scenario(scenario)
    check_task(task)
    check_vehicle(vehicle)
    check_policy(policy, scenario, task, vehicle)


@functools.singledispatch
def check_parameters(policy: Any, scenario: Scenario) -> None:
    """Check what one kind of policy demands of its parameters and the scenario's limits.

    Registered by policies that demand more than the ranges of their fields; raises ValueError.
    """


@functools.singledispatch
def check_rules(policy: Any, scenario: Scenario, task: Task, vehicle: Vehicle) -> None:
    """Check what one kind of policy demands of the rules of an episode and of the kinematics.

    Registered by policies that predict what a step will lead to; raises ValueError.
    """


@functools.singledispatch
def joint_weights(policy: Any, cosine: np.ndarray) -> np.ndarray:
    """Return the jackknife weight of every joint, eq. (jackknife-weigt-func).

    Registered by policies with other coefficients than the paper's.

    Args:
        policy: whose coefficients count.
        cosine: of articulations.
    """
    return 1.0 + np.tanh(0.5 - 2.0 * cosine)


@generic
def evaded(policy: Any, memory: np.ndarray, agent: int, lane: int) -> int:
    """Return which HAV a HAV evades, as its memory tells; NEVER for none.

    Registered by policies that evade one HAV at a time and remember which.

    Args:
        policy: the parameters; their type selects the kernel.
        memory: (N, K, W) of the policy.
        agent: number of the HAV.
        lane: which world.
    """
    return NEVER


@evaded.otherwise
def evade_nobody(policy, memory, agent, lane):
    """Tell that nobody is evaded."""
    return NEVER


def decide(
    policy: Policy, memory: np.ndarray, batch: Batch, first_agent: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """Return speed [m/s] and steering [rad], each (N, W), of every HAV of a batch.

    They are zero for HAVs that wait at their goal, and for those before ``first_agent``: the policy
    does not act for them.

    Args:
        policy: a registered policy.
        memory: from ``allocate_memory``, kept from step to step, written to.
        batch: the worlds that HAVs sense; pass the result to ``batch.step``.
        first_agent: the first HAV that the policy acts for.

    Raises:
        ValueError: when the rules let HAVs decide in turn.
    """
    check_at_once(batch.task)
    speed, steering = np.zeros((2, *batch.worlds.state.x.shape))
    act_worlds(
        batch.num_worlds,
        canonical(policy),
        memory,
        batch.worlds,
        speed,
        steering,
        int(first_agent),
        threads=batch.num_threads,
    )
    waiting = batch.worlds.state.waiting
    speed[waiting] = steering[waiting] = 0.0
    return speed, steering
