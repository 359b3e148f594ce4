"""This module is the menu ``hav-env``: it finds commands among entry points, and runs one.

A package adds a command in its pyproject.toml::

    [project.entry-points."hav_env.commands"]
    drive = "my_package.my_module:drive"

``drive`` takes the words after its name, reports its errors and returns the exit code. The menu
shows the first sentence of its docstring.
"""

import importlib.metadata
import os
import sys
from textwrap import shorten

from hav_env.cli.errors import report_errors
from hav_env.cli.meanings import meaning_of
from hav_env.models.extras import name_extra
from hav_env.models.text import suggest

COMMANDS_GROUP = "hav_env.commands"
_MOST_CHARACTERS = 67  # of a meaning: a line fits a terminal
_ORDER = ("list", "evaluate", "watch", "play", "reproduce", "survey", "train", "compare")
_HELP = ("-h", "--help", "help")
_MENU_HEAD = """Trucks with trailers: policies, their evaluation and their training.

usage: hav-env COMMAND [OPTIONS]      python -m hav_env is the same
"""
_MENU_END = """
hav-env COMMAND --help    shows the options of a command
hav-env list              shows all names of policies, scenarios and vehicles
hav-env --version         shows the version
"""


def run_menu(words: list[str] | None = None) -> int:
    """Run a command of the menu, report an error in one line, and return the exit code.

    Args:
        words: Words of the command line, by default those of the process.
    """
    if words is None:
        _search_current_folder()
        words = sys.argv[1:]
    code = 0

    def dispatch(words: list[str]) -> None:
        nonlocal code
        if not words or words[0] in _HELP:
            print(show_menu())
        elif words[0] == "--version":
            print(f"hav_env {_version()}")
        else:
            code = _load(words[0])(words[1:]) or 0

    return report_errors(dispatch, words) or code


def show_menu() -> str:
    """Return the menu: a line for each command."""
    meanings = {name: meaning_of(entry) for name, entry in find_commands().items()}
    lines = [f"  {name:10} {shorten(told, _MOST_CHARACTERS)}" for name, told in meanings.items()]
    return "\n".join([_MENU_HEAD, *lines, _MENU_END.rstrip()])


def find_commands() -> dict[str, importlib.metadata.EntryPoint]:
    """Return the entry points of all commands by their names, in the order of the menu."""
    found = {entry.name: entry for entry in importlib.metadata.entry_points(group=COMMANDS_GROUP)}
    names = [name for name in _ORDER if name in found]
    return {name: found[name] for name in [*names, *sorted(set(found) - set(names))]}


def _load(name: str):
    """Return the function of a command.

    Raises:
        ValueError: If there is no such command.
        ImportError: If an extra is missing; the message names it.
    """
    commands = find_commands()
    if name not in commands:
        known = ", ".join(commands) or "none: install the package with pip install -e ."
        raise ValueError(f"unknown command {name!r}{suggest(name, commands)}; known: {known}")
    try:
        return commands[name].load()
    except ModuleNotFoundError as error:
        raise ImportError(name_extra(f"hav-env {name}", error)) from None


def _version() -> str:
    from hav_env import __version__  # noqa: PLC0415

    return __version__


def _search_current_folder() -> None:
    """Let ``module:Class`` name modules of the current folder, as ``python -m`` does.

    The folder comes last on the path: a file of the user must not hide a package.
    """
    if not sys.flags.safe_path and "" not in sys.path and os.getcwd() not in sys.path:
        sys.path.append(os.getcwd())
