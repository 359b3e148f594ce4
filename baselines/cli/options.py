"""This module builds the options of a command line from the parameters of models."""

import dataclasses
from typing import Annotated, Any

import tyro

from hav_env.cli.options import parse_options


def take_option(arguments: list[str], option: str, default: str) -> tuple[str, list[str]]:
    """Take one option with its value out of the arguments."""
    kept, value = [], default
    remaining = iter(arguments)
    for argument in remaining:
        if argument == option:
            value = next(remaining, "")
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
    """Tell whether the arguments of a command ask for its help."""
    return bool({"-h", "--help"} & set(arguments))


def read_options(
    usage: str, description: str, arguments: list[str], fields: list[tuple], common: Any
) -> Any:
    """Let tyro build the options of a command.

    Args:
        usage: the command, with which the help begins.
        description: the purpose of the command, for the help.
        arguments: the command line without what was taken from it.
        fields: (name, type), (name, type, default) or (name, type, default, help) of each option.
        common: further options with their defaults, an instance of a dataclass.

    Returns:
        An object with an attribute for each option.

    Raises:
        ValueError: when tyro cannot read the arguments; its complaint in one line.
    """
    own = []
    for name, kind, *rest in fields:
        described = Annotated[kind, tyro.conf.arg(help=rest[1])] if len(rest) == 2 else kind
        default = rest[0] if rest else kind()
        own.append((name, described, dataclasses.field(default=default)))
    options_class = dataclasses.make_dataclass("Options", own, bases=(type(common),))
    default = options_class(**vars(common))
    return parse_options(options_class, usage, description, arguments, default)
