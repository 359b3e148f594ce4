"""The names of policies and scenarios, for the command line and for papers to cite."""

import importlib
import pathlib

from baselines.avoid_jack import AvoidJack
from baselines.policy import find_kernel
from baselines.pursuit import DubinsPursuit
from baselines.random_actions import Random
from hav_env import Explicit, RandomPoses, load_explicit

POLICIES: dict[str, type] = {
    "avoid_jack": AvoidJack,
    "dubins_pursuit": DubinsPursuit,
    "random": Random,
}

SCENARIOS: dict[str, RandomPoses] = {
    "paper-single": RandomPoses(num_havs=1),
    "paper-pair": RandomPoses(num_havs=2),
    "swarm-10": RandomPoses(num_havs=10),
    "swarm-50": RandomPoses(num_havs=50),
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


def find_scenario(name: str) -> RandomPoses | Explicit:
    """Return a scenario: one of ``SCENARIOS``, or the one in a JSON file.

    Raises:
        ValueError: when there is no such scenario or the file is broken.
    """
    if name in SCENARIOS:
        return SCENARIOS[name]
    if not name.endswith(".json"):
        raise ValueError(f"unknown scenario {name!r}; known: {', '.join(SCENARIOS)}, FILE.json")
    if not pathlib.Path(name).is_file():
        raise ValueError(f"there is no scenario file {name}")
    return load_explicit(name)
