"""This module holds the trained policies that ship with the project, as attributes."""

import pathlib
from typing import cast

from baselines.policies.files import SUFFIX, load_policy, load_trained
from baselines.policies.network import Network
from baselines.policies.reserve import Reserve
from hav_env.models.text import suggest
from hav_env.policies.filtered import Filtered

TRAINED = {
    name: pathlib.Path(__file__).parent / f"{name}{SUFFIX}"
    # the training of ppo_pair began with ppo_beginner
    for name in ("ppo_single", "ppo_guided", "ppo_pair", "ppo_swarm", "ppo_beginner")
}

# read at their first use
ppo_single: Network
"""Network that PPO trained for single HAVs."""
ppo_guided: Filtered
"""Network that PPO trained for single HAVs on feasible routes, with its jackknife filter."""
ppo_reserve: Filtered
"""The policy ppo_guided with Reserve as its backup: for any number of HAVs, without jackknifes and
collisions."""
ppo_pair: Network
"""Network that PPO trained for pairs."""
ppo_swarm: Filtered
"""Network that IPPO trained for swarms of five, which pools any number of neighbours, with its
jackknife filter and Reserve as its backup."""
ppo_beginner: Network
"""Network from which the training of ppo_pair began."""


def __getattr__(name: str) -> Network | Filtered:
    """Read a policy at its first use: entry points name it as an attribute."""
    if name == "ppo_reserve":
        guided = cast(Filtered, load_policy(TRAINED["ppo_guided"]))
        return guided._replace(backup=Reserve())
    if name not in TRAINED:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return load_policy(TRAINED[name])


def find_trained(name: str, argument: str = "policy", others: tuple[str, ...] = ()) -> Network:
    """Return a trained policy by its name or file, without its filter.

    Reading a file runs no code of its author.

    Args:
        name: Name of a trained policy, or the path of its file.
        argument: The argument that has this name, for the message.
        others: Other values of the argument, for the message.

    Raises:
        ValueError: If there is no such policy, or its file is broken.
    """
    path = policy_file(name)
    if path is None:
        names = [*others, *TRAINED]
        known = ", ".join([*names, f"FILE{SUFFIX}"])
        rule = f"must be one of {known}{suggest(name, names)}"
        raise ValueError(f"{argument} is {name!r}, but {rule}")
    return load_trained(path).policy


def policy_file(name: str) -> pathlib.Path | None:
    """Return the file of a trained policy, by its name or path; None for other policies."""
    return TRAINED.get(name) or (pathlib.Path(name) if name.endswith(SUFFIX) else None)
