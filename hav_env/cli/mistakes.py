"""This module explains in one line the mistakes in options that tyro found."""

import itertools
import re
from collections.abc import Callable, Mapping

from hav_env.cli.help_text import sections_of
from hav_env.models.text import suggest

_KINDS = {"INT": "a whole number", "FLOAT": "a number", "PATH": "a file or folder", "STR": "text"}
_LEAST_LETTERS = 3  # of a word to search for in help
_MOST_WITH_A_WORD = 2  # options with a word that is no common one


def options_in(shown: str, names: Mapping[str, str]) -> dict[str, tuple[str, str]]:
    """Return the metavar and the help of each option.

    Args:
        shown: Help of tyro, in boxes.
        names: The names that each argument takes; some of the arguments are options.
    """
    found = {words.split()[0]: ("", "") for words in names if words.startswith("--")}
    for _, _, items in sections_of(shown):
        for words, told in items:
            option, _, rest = words.partition(" ")
            metavar = rest.rpartition(" ")[2] if option[-1] == "," else rest
            found[option.rstrip(",")] = ("" if metavar[:2] == "--" else metavar, told)
    return found


def explain_mistake(
    text: str,
    words: list[str],
    find_options: Callable[[], dict[str, tuple[str, str]]],
    elsewhere: Callable[[], Mapping[str, str]],
) -> str:
    """Return a mistake in one line.

    Args:
        text: Message of tyro, in a box.
        words: Words of the command line.
        find_options: Function that returns the metavar and the help of each option.
        elsewhere: Function that returns the options that the command has with other names of
            models, and what they belong to.
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
        option = unknown[1].partition("=")[0]
        if option[0] != "-":
            return f"unexpected {option!r}: options begin with --, and names stand before them"
        return f"unknown option {option}{_right_option(option, find_options(), elsewhere)}"
    bare = re.match(r"Missing value for argument '([^']+)'", told[0])
    if bare:
        return f"{bare[1]} needs a value behind it: {_kind(find_options(), bare[1])}"
    missing = re.match(r"Missing from [^:]*: \S+ (.*?)(?: \(required\))?$", told[0])
    if missing:
        return f"an argument is missing: {missing[1]}"
    wrong = re.match(r"Error parsing ([^\s:]+):|invalid choice .* for argument '(\S+)'", told[0])
    option = (wrong[1] or wrong[2]) if wrong else ""
    if option and (kind := _kind(find_options(), option)):
        for word, after in itertools.pairwise([*words, ""]):
            name, equals, value = word.partition("=")
            if name == option:
                return f"{option} is {value if equals else after!r}, but must be {kind}"
    return told[0]


def _right_option(
    wrong: str,
    options: Mapping[str, tuple[str, str]],
    elsewhere: Callable[[], Mapping[str, str]],
) -> str:
    """Return what to write in place of an unknown option, or nothing.

    It is the same option of another model; the first option with that part; the option with the
    nearest name; the first one with a part that begins so; or one whose values or help have that
    word, which few of them have.
    """
    owner = elsewhere().get(wrong)
    if owner:
        return f": it belongs to {owner}"
    word = wrong.lstrip("-").casefold()
    parts = {option: f"{re.sub('[.-]+', '-', option)}-" for option in options}
    found = [option for option in options if f"-{word}-" in parts[option]]
    near = suggest(word, [option.lstrip("-") for option in options], lambda name: f"--{name}")
    if len(word) >= _LEAST_LETTERS and not near:
        found += [option for option in options if f"-{word}" in parts[option]]
        texts = {option: _words_in(" ".join(told)) for option, told in options.items()}
        saying = [option for option in options if word.rstrip("s") in texts[option]]
        found += saying if len(saying) <= _MOST_WITH_A_WORD else []
    return f" (did you mean {found[0]!r}?)" if found else near


def _words_in(text: str) -> set[str]:
    """Return the words of a text, without the s of a plural."""
    return {word.rstrip("s") for word in re.findall(r"\w+", text.casefold())}


def _kind(options: Mapping[str, tuple[str, str]], option: str) -> str:
    """Return the type of an option in words, from its metavar in the help."""
    metavar, _ = options.get(option, ("", ""))
    wanted = metavar.replace("{None}|", "").replace("{None,", "{")
    return _KINDS.get(wanted) or wanted.strip("{}").replace(",", " or ")
