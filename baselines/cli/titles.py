"""This module names models with those parameters that differ from the defaults."""

from collections.abc import Iterator
from typing import Any

from hav_env.models.annotations import is_model, show, values_of
from hav_env.policies.backup import NoBackup
from hav_env.policies.demands import guidance_of
from hav_env.policies.filtered import Filtered
from hav_env.safety import SafetyFilter


def name_with_changes(name: str, model: Any, usual: Any) -> str:
    """Return a name, followed by the parameters in which a model differs from the usual one."""
    changes = ", ".join(changes_of(model, usual))
    return f"{name} ({changes})" if changes else name


def changes_of(model: Any, usual: Any, prefix: str = "") -> Iterator[str]:
    """Yield ``field=value`` for each parameter in which a model differs from the usual one.

    Args:
        model: A NamedTuple or dataclass; its parts may be models too.
        usual: The model to compare with.
        prefix: Prefix of the names of the fields.
    """
    if model is usual:
        return
    if type(model) is not type(usual):
        yield f"{prefix.rstrip('.')}={type(model).__name__}"
        usual = type(model)()
    for field, value in values_of(model).items():
        other = values_of(usual)[field]
        if is_model(value) and is_model(other):
            yield from changes_of(value, other, f"{prefix}{field}.")
        elif value is not other and show(value) != show(other):
            yield f"{prefix}{field}={show(value, str)}"


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
