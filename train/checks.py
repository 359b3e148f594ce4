"""This module checks the arguments of trainings, and makes the models that they name."""

import dataclasses
from collections.abc import Mapping
from typing import Annotated, Any, TypeVar

from baselines.cli.options import take_option
from baselines.policies.network_checks import WIDEST_LAYER
from hav_env.maths.random_numbers import Seed
from hav_env.mdp.reward import check_reward
from hav_env.models.annotations import Range
from hav_env.models.checks import check_fields
from hav_env.models.names import REGISTRIES
from hav_env.models.quantities import (
    ABOVE_ZERO,
    AboveZero,
    Factor,
    Skipped,
    Spread,
    Steps,
    Threads,
    Worlds,
)
from hav_env.models.text import suggest
from hav_env.vehicles import check_vehicle

Decisions = Annotated[int, Range(1, 10**12)]
# PPO divides advantages by their standard deviation, which needs at least two of them
Several = Annotated[int, Range(2, 10**8)]
Epochs = Annotated[int, Range(1, 10**4)]
Episodes = Annotated[int, Range(1, 10**7)]
Held = Annotated[int, Range(0, 10**6)]  # actions; 0 for none
Runners = Annotated[int, Range(0, 1_024)]
ValueDecisions = Annotated[int, Range(0, 10**12)]
BeginSpeed = Annotated[float, Range(0.0, 1.0)]
Discount = Annotated[float, Range(ABOVE_ZERO, 1.0, said="in (0, 1]")]
Layers = tuple[Annotated[int, Range(1, WIDEST_LAYER)], ...]  # units of each
_MOST_HIDDEN_LAYERS = 16

Arguments = TypeVar("Arguments")
CHOSEN = ("vehicle", "reward")
"""The arguments of a training that hold a model of any class; the names are kinds of models."""
OPTIONS = " ".join(f"[--{kind} NAME]" for kind in CHOSEN)

__all__ = [
    "CHOSEN",
    "OPTIONS",
    "AboveZero",
    "Factor",
    "Seed",
    "Skipped",
    "Spread",
    "Steps",
    "Threads",
    "Worlds",
    "check_arguments",
    "check_layers",
    "check_value_decisions",
    "names_for_help",
    "take_models",
    "take_preset",
]


def check_arguments(arguments: Any) -> None:
    """Check the arguments of a training before its environments and its learner exist.

    Args:
        arguments: The dataclass of the arguments of ``train.ppo`` or ``train.rllib``.

    Raises:
        TypeError: If an argument has another type.
        ValueError: If a value is out of range; the message names the argument, value and rule.
    """
    check_fields("", arguments)
    check_vehicle(arguments.vehicle)
    check_reward(arguments.reward)
    check_layers("layers", arguments.layers)


def check_layers(name: str, units: tuple[int, ...]) -> None:
    """Check the number of layers that an argument names the units of.

    Raises:
        ValueError: If there are none or too many; the message names the argument.
    """
    if not 1 <= len(units) <= _MOST_HIDDEN_LAYERS:
        rule = f"must name the units of 1 to {_MOST_HIDDEN_LAYERS} layers"
        raise ValueError(f"{name} is {units}, but {rule}")


def check_value_decisions(value_decisions: int, decisions: int) -> None:
    """Check that the policy learns too, not only its value network.

    Raises:
        ValueError: If the value network learns alone until the end.
    """
    if value_decisions >= decisions:
        rule = f"must be less than decisions, {decisions}: the policy would not learn"
        raise ValueError(f"value_decisions is {value_decisions}, but {rule}")


def take_preset(words: list[str], presets: Mapping[str, Arguments]) -> tuple[str, list[str]]:
    """Take ``--preset NAME`` out of a command line; the default is ``single``.

    Raises:
        ValueError: If there is no such preset.
    """
    name, words = take_option(words, "--preset", "single")
    if name not in presets:
        known = ", ".join(presets)
        raise ValueError(f"unknown preset {name!r}{suggest(name, presets)}; known: {known}")
    return name, words


def names_for_help(presets: Mapping[str, str]) -> dict[str, str]:
    """Return the names that the options of a training take, for its help.

    Args:
        presets: The meaning of each preset.
    """
    meanings = [f"{name}: {told}" for name, told in presets.items()]
    kinds = {f"--{kind} NAME": f"{REGISTRIES[kind].known()}." for kind in ("scenario", *CHOSEN)}
    return {
        "--preset NAME": f"{'; '.join(meanings)}. A preset sets the defaults below.",
        **kinds,
        "hav-env list": "Shows what each name stands for.",
    }


def take_models(words: list[str], usual: Arguments) -> tuple[Arguments, list[str]]:
    """Take ``--vehicle NAME`` and ``--reward NAME`` out of a command line.

    Args:
        words: Words of the command line.
        usual: A dataclass of the arguments without any options.

    Returns:
        The arguments with the named models, whose parameters become options; the other words.

    Raises:
        ValueError: If there is no such model.
        TypeError: If a model has a parameter without a default.
    """
    chosen = {}
    for kind in CHOSEN:
        name, left = take_option(words, f"--{kind}", "")
        if len(left) < len(words):
            chosen[kind] = REGISTRIES[kind].make(name)
        words = left
    return dataclasses.replace(usual, **chosen), words  # type: ignore[type-var]
