"""This module compares policies on the same episodes: figures, and differences between policies."""

import math
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

_MOST_DECIMALS = 3  # of a value: two policies fit a line of 80 characters
_LONGEST_NAMED = 20  # characters of a name in the legend


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
            if figure.percent:  # the normal interval of few episodes has more than 100 points
                low, high = max(difference.low, -1.0), min(difference.high, 1.0)
                difference = difference._replace(low=low, high=high)
            rows[-1].append(Score(name, figure, measure(table, figure), difference))
    return rows


def compare(names: list[str], tables: list[pa.Table], dt: float = 0.2) -> list[list[str]]:
    """Return the rows of a comparison: figure, then each policy's value.

    Behind a value stands the half width of its 95 % interval, or the interval if the half width
    would reach below 0 or above 100 %. A star marks a policy that differs from the first one on the
    same HAVs of the same episodes. In parentheses are events that are no failures, such as
    potential collisions.

    Args:
        names: of the policies.
        tables: the episodes of each.
        dt: duration of a step [s].
    """
    rows = [["", *names]]
    for scores in score(names, tables):
        figure = scores[0].figure
        cells = [_show_value(one.measured, figure, dt) + _star(one) for one in scores]
        name = figure.name.partition(" [")[0]  # the unit stands in the cells
        rows.append([f"({name})" if figure.harmless else name, *cells])
    return rows


def compare_differences(names: list[str], tables: list[pa.Table]) -> list[list[str]]:
    """Return the rows of a second table: how much each policy differs from the first one.

    Differences are on the same HAVs of the same episodes, with their 95 % intervals and a star
    where an interval excludes zero.
    """
    rows = [[f"less {names[0]}", *names[1:]]]
    for scores in score(names, tables):
        cells = [_show_difference(one.difference, one.figure) for one in scores if one.difference]
        rows.append([scores[0].figure.name, *cells])
    return rows


def explain_comparison(names: list[str], company: bool) -> str:
    """Return the legend of ``compare``, at most two lines of 80 characters.

    Args:
        names: of the policies.
        company: whether there is more than one HAV in a world.
    """
    lines = ["95 % interval: ± wider half, or [low, high]"]
    if len(names) > 1:
        first = names[0] if len(names[0]) <= _LONGEST_NAMED else "the first policy"
        lines[0] += f"; * differs from {visible(first)}"
    if company:
        lines.append("In parentheses: circles overlap, which is neither contact nor failure")
    return "\n".join(f"{line}." for line in lines)


def _show_value(measured: Interval, figure: Figure, dt: float) -> str:
    if measured.size == 0:
        return "-"
    unit = figure.name.partition(" [")[2].rstrip("]")
    scale, unit = (100.0, " %") if figure.percent else (1.0, f" {unit}".rstrip())
    value = scale * measured.value
    half = scale * max(measured.high - measured.value, measured.value - measured.low)
    most = 100.0 if figure.percent else math.inf
    if figure.steps:
        unit = f" ({measured.value * dt:,.0f} s)"
    if not math.isfinite(half):  # of a single episode
        return f"{value:,.{0 if figure.steps or figure.percent else 2}f}{unit}"
    # two digits of what is uncertain
    decimals = min(max(1 - math.floor(math.log10(half)), 0), _MOST_DECIMALS) if half > 0 else 2
    decimals = 0 if figure.steps else decimals
    if half > 0 and not half <= value <= most - half:
        bounds = (value, scale * measured.low, scale * measured.high)
        shown, low, high = (f"{x:,.{0 if x in (0.0, most) else decimals}f}" for x in bounds)
        return f"{shown} [{low}, {high}]{'' if figure.steps else unit}"  # fits two to a line
    return f"{value:,.{decimals}f} ± {half:,.{decimals}f}{unit}"


def _star(one: Score) -> str:
    difference = one.difference
    if difference is None or difference.size == 0 or one.figure.harmless:
        return ""
    return "" if difference.low <= 0 <= difference.high else " *"


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


def _show_difference(difference: Interval, figure: Figure) -> str:
    if difference.size == 0:
        return "no common HAVs"
    scale, unit = (100, " pp") if figure.percent else (1, "")
    if difference.size == 1:  # of a single episode
        return f"{difference.value * scale:+.3g}{unit}"
    low, value, high = (scale * x for x in (difference.low, difference.value, difference.high))
    star = "" if low <= 0 <= high else " *"
    form = "+,.0f" if figure.steps else "+.3g"
    return f"{value:{form}}{unit} [{low:{form}}, {high:{form}}]{star}"


def read_columns(path: pathlib.Path) -> pa.Table:
    """Read the columns that the figures need of a table on disk."""
    # pq.read_table would load the library of datasets, which is slow
    with pq.ParquetFile(path) as file:
        return file.read(columns_of_figures(file.schema_arrow.names))
