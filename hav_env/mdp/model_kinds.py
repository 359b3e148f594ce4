"""This module finds a model of any kind by its name: a policy, scenario, vehicle or reward."""

import os
from typing import Any

# each of these adds its kinds of models to the registries
import hav_env.mdp.rewards
import hav_env.policies.names
import hav_env.scenarios.presets
import hav_env.simulator.guiding  # noqa: F401
from hav_env.models.names import REGISTRIES


def find_model(kind: str, name: str | os.PathLike[str]) -> Any:
    """Return the model, or the class of models, that has a name.

    Args:
        kind: "policy", "scenario", "vehicle" or "reward".
        name: of the model, ``module:Class``, or the path of a file.

    Raises:
        TypeError: when ``name`` is neither text nor a path.
        ValueError: when there is no such kind or model, or the model cannot be loaded.
    """
    if kind not in REGISTRIES:
        raise ValueError(f"kind is {kind!r}, but must be {' or '.join(map(repr, REGISTRIES))}")
    return REGISTRIES[kind].find(name)
