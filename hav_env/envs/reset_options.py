"""This module reads the options of a reset, and warns of unknown ones."""

import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np

from hav_env.maths.random_numbers import Seed
from hav_env.models.annotations import show
from hav_env.models.checks import check_value


def warn_of_unknown(options: dict[str, Any], known: tuple[str, ...]) -> None:
    """Warn of unknown options of a reset; the reset ignores them."""
    for name in sorted(set(options) - set(known), key=str):
        message = f"reset ignores the option {name!r}; known: {', '.join(known)}"
        warnings.warn(message, stacklevel=4)  # the caller of the environment's reset


def read_options(options: Any) -> dict[str, Any]:
    """Return the options of a reset that are not None.

    Raises:
        TypeError: If the options are not a dictionary, or a key is not a string.
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
    """Return the number of the episode that a reset selects.

    Raises:
        ValueError, TypeError: If the value is invalid; the message names it and the rule.
    """
    check_value("episode", Seed, episode)
    return int(episode)


def check_left_out(name: str, chosen: np.ndarray, begun: np.ndarray) -> None:
    """Check that every world that a reset leaves out has an episode.

    Args:
        name: Name of the mask, for the message.
        chosen: (W,) bool, the mask: worlds to reset.
        begun: (W,) bool, worlds that have an episode.

    Raises:
        ValueError: If a world without an episode is left out.
    """
    missing = np.flatnonzero(~(chosen | begun)).tolist()
    if missing:
        raise ValueError(
            f"{name} is false for world {missing[0]}, but must be true for all worlds without an"
            " episode: the first reset begins all worlds"
        )
