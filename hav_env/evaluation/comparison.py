"""This module compares policies on the same episodes: figures, and differences between policies."""

import pathlib
from typing import NamedTuple

import pyarrow as pa
import pyarrow.parquet as pq

from hav_env.evaluation.figures import (
    Figure,
    columns_of_figures,
    figure_values,
    figures_of,
    measure,
)
from hav_env.evaluation.statistics import Interval, paired_difference
from hav_env.models.text import visible


class Score(NamedTuple):
    """A figure of a policy, and how much it differs from the first policy's."""

    policy: str
    figure: Figure
    measured: Interval
    difference: Interval | None
    """On the same HAVs of the same episodes; None for the first policy."""


def score(names: list[str], tables: list[pa.Table]) -> list[list[Score]]:
    """Return the scores of all policies, a list for each figure."""
    first = tables[0]
    episodes = first["episode"].to_numpy()
    rows = []
    for figure in figures_of(first):
        reference = figure_values(first, figure)
        rows.append([Score(names[0], figure, measure(first, figure), None)])
        for name, table in zip(names[1:], tables[1:], strict=True):
            difference = paired_difference(episodes, figure_values(table, figure), reference)
            rows[-1].append(Score(name, figure, measure(table, figure), difference))
    return rows


def compare(names: list[str], tables: list[pa.Table]) -> list[list[str]]:
    """Return the rows of a comparison: figure, then each policy's value.

    Behind every policy but the first stands how much it differs from the first on the same HAVs of
    the same episodes, with its 95 % interval, and a star where that interval excludes zero.
    """
    rows = [["", *names]]
    for scores in score(names, tables):
        cells = []
        for _, figure, measured, difference in scores:
            behind = "" if difference is None else f"; {_signed(difference, figure)}"
            cells.append(f"{measured.show(figure.percent)}{behind}")
        rows.append([scores[0].figure.name, *cells])
    return rows


def tabulate_scores(scores: list[list[Score]]) -> pa.Table:
    """Return scores as a table, one row for each policy and figure.

    Columns: ``policy``, ``figure``, ``value``, ``low``, ``high`` (95 %), ``size`` (HAVs),
    ``design_effect`` (of the HAVs of an episode on each other), and all but the last of the
    difference from the first policy, ``difference_...``, null for that one.
    """
    rows = []
    for one in (one for row in scores for one in row):
        names = {"policy": visible(one.policy), "figure": one.figure.name}
        told = names | one.measured._asdict()
        difference = one.difference or Interval(None, None, None, 0)  # type: ignore[arg-type]
        behind = difference._asdict()
        del behind["design_effect"]  # 1, since its observations are episodes
        rows.append(told | {f"difference_{k}": v for k, v in behind.items()})
    return pa.Table.from_pylist(rows)


def _signed(difference: Interval, figure: Figure) -> str:
    if difference.size == 0:
        return "no common HAVs"
    scale, unit = (100, " pp") if figure.percent else (1, "")
    low, value, high = (scale * x for x in (difference.low, difference.value, difference.high))
    star = "" if low <= 0 <= high else " *"
    return f"{value:+.3g}{unit} [{low:+.3g}, {high:+.3g}]{star}"


def read_columns(path: pathlib.Path) -> pa.Table:
    """Read the columns that the figures need of a table on disk."""
    kept = columns_of_figures(pq.read_schema(path).names)
    return pq.read_table(path, columns=kept)
