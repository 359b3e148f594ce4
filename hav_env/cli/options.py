"""This module reads the options of a command line by tyro, and reports mistakes in one line."""

import contextlib
import io
from collections.abc import Callable, Mapping
from typing import TypeVar

from hav_env.cli.errors import report_errors
from hav_env.cli.help_text import plain_help
from hav_env.cli.mistakes import explain_mistake, options_in

Options = TypeVar("Options")


class _Text(io.StringIO):
    """Text of tyro, which draws boxes if the encoding has their characters."""

    encoding = "utf-8"  # type: ignore[assignment]


def parse_options(
    options_class: type[Options],
    program: str,
    description: str,
    arguments: list[str],
    default: Options | None = None,
    names: Mapping[str, str] | None = None,
    elsewhere: Callable[[], Mapping[str, str]] = dict,
) -> Options:
    """Return the options of a command line.

    Args:
        options_class: A dataclass or NamedTuple; its fields become the options.
        program: Name of the program, for the help.
        description: Purpose of the program, for the help.
        arguments: The words of the command line.
        default: The options without any arguments.
        names: The names that each argument takes, for the help.
        elsewhere: Function that returns the options that this command has with other names of
            models, and what they belong to.

    Raises:
        ValueError: If an argument is invalid; the message has one line.
        SystemExit: After it has printed the help.
    """
    made, said, shown = _run_tyro(options_class, program, description, arguments, default)
    if made is not None:
        return made
    if shown:
        print(plain_help(shown, program, description, names or {}))
        raise SystemExit(0)

    def find_options() -> dict[str, tuple[str, str]]:
        _, _, told = _run_tyro(options_class, program, description, ["--help"], default)
        return options_in(told, names or {})

    raise ValueError(explain_mistake(said, arguments, find_options, elsewhere))


def _run_tyro(
    options_class: type[Options],
    program: str,
    description: str,
    arguments: list[str],
    default: Options | None,
) -> tuple[Options | None, str, str]:
    """Return the options of tyro, None if it exits; its error message and its help."""
    # the import of tyro is slow
    import tyro  # noqa: PLC0415

    said, shown = _Text(), _Text()
    try:
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(shown):
            made = tyro.cli(
                options_class,
                prog=program.split(" [", maxsplit=1)[0],
                description=description,
                args=arguments,
                default=tyro.MISSING_NONPROP if default is None else default,
                # parts of a model (bodies, a fleet) have options of their class, no subcommands
                config=(tyro.conf.AvoidSubcommands,),
            )
    except SystemExit as stop:
        return None, said.getvalue(), "" if stop.code else shown.getvalue()
    return made, "", ""


def run_command(
    program: str,
    description: str,
    default: Options,
    run: Callable[[Options], str],
    words: list[str] | None = None,
    interrupted: str = "the same command goes on where this one stopped",
    names: Mapping[str, str] | None = None,
) -> int:
    """Run a command and print its result, or report an error in one line.

    Args:
        program: Name of the program, for the help.
        description: Purpose of the program, for the help.
        default: The options without any arguments.
        run: Function of the options.
        words: Words of the command line, by default those of the process.
        interrupted: Message after Ctrl-C.
        names: The names that each argument takes, for the help.

    Returns:
        The exit code: 0, 2 after an error, 130 after Ctrl-C.
    """

    def whole(words: list[str]) -> None:
        print(run(parse_options(type(default), program, description, words, default, names)))

    return report_errors(whole, words, interrupted)
