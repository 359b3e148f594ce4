"""This module holds the trained policies that ship with the project, as attributes."""

import pathlib

from baselines.policies.files import SUFFIX, load_policy
from baselines.policies.network import Network

TRAINED = {
    name: pathlib.Path(__file__).parent / f"{name}{SUFFIX}"
    # ppo_beginner is what ppo_pair began with
    for name in ("ppo_single", "ppo_pair", "ppo_beginner")
}


def __getattr__(name: str) -> Network:
    """Read a policy when it is wanted: entry points name it as an attribute."""
    if name not in TRAINED:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return load_policy(TRAINED[name])


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
