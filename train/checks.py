"""This module checks the arguments of trainings, and the models that they name."""

import dataclasses
from typing import Annotated, Any, TypeVar

from baselines.cli.options import take_option
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
from hav_env.vehicles import check_vehicle

Decisions = Annotated[int, Range(1, 10**12)]
# of a single number there is no deviation, by which advantages are divided
Several = Annotated[int, Range(2, 10**8)]
Epochs = Annotated[int, Range(1, 10**4)]
Episodes = Annotated[int, Range(1, 10**7)]
Held = Annotated[int, Range(0, 10**6)]  # actions; 0 for none
Runners = Annotated[int, Range(0, 1_024)]
Discount = Annotated[float, Range(ABOVE_ZERO, 1.0, said="in (0, 1]")]
Layers = tuple[Annotated[int, Range(1, 10_000)], ...]  # units of each
_MOST_HIDDEN_LAYERS = 16

Arguments = TypeVar("Arguments")
CHOSEN = ("vehicle", "reward")
"""The arguments of a training that hold a model of any class, by the kinds of the models."""
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
    "take_models",
]


def check_arguments(arguments: Any) -> None:
    """Check what neither an environment nor a learner would name.

    Args:
        arguments: a dataclass of some of the arguments of ``train.ppo`` and ``train.rllib``.

    Raises:
        TypeError: when an argument is of another kind.
        ValueError: naming the argument, its value and what is allowed.
    """
    check_fields("", arguments)
    check_vehicle(arguments.vehicle)
    check_reward(arguments.reward)
    if not 1 <= len(arguments.layers) <= _MOST_HIDDEN_LAYERS:
        told = f"must name the units of 1 to {_MOST_HIDDEN_LAYERS} layers"
        raise ValueError(f"layers is {arguments.layers}, but {told}")


def take_models(words: list[str], usual: Arguments) -> tuple[Arguments, list[str]]:
    """Take ``--vehicle NAME`` and ``--reward NAME`` out of a command line.

    Args:
        words: of the command line.
        usual: a dataclass of the arguments without any options.

    Returns:
        The arguments with the models that were named, whose parameters are options from then on;
        the words that are left.

    Raises:
        ValueError: when there is no such model.
        TypeError: when a model has a parameter without a default.
    """
    chosen = {}
    for kind in CHOSEN:
        name, left = take_option(words, f"--{kind}", "")
        if len(left) < len(words):
            chosen[kind] = REGISTRIES[kind].make(name)
        words = left
    return dataclasses.replace(usual, **chosen), words  # type: ignore[type-var]
