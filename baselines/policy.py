"""What a policy is: a NamedTuple of parameters, and a kernel that acts on what one HAV senses."""

import functools

import numpy as np

from hav_env import Batch
from hav_env.compiled import canonical, entry, generic, world_kernel
from hav_env.world import world_at


@generic
def act(policy, memory, world, agent):
    """Decide what one HAV does in this step: return speed [m/s] and steering [rad].

    Args:
        policy: the parameters; their type selects the kernel.
        memory: (N, K), row ``agent`` is the HAV's own. It belongs to whoever runs the episode and
            is zero at its beginning.
        world, agent: to be read through ``hav_env.sensing`` only.
    """


@world_kernel
def act_all(policy, memory, world, speed, steering):
    """Let every HAV of a world decide, (N,) each; one that waits at its goal is not asked."""
    for agent in range(speed.shape[0]):
        speed[agent], steering[agent] = 0.0, 0.0
        if not world.state.waiting[agent]:
            speed[agent], steering[agent] = act(policy, memory, world, agent)


@entry
def act_worlds(first, last, policy, memory, worlds, speed, steering):
    """Let every HAV of a range of worlds decide."""
    for w in range(first, last):
        act_all(policy, memory[:, :, w], world_at(worlds, w), speed[:, w], steering[:, w])


def require_at_least(policy, least: float, fields: tuple[str, ...]) -> None:
    """Raise ValueError unless the fields of a policy are at least ``least``."""
    for field in fields:
        if getattr(policy, field) < least:
            value = getattr(policy, field)
            raise ValueError(f"policy {field} is {value}, but must be at least {least:g}")


@functools.singledispatch
def memory_size(policy) -> int:
    """Return K, how many numbers a HAV under this policy keeps between steps."""
    return 0


def allocate_memory(policy, num_havs: int, num_worlds: int) -> np.ndarray:
    """Return the memory (N, K, W) of a policy at the beginning of an episode."""
    return np.zeros((num_havs, memory_size(policy), num_worlds))


def check_policy(policy, scenario) -> None:
    """Check a policy before it is used in a scenario.

    Raises:
        TypeError: when its type has no kernel.
        ValueError: when a parameter is not a finite number, or not allowed by its policy.
    """
    if type(policy) not in act.table:
        raise TypeError(f"{policy!r} is not a policy: register its type with act")
    for field, value in policy._asdict().items():
        if not np.isfinite(value).all():
            raise ValueError(f"policy {field} is {value}, but must be finite")
    check_parameters(policy, scenario)


@functools.singledispatch
def check_parameters(policy, scenario) -> None:
    """Check what one kind of policy demands of its parameters and the scenario's limits.

    Registered by policies that demand more than finite numbers; raises ValueError.
    """


def decide(policy, memory: np.ndarray, batch: Batch) -> tuple[np.ndarray, np.ndarray]:
    """Return speed [m/s] and steering [rad], each (N, W), of every HAV of a batch.

    HAVs that wait at their goal are not asked: theirs are zero.

    Args:
        policy: a registered policy.
        memory: from ``allocate_memory``, kept from step to step, written to.
        batch: what is sensed; pass the result to ``batch.step``.
    """
    speed, steering = np.zeros((2, *batch.worlds.state.x.shape))
    act_worlds(
        batch.num_worlds,
        canonical(policy),
        memory,
        batch.worlds,
        speed,
        steering,
        threads=batch.threads,
    )
    return speed, steering
