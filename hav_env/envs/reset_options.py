"""This module reads the options of a reset, and warns of unknown ones."""

import warnings
from collections.abc import Mapping
from typing import Any

from hav_env.maths.random_numbers import Seed
from hav_env.models.annotations import show
from hav_env.models.checks import check_value


def warn_of_unknown(options: dict[str, Any], known: tuple[str, ...]) -> None:
    """Warn of options of a reset that are not known; they are ignored."""
    for name in sorted(set(options) - set(known), key=str):
        told = f"reset ignores the option {name!r}; known: {', '.join(known)}"
        warnings.warn(told, stacklevel=4)  # who called the environment's reset


def read_options(options: Any) -> dict[str, Any]:
    """Return the options of a reset that have a value.

    Raises:
        TypeError: when they are no dictionary, or a key is no string.
    """
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise TypeError(f"options is {show(options)}, but must be a dictionary or None")
    for name in options:
        if not isinstance(name, str):
            raise TypeError(f"options has the key {show(name)}, but all keys must be strings")
    return {name: value for name, value in options.items() if value is not None}


def read_episode(episode: Any) -> int:
    """Return the number of an episode that a reset asks for.

    Raises:
        ValueError, TypeError: naming the value and what is allowed.
    """
    check_value("episode", Seed, episode)
    return int(episode)
