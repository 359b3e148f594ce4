"""This module defines policies: parameters, and a kernel that acts on the sensing of one HAV.

It allocates their memory, and lets HAVs receive broadcasts from others.
"""

import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from hav_env.compiled import canonical, entry, fixed, generic, kernel, lanes_from
from hav_env.models.memory import check_memory
from hav_env.models.protocols import Policy
from hav_env.policies.demands import wants_adjacent_memory
from hav_env.simulator.batch import Batch
from hav_env.world.arrays import NEVER, World
from hav_env.world.lanes import LANES, block_of, moving_block
from hav_env.world.sensing import neighbor_id
from hav_env.world.task import check_at_once


@generic
def act(
    policy: Any, memory: np.ndarray, world: World, agent: int, lane: int
) -> tuple[float, float]:
    """Decide the command of one HAV in this step: return speed [m/s] and steering [rad].

    A policy registers this function. A policy whose loops over units or neighbours should run
    several worlds at once registers ``act_lanes`` instead.

    Args:
        policy: Parameters; their type selects the kernel.
        memory: (N, K, W); ``memory[agent, :, lane]`` is the memory of the HAV. The code that runs
            the episode owns it; it is zero at the beginning of an episode.
        world: Block of worlds; read it only through ``hav_env.world.sensing``.
        agent: Index of the HAV.
        lane: Index of the world in the block.
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

    The simulator ignores decisions for waiting HAVs. The kernel must not change their memory.

    Args:
        policy: Parameters; their type selects the kernel.
        memory: (N, K, W); ``memory[agent]`` is the memory of the HAV in all lanes.
        world: Block of worlds; read it only through ``hav_env.world.sensing``.
        agent: Index of the HAV.
        speed: (N, W) speeds of the trucks [m/s]; the policy writes row ``agent``.
        steering: (N, W) steering angles [rad]; the policy writes row ``agent``.
    """


@act_lanes.otherwise
def act_one_by_one(policy, memory, world, agent, speed, steering):
    """Call ``act`` of a policy lane by lane."""
    for lane in range(world.lanes):
        if not world.state.waiting[agent, lane]:
            speed[agent, lane], steering[agent, lane] = act(policy, memory, world, agent, lane)


@kernel
def act_all(policy, memory, world, speed, steering, first_agent):
    """Let the HAVs of a block of worlds from ``first_agent`` on decide; arrays are (N, W).

    Values for a waiting HAV are void.
    """
    for hav in range(first_agent, speed.shape[0]):
        act_for(policy, memory, world, fixed(hav), speed, steering)


@kernel
def act_for(policy, memory, world, agent, speed, steering):
    """Let one HAV of a block of worlds decide in the lanes where it does not wait."""
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
    """Return K, the number of values that a HAV under this policy keeps between steps."""
    return 0


@functools.singledispatch
def broadcast_size(policy: Any) -> int:
    """Return B: the first B values in the memory of a HAV are broadcast to other HAVs.

    All other values are private to the HAV. HAVs decide in the order of their indices, on the state
    before the step. A HAV receives the decisions of this step from HAVs with a smaller index. From
    HAVs with a larger index it receives those of the previous step.
    """
    return 0


@kernel
def heard(memory: np.ndarray, world: World, agent: int, k: int, number: int, lane: int) -> float:
    """Return one value that neighbour ``k`` broadcasts; HAVs out of range send nothing."""
    return memory[neighbor_id(world, agent, k, lane), number, lane]


def allocate_memory(policy: Policy, num_havs: int, num_worlds: int) -> np.ndarray:
    """Return the memory (N, K, W) of a policy at the beginning of an episode; W is at least 2.

    The layout is lane-major for a policy that registers ``act_lanes``, otherwise HAV-major.
    """
    size = memory_size(policy)
    check_memory("num_worlds", num_worlds, 8 * num_havs * (size + 1) * num_worlds)
    if type(policy) in act_lanes.table and not wants_adjacent_memory(policy):
        return np.zeros((num_havs, size, num_worlds))
    # a gap, and never one lane, so the array is never contiguous: Numba would compile that type
    # anew
    return np.zeros((num_havs, max(num_worlds, 2), size + 1)).transpose(0, 2, 1)[:, :size]


def find_kernel(model_class: type) -> Callable | None:
    """Return the kernel that is registered for a policy class; None if the class is no policy."""
    return act.table.get(model_class) or act_lanes.table.get(model_class)


@functools.singledispatch
def joint_weights(policy: Any, cosine: np.ndarray) -> np.ndarray:
    """Return the jackknife weight of every joint, eq. (15).

    A policy with other coefficients than the paper's registers it.

    Args:
        policy: Policy whose coefficients are used.
        cosine: Cosine of the articulations.
    """
    return 1.0 + np.tanh(0.5 - 2.0 * cosine)


@generic
def evaded(policy: Any, memory: np.ndarray, agent: int, lane: int) -> int:
    """Return the index of the HAV that a HAV evades, from its memory; NEVER for none.

    A policy that evades one HAV at a time and remembers it registers this function.

    Args:
        policy: Parameters; their type selects the kernel.
        memory: (N, K, W) of the policy.
        agent: Index of the HAV.
        lane: Index of the world.
    """
    return NEVER


@evaded.otherwise
def evade_nobody(policy, memory, agent, lane):
    """Return NEVER: no HAV is evaded."""
    return NEVER


def decide(
    policy: Policy, memory: np.ndarray, batch: Batch, first_agent: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """Return speed [m/s] and steering [rad], each (N, W), of every HAV of a batch.

    They are zero for HAVs that wait at their goal, and for HAVs before ``first_agent``, for which
    the policy does not act.

    Args:
        policy: Registered policy.
        memory: Memory from ``allocate_memory``, kept from step to step; this call updates it.
        batch: Worlds that the HAVs sense; pass the result to ``batch.step``.
        first_agent: Index of the first HAV that the policy acts for.

    Raises:
        ValueError: If the rules let HAVs decide in turn.
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
