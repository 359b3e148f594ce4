"""This module words the titles of tables: the parts of policies, and counts."""

from collections.abc import Iterator
from typing import Any

from hav_env.policies.backup import NoBackup
from hav_env.policies.demands import guidance_of
from hav_env.policies.filtered import Filtered
from hav_env.safety import SafetyFilter


def parts_of(name: str, policy: Any, filtered: bool) -> Iterator[str]:
    """Yield the guidance, the safety filter and the backup that a policy has of its own.

    Args:
        name: Name of the policy.
        policy: The policy.
        filtered: Whether another filter replaces the policy's own.
    """
    if guidance_of(policy):
        yield f"{name}: guidance={guidance_of(policy)}"
    if not isinstance(policy, Filtered):
        return
    if isinstance(policy.safety, SafetyFilter) and not filtered:
        yield f"{name}: safety={policy.safety.against}"
    if not isinstance(policy.backup, NoBackup):
        yield f"{name}: backup={type(policy.backup).__name__.lower()}"


def count_of(number: int, noun: str) -> str:
    """Return a number with its noun: ``1 episode``, ``1,000 episodes``."""
    return f"{number:,} {noun}{'' if number == 1 else 's'}"
