"""This module escapes text for Markdown and plots, and converts any names to names of files."""

import hashlib
import re
from collections import Counter
from collections.abc import Sequence

from hav_env.models.text import visible

_LONGEST_FILE_NAME = 100  # characters of the name of a file, without its suffix
# characters that begin or end markup: no lone star, no underscore within a word, no interval in
# brackets
_MARKUP = re.compile(r"[\\`|<&~$]|(?<=\S)\*|\*(?=\S)|(?<!\w)_|_(?!\w)|\](?=[(\[:])")


def markdown(rows: list[list[str]]) -> str:
    """Return rows as a table in Markdown; the first row is the head."""
    return "\n".join([markdown_head(rows[0]), *map(markdown_row, rows[1:])]) + "\n"


def markdown_head(row: list[str]) -> str:
    """Return the two lines that begin a table in Markdown."""
    return f"{markdown_row(row)}\n|{'|'.join(['---'] + ['--:'] * (len(row) - 1))}|"


def markdown_row(row: list[str]) -> str:
    """Return the line of one row of a table in Markdown."""
    return "| " + " | ".join(map(_escape_cell, row)) + " |"


def _escape_cell(text: str) -> str:
    return _MARKUP.sub(lambda found: f"\\{found[0]}", visible(text))


def code(text: str) -> str:
    """Return any text as code in Markdown."""
    fence = "`" * (1 + max(map(len, re.findall("`+", text)), default=0))
    space = " " if len(fence) > 1 else ""
    return f"{fence}{space}{visible(text)}{space}{fence}"


def plot_text(text: str) -> str:
    """Return text that a plot shows unchanged: dollars begin no formula, and no label hides.

    Legends leave out labels that begin with an underscore.
    """
    shown = visible(text).replace("$", r"\$")
    return f" {shown}" if shown.startswith("_") else shown


def file_names(names: Sequence[str], others: str = r"\W+") -> list[str]:
    """Return a name of a file, without suffix, for each name; equal names get equal files.

    Args:
        names: Any text.
        others: Pattern of the characters that become a dash.

    Different names that would share a file, ignoring case, get a digest as a suffix.
    """
    plain = {name: re.sub(others, "-", name) for name in names}
    shared = Counter(label.casefold() for label in plain.values())

    def label(name: str) -> str:
        short = plain[name]
        if shared[short.casefold()] == 1 and len(short.encode()) <= _LONGEST_FILE_NAME:
            return short
        digest = hashlib.sha256(name.encode("utf-8", "surrogateescape")).hexdigest()[:12]
        return f"{short[: _LONGEST_FILE_NAME // 4]}-{digest}"

    return [label(name) for name in names]
