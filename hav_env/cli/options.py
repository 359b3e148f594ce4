"""This module reads options from a command line by tyro, and reports mistakes in one line."""

import contextlib
import io
from collections.abc import Callable
from typing import TypeVar

import tyro

from hav_env.cli.errors import report_errors

Options = TypeVar("Options")


def parse_options(
    options_class: type[Options],
    program: str,
    description: str,
    arguments: list[str],
    default: Options | None = None,
) -> Options:
    """Return the options that a command line gives.

    Args:
        options_class: a dataclass or NamedTuple; its fields become the options.
        program: name of the program, for the help.
        description: purpose of the program, for the help.
        arguments: the words of the command line.
        default: the options without any arguments.

    Raises:
        ValueError: when the arguments are wrong, saying how in one line.
        SystemExit: after tyro has printed the help.
    """
    complaint = io.StringIO()
    try:
        with contextlib.redirect_stderr(complaint):
            return tyro.cli(
                options_class,
                prog=program,
                description=description,
                args=arguments,
                default=tyro.MISSING_NONPROP if default is None else default,
                # the fields of a part of a model (bodies, a fleet) are options of the kind at hand
                config=(tyro.conf.AvoidSubcommands,),
            )
    except SystemExit as stop:
        if not stop.code:
            raise
        raise ValueError(_one_line(complaint.getvalue())) from None


def run_command(
    program: str,
    description: str,
    default: Options,
    run: Callable[[Options], str],
    words: list[str] | None = None,
    interrupted: str = "the same command goes on where this one stopped",
) -> int:
    """Run a command and print its result, or report an error in one line.

    Args:
        program: name of the program, for the help.
        description: purpose of the program, for the help.
        default: the options without any arguments.
        run: takes the options.
        words: of the command line, by default the process's.
        interrupted: message after Ctrl-C.

    Returns:
        The exit code: 0, 2 when something is wrong, 130 when interrupted.
    """

    def whole(words: list[str]) -> None:
        print(run(parse_options(type(default), program, description, words, default)))

    return report_errors(whole, words, interrupted)


def _one_line(text: str) -> str:
    """Return what tyro says in its box, below the title and above the next rule.

    The title stands in the upper edge, or on a line of its own where boxes cannot be drawn.
    """
    sections: list[list[str]] = [[]]
    for line in text.splitlines():
        words = line.strip("│╭╮╰╯─-| ")
        if words and not line.startswith("╭"):
            sections[-1].append(words)
        elif not words and line.strip():
            sections.append([])
    told = [" ".join(section) for section in sections if section]
    told = told[0 if text.lstrip().startswith("╭") else 1 :]
    return told[0] if told else "cannot read the options"
