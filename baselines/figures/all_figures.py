"""This module draws all figures of the paper's experiments as soon as their tables exist."""

import os
import pathlib
from collections.abc import Iterable, Iterator

import pyarrow as pa

from baselines.evaluation.runs import Experiments
from baselines.figures.paper import (
    draw_goal_histograms,
    draw_jackknife_histograms,
    draw_jackknife_weight,
    draw_miss_histograms,
)
from baselines.figures.representative_episodes import (
    Excerpt,
    choose_of_pair,
    choose_of_single,
    round_closest,
)
from baselines.figures.trajectory_plot import draw_trajectory, save_figure
from baselines.policies.avoid_jack import AvoidJack
from baselines.replay.trajectory import record_trajectory

_TITLES = {
    "hit": "Both goals hit",
    "jackknife": "A jackknife",
    "evasion": "Evasion",
    "miss": "A close miss of the first goal",
    "orbit": "A first goal never hit: the end of the episode",
}
# order in a report
_ORDER = (
    "jackknife_weight",
    *("jackknife_single", "goals_single", "misses_single"),
    *("jackknife_pair", "goals_pair", "misses_pair"),
    *(f"trajectory_{kind}" for kind in _TITLES),
)


def draw_single(
    experiments: Experiments, table: pa.Table, folder: str | os.PathLike
) -> Iterator[list[str]]:
    """Draw the figures that need only the experiments of single HAVs, figure after figure.

    Args:
        experiments: Experiments of the table; chosen episodes run again.
        table: Table of the experiments, of ``rollout``.
        folder: Folder of the files, created if necessary. Existing files are replaced; the same
            tables give the same bytes.

    Yields:
        The names of a figure's files.
    """
    if isinstance(experiments.policy, AvoidJack):
        figure = draw_jackknife_weight(experiments.policy)
        yield save_figure(figure, folder, "jackknife_weight")
    yield from _draw_histograms(experiments, table, folder, "single")
    yield from _draw_episodes(experiments, choose_of_single(table), folder)


def draw_pair(
    experiments: Experiments, table: pa.Table, single: pa.Table, folder: str | os.PathLike
) -> Iterator[list[str]]:
    """Draw the figures that need the experiments of pairs, as ``draw_single`` does.

    Args:
        experiments: Experiments of the table; chosen episodes run again.
        table: Table of the experiments.
        single: Table of the experiments of single HAVs.
        folder: Folder of the files.

    Yields:
        The names of a figure's files.
    """
    yield from _draw_histograms(experiments, table, folder, "pair")
    yield from _draw_episodes(experiments, choose_of_pair(table, single), folder)


def in_order(files: Iterable[str]) -> list[str]:
    """Return the names of drawn files in their order in a report."""
    return sorted(files, key=lambda file: _ORDER.index(pathlib.PurePath(file).stem))


def _draw_histograms(
    experiments: Experiments, table: pa.Table, folder: str | os.PathLike, which: str
) -> Iterator[list[str]]:
    yield save_figure(draw_jackknife_histograms(table), folder, f"jackknife_{which}")
    yield save_figure(draw_goal_histograms(table, experiments.task), folder, f"goals_{which}")
    yield save_figure(draw_miss_histograms(table, experiments.task), folder, f"misses_{which}")


def _draw_episodes(
    experiments: Experiments, excerpts: dict[str, Excerpt | None], folder: str | os.PathLike
) -> Iterator[list[str]]:
    """Draw the excerpts of episodes that exist."""
    policy, scenario, _, seed, task, vehicle, guidance = experiments
    for kind, excerpt in excerpts.items():
        if excerpt is None:
            continue
        trajectory = record_trajectory(
            policy, scenario, seed, excerpt.episode, task, vehicle, guidance=guidance
        )
        part = excerpt if kind != "miss" else round_closest(trajectory, excerpt)
        title = f"{_TITLES[kind]} (seed {seed}, episode {excerpt.episode})"
        figure = draw_trajectory(trajectory, title, part, task=task)
        yield save_figure(figure, folder, f"trajectory_{kind}")
