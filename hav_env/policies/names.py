"""This module makes policies by name: "avoid_jack", a file, or your own ``module:Class``."""

import os
from typing import Any

from hav_env.models.names import Registry
from hav_env.models.protocols import Policy
from hav_env.policies.interface import find_kernel

POLICIES = Registry(
    "policy",
    "hav_env.policies",
    lambda made: find_kernel(made) is not None,
    "register it with act.register",
)


def make_policy(policy: Policy | str | os.PathLike[str], **parameters: Any) -> Policy:
    """Return a policy: ``make_policy("avoid_jack", close_factor=3.0)``.

    Args:
        policy: Name, path of a policy file, ``module:Class``, or a policy.
        parameters: Fields of the policy to set; the others keep their defaults.

    Raises:
        TypeError: If the policy has no such parameter, or one without a default is missing.
        ValueError: If there is no such policy.
    """
    return POLICIES.make(policy, **parameters)
