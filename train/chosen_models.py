"""The models that a training names: on its command line, and in the folder of its run."""

import dataclasses
from typing import Any, TypeVar

from baselines.cli.options import take_option
from hav_env.models.names import REGISTRIES

Arguments = TypeVar("Arguments")
CHOSEN = ("vehicle", "reward")
"""The arguments of a training that hold a model of any class, by the kinds of the models."""
OPTIONS = " ".join(f"[--{kind} NAME]" for kind in CHOSEN)


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


def describe_model(model: Any) -> dict[str, Any]:
    """Return the class of a model and its parameters as JSON knows them."""
    model_class = type(model)
    return {"class": f"{model_class.__module__}:{model_class.__qualname__}", **model._asdict()}


def read_model(kind: str, told: dict[str, Any]) -> Any:
    """Return the model that ``describe_model`` has described.

    Raises:
        ValueError: when there is no such class.
        TypeError: when its parameters are others.
    """
    parameters = {name: value for name, value in told.items() if name != "class"}
    found = REGISTRIES[kind].find(told["class"])
    if set(found._fields) != set(parameters):
        raise TypeError(f"{kind} is {told!r}, but must have the fields {found._fields}")
    return REGISTRIES[kind].make(found, **parameters)
