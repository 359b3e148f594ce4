"""This module builds the options of a command line from the parameters of models."""

import dataclasses
from collections.abc import Callable, Mapping
from typing import Annotated, Any

import tyro

from hav_env.cli.options import parse_options


def take_option(arguments: list[str], option: str, default: str) -> tuple[str, list[str]]:
    """Take one option with its value out of the arguments.

    Raises:
        ValueError: If the option has no value.
    """
    kept, value = [], default
    remaining = iter(arguments)
    for argument in remaining:
        if argument == option:
            value = next(remaining, "--")
            if value.startswith("--"):
                raise ValueError(f"{option} needs a value behind it")
        elif argument.startswith(f"{option}="):
            value = argument.partition("=")[2]
        else:
            kept.append(argument)
    return value, kept


def take_words(arguments: list[str]) -> tuple[list[str], list[str]]:
    """Take the leading arguments that are no options."""
    count = next((k for k, word in enumerate(arguments) if word.startswith("-")), len(arguments))
    return arguments[:count], arguments[count:]


def asks_for_help(arguments: list[str]) -> bool:
    """Return whether the arguments of a command request its help."""
    return bool({"-h", "--help"} & set(arguments))


def read_options(
    usage: str,
    description: str,
    arguments: list[str],
    fields: list[tuple],
    common: Any,
    names: Mapping[str, str] | None = None,
    elsewhere: Callable[[], Mapping[str, str]] = dict,
) -> Any:
    """Parse the options of a command by tyro.

    Args:
        usage: The command, for the first line of the help.
        description: Purpose of the command, for the help.
        arguments: The remaining words of the command line.
        fields: (name, type), (name, type, default) or (name, type, default, help) of each option.
        common: Further options with their defaults, an instance of a dataclass.
        names: The names that each argument takes, for the help.
        elsewhere: Function that returns the options that other names of models have, see
            ``parse_options``.

    Returns:
        An object with an attribute for each option.

    Raises:
        ValueError: If tyro cannot parse the arguments; the message has one line.
    """
    own_names = {name for name, *_ in fields}
    for word in arguments:
        if word.startswith("--policy.") and "policy" not in own_names:
            field = word.removeprefix("--policy.").partition("=")[0]
            message = "needs a single policy, by its name alone; a trained one has no options"
            raise ValueError(f"{word} {message}. Behind one of several: NAME:{field}=VALUE")
    own = []
    for name, kind, *rest in fields:
        described = Annotated[kind, tyro.conf.arg(help=rest[1])] if len(rest) == 2 else kind
        default = rest[0] if rest else kind()
        own.append((name, described, dataclasses.field(default=default)))
    options_class = dataclasses.make_dataclass("Options", own, bases=(type(common),))
    default = options_class(**vars(common))
    told = default, names, elsewhere
    return parse_options(options_class, usage, description, arguments, *told)
