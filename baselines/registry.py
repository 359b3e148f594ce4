"""The names of policies, for the command line and for papers to cite."""

import functools
import importlib
import pathlib
from collections.abc import Callable
from typing import Any

from baselines.avoid_jack import AvoidJack
from baselines.network import Network
from baselines.policy import find_kernel
from baselines.policy_files import SUFFIX, load_policy
from baselines.pursuit import DubinsPursuit
from baselines.random_actions import Random
from baselines.reserve import Reserve

TRAINED = {
    name: pathlib.Path(__file__).parent / "policies" / f"{name}{SUFFIX}"
    # ppo_beginner is what ppo_pair began with
    for name in ("ppo_single", "ppo_pair", "ppo_beginner")
}
POLICIES: dict[str, Callable[[], Any]] = {
    "avoid_jack": AvoidJack,
    "dubins_pursuit": DubinsPursuit,
    "random": Random,
    "reserve": Reserve,
    **{name: functools.partial(load_policy, path) for name, path in TRAINED.items()},
}
KNOWN = f"{', '.join(POLICIES)}, FILE{SUFFIX}, module:Class"


def find_policy(name: str) -> Callable[[], Any]:
    """Return what makes a policy: its class, or for a trained one what reads its file.

    Args:
        name: one of ``POLICIES``, the path of a policy file, or ``module:Class`` of your own.

    Raises:
        ValueError: when there is no such policy.
    """
    if name in POLICIES:
        return POLICIES[name]
    path = policy_file(name)
    if path is not None:
        return functools.partial(load_policy, path)
    module_name, _, class_name = name.partition(":")
    if not class_name:
        raise ValueError(f"unknown policy {name!r}; known: {KNOWN}")
    try:
        found = getattr(importlib.import_module(module_name), class_name)
    except (ImportError, AttributeError) as error:
        raise ValueError(f"cannot load policy {name!r}: {error}") from None
    except Exception as error:  # the module may raise anything, and "..x" is no name of a module
        raise ValueError(f"cannot load policy {name!r}: {error!r}") from error
    if not isinstance(found, type) or find_kernel(found) is None:
        raise ValueError(f"{name!r} is not a policy: register it with act.register")
    return found


def find_trained(name: str) -> Network:
    """Return a trained policy by its name or file. No code of whoever made it runs.

    Raises:
        ValueError: when there is none, or its file is broken.
    """
    path = policy_file(name)
    if path is None:
        known = ", ".join([*TRAINED, f"FILE{SUFFIX}"])
        raise ValueError(f"policy is {name!r}, but must be a trained one: {known}")
    return load_policy(path)


def policy_file(name: str) -> pathlib.Path | None:
    """Return the file of a trained policy, by its name or path; None for other policies."""
    return TRAINED.get(name) or (pathlib.Path(name) if name.endswith(SUFFIX) else None)
