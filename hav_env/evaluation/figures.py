"""This module declares the figures of an evaluation: success rates, times, paths and the like.

A new figure is one entry of ``FIGURES``.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from hav_env.evaluation.statistics import Interval, mean, proportion
from hav_env.world.event_table import EVENTS, Event


class Figure(NamedTuple):
    """One row of a comparison: what it is called and which rows of the table it is about."""

    name: str
    """"{goal}" stands for the number of the goal, from 1: there is one such figure for each."""
    column: str
    """Of the table; "{goal}" as in the name."""
    percent: bool
    """A share of all HAVs; otherwise a mean over the HAVs that have a value."""
    more_is_better: bool
    company: bool = False
    """It is shown where there is more than one HAV in a world."""
    obstacles: bool = False
    """It is shown where there are obstacles."""


def figure_of_event(event: Event) -> Figure:
    """Return the figure of an event: the share of HAVs to which it has happened."""
    return Figure(event.label, event.name, True, False, event.company, event.obstacles)


GOAL_HIT = Figure("goal {goal} hit", "goal_{goal}_hit", True, True)
FOLDED_THROUGH = Figure("folded through", "folded_through", True, False)
FIGURES = (
    figure_of_event(EVENTS[0]),
    GOAL_HIT,
    *map(figure_of_event, EVENTS[1:]),
    FOLDED_THROUGH,
    Figure("goal {goal} step", "goal_{goal}_step", False, False),
    Figure("goal {goal} driven / Dubins", "goal_{goal}_length_ratio", False, False),
    Figure("largest articulation [rad]", "largest_articulation", False, False),
)
_KEYS = ("episode", "hav")  # the columns that tell whose row it is


def figure_of_goal(figure: Figure, goal: int) -> Figure:
    """Return the figure of one goal, from 1."""
    return figure._replace(
        name=figure.name.format(goal=goal), column=figure.column.format(goal=goal)
    )


def goals_of(columns: Sequence[str]) -> range:
    """Return the numbers of the goals, from 1, of a table with these columns."""
    count = 0
    while figure_of_goal(GOAL_HIT, count + 1).column in columns:
        count += 1
    return range(1, count + 1)


def goal_hits(figures: Sequence[str]) -> list[str]:
    """Return which names of figures are shares of HAVs that hit a goal, in their order."""
    found: list[str] = []
    while (name := figure_of_goal(GOAL_HIT, len(found) + 1).name) in figures:
        found.append(name)
    return found


def figures_of(table: pa.Table) -> list[Figure]:
    """Return the figures that a table has, in their order."""
    company = pc.max(table["hav"]).as_py() > 0
    figures = _all_figures(table.column_names)
    return [figure for figure in figures if company or not figure.company]


def columns_of_figures(columns: Sequence[str]) -> list[str]:
    """Return which of the columns of a table the figures need, in the table's order."""
    needed = {*_KEYS, *(figure.column for figure in _all_figures(columns))}
    return [name for name in columns if name in needed]


def _all_figures(columns: Sequence[str]) -> Iterator[Figure]:
    for figure in FIGURES:
        if "{goal}" in figure.column:
            yield from (figure_of_goal(figure, goal) for goal in goals_of(columns))
        elif figure.column in columns or not figure.obstacles:
            yield figure


def figure_values(table: pa.Table, figure: Figure) -> np.ndarray:
    """Return the values of a figure for every row, nan where there is none."""
    return table[figure.column].cast(pa.float64()).to_numpy(zero_copy_only=False)


def measure(table: pa.Table, figure: Figure) -> Interval:
    """Return a figure with its 95 % interval, clustered by episode.

    Args:
        table: of ``hav_env.evaluation.rollout``, or its columns ``episode`` and that of the figure.
        figure: the figure, with the number of its goal.

    Returns:
        A share of HAVs with its Wilson interval, or a mean with its normal interval.
    """
    values, episodes = figure_values(table, figure), table["episode"].to_numpy()
    return proportion(values, episodes) if figure.percent else mean(values, episodes)
