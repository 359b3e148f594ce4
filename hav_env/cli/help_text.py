"""This module converts the help of tyro, which draws boxes, to plain text for 80 columns."""

import re
import textwrap
from collections.abc import Mapping

_LINE_LENGTH = 80
_WITHOUT = re.compile(r" ?\(default: (None|False|True|''|)\)")


def plain_help(text: str, program: str, description: str, names: Mapping[str, str]) -> str:
    """Return the help of a command.

    Args:
        text: Help of tyro, in boxes.
        program: The command and its arguments, for the first line.
        description: Purpose of the command.
        names: The names that each argument takes, or the command that lists them.
    """
    usage = textwrap.wrap(f"usage: {program} [OPTIONS]", _LINE_LENGTH, subsequent_indent=" " * 7)
    lines = [*usage, "", *textwrap.wrap(description, _LINE_LENGTH, break_on_hyphens=False)]
    if names:
        lines += ["", "names"]
        for argument, known in names.items():
            lines += _item(argument, known)
    for title, about, items in sections_of(text):
        if not items:  # positional arguments, which program and description explain
            continue
        lines += ["", title, *textwrap.wrap(_plain(about), _LINE_LENGTH)]
        for option, told in items:
            lines += _item(_shown_option(option, told), _WITHOUT.sub("", _plain(told)))
    return "\n".join(lines)


def sections_of(text: str) -> list[tuple[str, str, list[list[str]]]]:
    """Return the title, the first paragraph, and the options with their help, of each box."""
    sections: list[tuple[str, str, list[list[str]]]] = []
    for line in text.splitlines():
        inside = line[2:-1].rstrip()
        if line.startswith("╭"):
            title, about, items, ended = line.strip("╭─╮ "), "", [], False  # type: ignore[var-annotated]
        elif line.startswith("╰"):
            sections.append((title, about.strip(), items))
        elif not line.startswith("│") or set(inside) <= {"─"}:
            ended = True
        elif inside.startswith("-"):
            option, _, told = inside.partition("  ")
            items.append([option, told.strip()])
        elif items:
            items[-1][1] = f"{items[-1][1]} {inside.strip()}".strip()
        elif not ended:
            about += f" {inside}"
    return sections


def _plain(text: str) -> str:
    return text.replace("``", "")


def _shown_option(option: str, told: str) -> str:
    """Return an option as users write it; a flag has the form that changes its default."""
    shown = option.replace("{None}|", "").replace("{None,", "{").replace("-h, --help", "--help")
    flag, _, negated = shown.partition(", ")
    if "no-" in negated:
        return negated if "(default: True)" in told else flag
    return shown


def _item(name: str, told: str) -> list[str]:
    indent = " " * 6
    wrapped = textwrap.wrap(
        told, _LINE_LENGTH, initial_indent=indent, subsequent_indent=indent, break_on_hyphens=False
    )
    return [f"  {name}", *wrapped]
