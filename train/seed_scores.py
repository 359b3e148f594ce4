"""This module scores policies over training seeds and worlds; its units are worlds, not HAVs.

A policy of one training, or a scripted one, is a group of one seed.
"""

from typing import NamedTuple

import numpy as np
import pyarrow as pa

from baselines.evaluation.arrival_times import world_times
from hav_env.evaluation.bootstrap import (
    Profile,
    bootstrap,
    counted_mean,
    interquartile_mean,
    performance_profile,
)
from hav_env.evaluation.figures import figure_values, figures_of
from hav_env.evaluation.statistics import Interval
from hav_env.models.text import visible

TIME_RATIO = "time / shortest"
RATIO_LIMITS = np.geomspace(0.7, 30.0, 200)
"""The time ratios at which profiles are computed."""


class GroupScore(NamedTuple):
    """The scores of a policy, or of the policies of several training seeds."""

    name: str
    seeds: int
    measured: dict[str, Interval]
    """The value of each figure: the mean of a share, the interquartile mean of another figure."""
    percent: frozenset[str]
    """The figures that are shares."""
    profile: Profile
    """The share of worlds by time ratio."""


def score_group(name: str, tables: list[pa.Table], fleet, cap: int) -> GroupScore:
    """Score the policies of a group on the same episodes.

    Args:
        name: Name of the group.
        tables: Tables of ``hav_env.evaluation.rollout``, whole episodes, one for each training
            seed.
        fleet: The fleet of the scenario, with the limits of speed and steering.
        cap: Step limit of an episode, the time of HAVs that never arrive.
    """
    found = [world_values(table, fleet, cap) for table in tables]
    values = {figure: np.stack([of_one[figure] for of_one in found]) for figure in found[0]}
    percent = frozenset(figure.name for figure in figures_of(tables[0]) if figure.percent)
    measured = {
        figure: bootstrap([one], counted_mean if figure in percent else interquartile_mean)
        for figure, one in values.items()
    }
    profile = performance_profile([values[TIME_RATIO]], RATIO_LIMITS)
    return GroupScore(name, len(tables), measured, percent, profile)


def world_values(table: pa.Table, fleet, cap: int) -> dict[str, np.ndarray]:
    """Return the figures of every world, each (W,); nan where no HAV has a value.

    Args:
        table: The table of one policy.
        fleet: As for ``score_group``.
        cap: As for ``score_group``.
    """
    num_havs = int(np.max(table["hav"].to_numpy())) + 1
    values = {}
    for figure in figures_of(table):
        of_havs = figure_values(table, figure)
        if figure.column.endswith("_step"):
            of_havs = np.where(np.isfinite(of_havs), of_havs, float(cap))
        values[figure.name] = _mean_of_worlds(of_havs.reshape(-1, num_havs))
    times = world_times(table, fleet, cap)
    values[TIME_RATIO] = times.driven / times.shortest
    return values


def _mean_of_worlds(values: np.ndarray) -> np.ndarray:
    """Return the mean over the HAVs of a world that have a value: (W, N) to (W,)."""
    known = np.isfinite(values)
    count = known.sum(1)
    total = np.where(known, values, 0.0).sum(1)
    return np.divide(total, count, out=np.full(len(values), np.nan), where=count > 0)


def group_rows(groups: list[GroupScore]) -> list[list[str]]:
    """Return the rows of a table, the head first; each row has all figures of a group."""
    names = list(groups[0].measured)
    rows = [["", "seeds", *names]]
    for group in groups:
        shown = [group.measured[name].show(name in group.percent) for name in names]
        rows.append([group.name, str(group.seeds), *shown])
    return rows


def tabulate_groups(groups: list[GroupScore]) -> pa.Table:
    """Return the scores as a table, one row for each group and figure.

    Columns: ``policy``, ``seeds``, ``figure``, ``value``, ``low``, ``high`` (95 %), ``size``
    (seeds times worlds that have a value).
    """
    rows = []
    for group in groups:
        for figure, one in group.measured.items():
            told = {"policy": visible(group.name), "seeds": group.seeds, "figure": figure}
            rows.append(told | dict(zip(("value", "low", "high", "size"), one[:4], strict=True)))
    return pa.Table.from_pylist(rows)
