"""This module plots a comparison: bars of figures, learning curves, one episode by every policy."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from baselines.cli.markup import plot_text
from baselines.figures.representative_episodes import Excerpt
from baselines.figures.trajectory_plot import (
    BLUE,
    DARK,
    GREEN,
    GREY,
    LIGHT,
    ORANGE,
    PURPLE,
    draw_episode,
    new_figure,
    sheet,
)
from baselines.replay.trajectory import Trajectory
from hav_env.evaluation.comparison import Score
from hav_env.evaluation.figures import goal_hits

_COLORS = (GREY, BLUE, LIGHT, ORANGE, GREEN, PURPLE)


@sheet
def draw_bars(scores: list[list[Score]], title: str) -> Figure:
    """Draw every figure of all policies with its 95 % interval, a panel for each figure."""
    columns = 4
    rows = -(-len(scores) // columns)
    figure = new_figure(1.6 * rows + 0.4)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, row in zip(panels, scores, strict=False):
        scale = 100.0 if row[0].figure.percent else 1.0
        for place, one in enumerate(row):
            value, low, high = one.measured[:3]
            if one.measured.size == 0:
                continue
            reach = scale * np.array([[max(value - low, 0.0)], [max(high - value, 0.0)]])
            color = _COLORS[place % len(_COLORS)]
            axes.bar(place, scale * value, 0.8, yerr=reach, color=color, ecolor=DARK, capsize=2)
        axes.set_title(f"{row[0].figure.name}{' [%]' if row[0].figure.percent else ''}")
        axes.set_xticks(range(len(row)), [plot_text(one.policy).replace("_", "\n") for one in row])
        axes.tick_params(axis="x", labelsize=5)
    for axes in panels[len(scores) :]:
        axes.remove()
    figure.suptitle(plot_text(title))
    return figure


@sheet
def draw_curves(
    curves: dict[str, list[dict[str, Any]]], name: str, reference: dict[str, float]
) -> Figure:
    """Draw what policies reached on the held-out episodes while they learned.

    Args:
        curves: of each policy, the rows of its ``curve.json``.
        name: of the policy to compare with.
        reference: the figures of that policy, drawn as dashed lines.
    """
    figure = new_figure(2.4)
    goals, harm = figure.subplots(1, 2)
    rows = next(iter(curves.values()))
    shown = [figure for figure in rows[0] if figure in reference]
    colors = dict(zip(shown, (BLUE, ORANGE, GREEN, PURPLE, DARK, GREY), strict=False))
    for k, (policy, curve) in enumerate(curves.items()):
        millions = [row["decisions"] / 1e6 for row in curve]
        for what in shown:
            axes = goals if what in goal_hits(shown) else harm
            values = [100.0 * row[what] for row in curve]
            label = plot_text(what if len(curves) == 1 else f"{policy}: {what}")
            style = ("-", "-.", ":")[k % 3]
            axes.plot(millions, values, color=colors[what], ls=style, label=label)
            axes.axhline(100.0 * reference[what], color=colors[what], lw=0.7, ls=(0, (4, 3)))
    harm.set_yscale("symlog", linthresh=1.0)
    for axes in (goals, harm):
        axes.set(xlabel="decisions [millions]", ylabel="share of HAVs [%]")
        axes.set_title(f"dashed: {plot_text(name)}")
        axes.set_ylim(bottom=0.0)
        axes.legend()
    return figure


@sheet
def draw_side_by_side(trajectories: Sequence[Trajectory], names: Sequence[str]) -> Figure:
    """Draw the same episode as every policy drove it."""
    columns = 2
    rows = -(-len(trajectories) // columns)
    figure = new_figure(3.2 * rows)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, trajectory, name in zip(panels, trajectories, names, strict=False):
        whole = Excerpt(0, len(trajectory.num_trailers))
        seconds = trajectory.step[-1] * trajectory.dt
        draw_episode(axes, trajectory, f"{name}: {seconds:,.0f} s", whole, 3)
    for axes in panels[len(trajectories) :]:
        axes.remove()
    return figure
