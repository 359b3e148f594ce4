"""This module states the requirements of policies: rules, kinematics and guidance of an episode."""

import functools
from typing import Any

from hav_env.models.protocols import Vehicle
from hav_env.world.task import Task


@functools.singledispatch
def bind(policy: Any, task: Task, vehicle: Vehicle) -> Any:
    """Return a policy for the rules and the kinematics of an episode.

    Policies that hold both register this function. Other policies stay the same.
    """
    return policy


@functools.singledispatch
def guidance_of(policy: Any) -> str:
    """Return the name of the guidance that a policy needs; "" if it needs none.

    Policies that were trained with guidance register this function.
    """
    return ""


@functools.singledispatch
def wants_adjacent_memory(policy: Any) -> bool:
    """Return whether the memory of a HAV must be adjacent although the policy acts in all lanes."""
    return False


def check_guided(policy: Any, guidance: Any) -> None:
    """Check that a policy has the guidance that it needs.

    Args:
        policy: a policy.
        guidance: guidance of the episodes.

    Raises:
        ValueError: If the guidance differs; the message names both.
    """
    needed, found = guidance_of(policy), type(guidance).__name__.lower()
    if needed not in ("", found):
        raise ValueError(f"guidance is {found}, but must be {needed}, which the policy reads")
