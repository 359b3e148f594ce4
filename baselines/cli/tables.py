"""This module prints tables: plain text that fits a terminal, Markdown or CSV."""

import csv
import itertools
import shutil
import sys
import textwrap
from typing import Literal

from baselines.cli.markup import markdown
from hav_env.models.text import visible

Format = Literal["text", "md", "csv"]
TERMINAL_WIDTH = 80
"""Characters of a line of the narrowest terminal."""
_GAP = 2  # characters between columns


def print_table(
    rows: list[list[str]], title: str, form: Format = "text", legend: str = "", keys: int = 1
) -> None:
    """Print rows of text, the head first.

    Args:
        rows: Rows with equal numbers of cells.
        title: Line above the table; CSV has no title and no legend.
        form: "text" for terminals, "md" for Markdown, "csv" for comma-separated values.
        legend: Lines below the table.
        keys: Number of first columns that each part of a wide table repeats.
    """
    if form == "csv":
        csv.writer(sys.stdout, lineterminator="\n").writerows(rows)
        return
    width = max(TERMINAL_WIDTH, shutil.get_terminal_size().columns)
    table = markdown(rows).rstrip() if form == "md" else plain_table(rows, width, keys)
    lines = textwrap.wrap(visible(title), width, break_on_hyphens=False)
    print("\n".join([*lines, "", table, *(["", legend] if legend else [])]))


def plain_table(rows: list[list[str]], width: int, keys: int = 1) -> str:
    """Return a table as text; columns that do not fit follow below, in further parts.

    Args:
        rows: Rows with equal numbers of cells, the head first.
        width: Characters of a line.
        keys: Number of first columns that each part repeats.
    """
    cells = [[visible(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    parts, part = [], list(range(keys))
    for column in range(keys, len(widths)):
        taken = sum(widths[k] + _GAP for k in part) + widths[column]
        if taken > width and len(part) > keys:
            parts.append(part)
            part = list(range(keys))
        part.append(column)
    blocks = [_block(cells, widths, part, keys) for part in [*parts, part]]
    return "\n".join(itertools.chain.from_iterable(zip(blocks, [""] * len(blocks), strict=True)))[
        :-1
    ]


def _block(cells: list[list[str]], widths: list[int], part: list[int], keys: int) -> str:
    lines = []
    for row in cells:
        shown = [row[k].ljust(widths[k]) if k < keys else row[k].rjust(widths[k]) for k in part]
        lines.append((" " * _GAP).join(shown).rstrip())
    rule = "─" * (sum(widths[k] for k in part) + _GAP * (len(part) - 1))
    return "\n".join([lines[0], rule, *lines[1:]])
