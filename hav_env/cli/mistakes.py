"""This module explains in one line the mistakes in options that tyro found."""

import re
from collections.abc import Callable

from hav_env.models.text import suggest

_KINDS = {"INT": "a whole number", "FLOAT": "a number", "PATH": "a file or folder", "STR": "text"}


def explain_mistake(text: str, words: list[str], find_options: Callable[[], dict[str, str]]) -> str:
    """Return a mistake in one line.

    Args:
        text: Message of tyro, in a box.
        words: Words of the command line.
        find_options: Function that returns the metavar of each option in the help.
    """
    paragraphs: list[list[str]] = [[]]
    for line in text.splitlines():
        inside = line.strip("│").strip()
        if line.startswith("│") and inside and set(inside) != {"─"}:
            paragraphs[-1].append(inside)
        else:
            paragraphs.append([])
    told = [" ".join(part) for part in paragraphs if part] or ["cannot read the options"]
    unknown = re.match(r"Unrecognized options?: ([^\s,]+)", told[0])
    if unknown:
        return f"unknown option {unknown[1]}{suggest(unknown[1], find_options())}"
    bare = re.match(r"Missing value for argument '([^']+)'", told[0])
    if bare:
        return f"{bare[1]} needs a value behind it: {_kind(find_options().get(bare[1], ''))}"
    missing = re.match(r"Missing from [^:]*: \S+ (.*?)(?: \(required\))?$", told[0])
    if missing:
        return f"an argument is missing: {missing[1]}"
    wrong = re.match(r"Error parsing ([^\s:]+):|invalid choice .* for argument '(\S+)'", told[0])
    option = (wrong[1] or wrong[2]) if wrong else ""
    if option in words[:-1] and (metavar := find_options().get(option)):
        value = words[words.index(option) + 1]
        return f"{option} is {value!r}, but must be {_kind(metavar)}"
    return told[0]


def _kind(metavar: str) -> str:
    """Return the type of an option in words, from its metavar in the help."""
    wanted = metavar.replace("{None}|", "").replace("{None,", "{")
    return _KINDS.get(wanted) or wanted.strip("{}").replace(",", " or ")
