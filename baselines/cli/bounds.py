"""This module checks whole numbers of a command line, such as episodes and threads."""

from typing import Annotated, Any

from hav_env.compiled import default_threads
from hav_env.models.annotations import Range
from hav_env.models.checks import check_value

MOST_ROWS = 10**8  # of a table: a row is an episode of a HAV
MOST_THREADS = 1_024


def check_whole(name: str, value: Any, least: int, most: int, more: str = "") -> None:
    """Check a whole number.

    Args:
        name: Name of the argument.
        value: Value from the user.
        least: The smallest valid number.
        most: The largest valid number.
        more: Text to append to the bounds.

    Raises:
        TypeError: If the value is no whole number.
        ValueError: If the value is out of bounds.
    """
    said = f"at least {least} and at most {most}{more}"
    check_value(name, Annotated[int, Range(least, most, said=said)], value)


def check_threads(threads: int | None) -> None:
    """Check a number of threads; None is ``HAV_THREADS`` or all cores.

    Raises:
        TypeError, ValueError: If the number is invalid.
    """
    count = default_threads() if threads is None else threads
    check_whole("threads", count, 1, MOST_THREADS)


def check_episodes(name: str, count: int, num_havs: int) -> None:
    """Check a number of episodes for one table.

    Raises:
        TypeError, ValueError: If the number is invalid.
    """
    each = f" with {num_havs} HAVs each" if num_havs > 1 else ""
    check_whole(name, count, 1, MOST_ROWS // num_havs, each)
