"""The names of policies, for the command line and for papers to cite."""

import importlib

from baselines.avoid_jack import AvoidJack
from baselines.policy import find_kernel
from baselines.pursuit import DubinsPursuit
from baselines.random_actions import Random

POLICIES: dict[str, type] = {
    "avoid_jack": AvoidJack,
    "dubins_pursuit": DubinsPursuit,
    "random": Random,
}


def find_policy(name: str) -> type:
    """Return the class of a policy: one of ``POLICIES``, or ``module:Class`` of your own.

    Raises:
        ValueError: when there is no such policy.
    """
    if name in POLICIES:
        return POLICIES[name]
    module_name, _, class_name = name.partition(":")
    if not class_name:
        raise ValueError(f"unknown policy {name!r}; known: {', '.join(POLICIES)}, module:Class")
    try:
        found = getattr(importlib.import_module(module_name), class_name)
    except (ImportError, AttributeError) as error:
        raise ValueError(f"cannot load policy {name!r}: {error}") from None
    if find_kernel(found) is None:
        raise ValueError(f"{name!r} is not a policy: register it with act.register")
    return found
