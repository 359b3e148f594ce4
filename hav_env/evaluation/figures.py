"""This module declares the figures of an evaluation: success rates, times, paths and the like.

A new figure is one entry of ``FIGURES``.
"""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import pyarrow as pa

from hav_env.evaluation.statistics import Interval, mean, proportion
from hav_env.world.event_table import EVENTS, Event


class Figure(NamedTuple):
    """One row of a comparison: its name and its column of the episode table."""

    name: str
    """Name, in which "{goal}" stands for the number of the goal, from 1: each goal has such a
    figure.
    """
    column: str
    """Column of the table; "{goal}" as in the name."""
    percent: bool
    """Whether the figure is a share of all HAVs; otherwise it is a mean over the HAVs that have a
    value.
    """
    more_is_better: bool
    company: bool = False
    """Whether the figure needs more than one HAV in a world."""
    obstacles: bool = False
    """Whether the figure needs obstacles."""
    harmless: bool = False
    """Whether the figure is a share of HAVs with an event that is not a failure."""
    steps: bool = False
    """Whether the figure is a number of steps."""
    most: float = math.inf
    """Value that larger ones count as."""


def figure_of_event(event: Event) -> Figure:
    """Return the figure of an event: the share of HAVs to which it has happened."""
    told = event.label, event.name, True, False, event.company, event.obstacles
    return Figure(*told, harmless=not event.harm)


GOAL_HIT = Figure("goal {goal} hit", "goal_{goal}_hit", True, True)
FOLDED_THROUGH = Figure("folded through", "folded_through", True, False)
FIGURES = (
    figure_of_event(EVENTS[0]),
    GOAL_HIT,
    *map(figure_of_event, EVENTS[1:]),
    FOLDED_THROUGH,
    Figure("goal {goal} step", "goal_{goal}_step", False, False, steps=True),
    Figure("goal {goal} driven / Dubins", "goal_{goal}_length_ratio", False, False),
    # an articulation is an angle: whole turns of a few folded joints would fill the mean
    Figure("largest articulation [rad]", "largest_articulation", False, False, most=math.pi),
)
_KEYS = ("episode", "hav")  # columns that identify a row


def figure_of_goal(figure: Figure, goal: int) -> Figure:
    """Return the figure of one goal; goals count from 1."""
    return figure._replace(
        name=figure.name.format(goal=goal), column=figure.column.format(goal=goal)
    )


def goals_of(columns: Sequence[str]) -> range:
    """Return the numbers of the goals, from 1, in a table with these columns."""
    count = 0
    while figure_of_goal(GOAL_HIT, count + 1).column in columns:
        count += 1
    return range(1, count + 1)


def goal_hits(figures: Sequence[str]) -> list[str]:
    """Return the names of those figures that are shares of HAVs that hit a goal, in their order."""
    found: list[str] = []
    while (name := figure_of_goal(GOAL_HIT, len(found) + 1).name) in figures:
        found.append(name)
    return found


def figures_of(table: pa.Table) -> list[Figure]:
    """Return the figures that a table has, in their order."""
    company = table["hav"].to_numpy().max(initial=0) > 0
    figures = _all_figures(table.column_names)
    return [figure for figure in figures if company or not figure.company]


def columns_of_figures(columns: Sequence[str]) -> list[str]:
    """Return the columns of a table that the figures need, in the table's order."""
    needed = {*_KEYS, *(figure.column for figure in _all_figures(columns))}
    return [name for name in columns if name in needed]


def _all_figures(columns: Sequence[str]) -> Iterator[Figure]:
    for figure in FIGURES:
        if "{goal}" in figure.column:
            yield from (figure_of_goal(figure, goal) for goal in goals_of(columns))
        elif figure.column in columns or not figure.obstacles:
            yield figure


def figure_values(table: pa.Table, figure: Figure) -> np.ndarray:
    """Return the values of a figure for every row, nan for missing values."""
    # a cast of Arrow would load its library of computations, which is slow
    values = table[figure.column].to_numpy(zero_copy_only=False).astype(float)
    return np.minimum(values, figure.most)


def measure(table: pa.Table, figure: Figure) -> Interval:
    """Return a figure with its 95 % interval, clustered by episode.

    No figure is below 0, so neither is an interval: that of few episodes would be.

    Args:
        table: Table of ``hav_env.evaluation.rollout``, or its columns ``episode`` and that of the
            figure.
        figure: Figure, with the number of its goal.

    Returns:
        A share of HAVs with its Wilson interval, or a mean with its normal interval.
    """
    values, episodes = figure_values(table, figure), table["episode"].to_numpy()
    if figure.percent:
        return proportion(values, episodes)
    found = mean(values, episodes)
    return found._replace(low=max(found.low, 0.0)) if math.isfinite(found.low) else found
