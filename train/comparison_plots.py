"""This module plots comparisons: bars, performance profiles, learning curves, the same episode."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from baselines.cli.markup import plot_text
from baselines.figures.plot_labels import label_panels
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
    explain_episode,
    new_figure,
    sheet,
)
from baselines.replay.trajectory import Trajectory
from hav_env.evaluation.bootstrap import bootstrap, counted_mean
from hav_env.evaluation.comparison import Score
from hav_env.evaluation.figures import goal_hits
from train.seed_scores import GroupScore

_WHOLE_PERCENT = 10.0  # [%] shares above it are drawn on a logarithmic axis
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
def draw_profiles(groups: list[GroupScore], title: str) -> Figure:
    """Draw the share of worlds by time ratio, with 95 % bands, a line for each group."""
    figure = new_figure(2.8)
    axes = figure.subplots()
    for place, group in enumerate(groups):
        color, profile = _COLORS[place % len(_COLORS)], group.profile
        style = ("-", "--", ":")[place // len(_COLORS) % 3]
        label = plot_text(f"{group.name} ({group.seeds} seeds)" if group.seeds > 1 else group.name)
        axes.plot(profile.limits, 100.0 * profile.share, color=color, ls=style, label=label)
        band = 100.0 * profile.low, 100.0 * profile.high
        axes.fill_between(profile.limits, *band, color=color, alpha=0.25, lw=0)
    axes.set_xscale("log")
    axes.set(xlabel="time / shortest", ylabel="share of worlds at most that [%]", ylim=(0, 100))
    axes.set_title(plot_text(title))
    axes.legend()
    return figure


@sheet
def draw_curves(
    curves: dict[str, list[list[dict[str, Any]]]], name: str, reference: dict[str, float]
) -> Figure:
    """Plot learning curves: figures of the held-out episodes over decisions.

    Args:
        curves: For each group, the ``curve.json`` of each of its seeds. Several seeds become their
            mean with a 95 % band.
        name: Name of the reference policy.
        reference: The figures of the reference policy, plotted as dashed lines.
    """
    figure = new_figure(2.4)
    goals, harm = figure.subplots(1, 2)
    rows = next(iter(curves.values()))[0]
    shown = [what for what in rows[0] if what in reference]
    colors = dict(zip(shown, (BLUE, ORANGE, GREEN, PURPLE, DARK, GREY), strict=False))
    for k, (policy, of_seeds) in enumerate(curves.items()):
        for what in shown:
            axes = goals if what in goal_hits(shown) else harm
            decisions, *band = curve_band(of_seeds, what)
            mean, low, high = (100.0 * values for values in band)
            label = plot_text(what if len(curves) == 1 else f"{policy}: {what}")
            style = ("-", "-.", ":")[k % 3]
            axes.plot(decisions / 1e6, mean, color=colors[what], ls=style, label=label)
            if len(of_seeds) > 1:
                axes.fill_between(decisions / 1e6, low, high, color=colors[what], alpha=0.2, lw=0)
            axes.axhline(100.0 * reference[what], color=colors[what], lw=0.7, ls=(0, (4, 3)))
    harm.set_ylim(bottom=0.0)
    if harm.get_ylim()[1] > _WHOLE_PERCENT:
        harm.set_yscale("symlog", linthresh=1.0)
        harm.yaxis.set_major_formatter("{x:g}")
    for axes in (goals, harm):
        axes.set(xlabel="decisions [millions]", ylabel="share of HAVs [%]")
        axes.set_title(f"dashed: {plot_text(name)}")
        axes.set_ylim(bottom=0.0)
        axes.legend()
    return figure


def curve_band(curves: list[list[dict[str, Any]]], what: str) -> np.ndarray:
    """Return decisions, mean over seeds, and its 95 % bootstrap interval, (4, evaluations).

    Args:
        curves: The curve of each seed; only evaluations that all seeds have count.
        what: Name of the figure.
    """
    by_seed = [{row["decisions"]: row.get(what, np.nan) for row in curve} for curve in curves]
    common = sorted(set.intersection(*map(set, by_seed)))
    found = []
    for decisions in common:
        values = np.array([[of_one[decisions]] for of_one in by_seed])
        found.append((decisions, *bootstrap([values], counted_mean)[:3]))
    return np.array(found, float).reshape(-1, 4).T


@sheet
def draw_side_by_side(trajectories: Sequence[Trajectory], names: Sequence[str]) -> Figure:
    """Draw the same episode under every policy, side by side."""
    columns = 2
    rows = -(-len(trajectories) // columns)
    figure = new_figure(3.2 * rows + 0.5)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    labels = {}
    handles: dict[object, Line2D] = {}  # one for each label
    for axes, trajectory, name in zip(panels, trajectories, names, strict=False):
        whole = Excerpt(0, len(trajectory.num_trailers))
        seconds = trajectory.step[-1] * trajectory.dt
        title = f"{name}: {seconds:,.0f} s"
        labels[axes] = draw_episode(axes, trajectory, title, whole, 3)
        axes.margins(0.08)
        handles |= {handle.get_label(): handle for handle in explain_episode(trajectory, whole)}
    for axes in panels[len(trajectories) :]:
        axes.remove()
    figure.legend(handles=[*handles.values()], loc="outside lower center", ncols=3)
    label_panels(labels)
    return figure
