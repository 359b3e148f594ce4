"""This module draws histograms of an evaluation as the paper does, and the jackknife weight."""

import math
from collections.abc import Sequence

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from baselines.figures.trajectory_plot import (
    BLUE,
    DARK,
    GREEN,
    GREY,
    LIGHT,
    ORANGE,
    Axes,
    Figure,
    new_figure,
    sheet,
)
from baselines.policies.avoid_jack import AvoidJack
from hav_env import Task
from hav_env.evaluation.figures import goals_of
from hav_env.policies.interface import joint_weights

_GOAL_COLORS = (BLUE, ORANGE, GREEN)
_MOST_WEIGHT = 2.0  # a sum of weights is rarely more in a close miss; the last bin holds the rest
_Sample = tuple[str, np.ndarray, str]  # name, values, colour


@sheet
def draw_jackknife_weight(
    policy: AvoidJack = AvoidJack(), articulation_max: float = math.pi / 2
) -> Figure:
    """Draw the jackknife weight over the articulation, eq. (15)."""

    def weight(articulation):
        return joint_weights(policy, np.cos(articulation))

    figure = new_figure(2.0, 3.5)
    axes = figure.add_subplot(xlim=(-1, 1), ylim=(0, 2))
    axes.axhline(1.0, color=LIGHT, lw=0.8)
    marks = (
        (policy.beta, r"$\beta$", "right", 1.06),
        (articulation_max, r"$\delta^{max}$", "left", 0.06),
    )
    for angle, name, side, height in marks:
        axes.plot([angle / np.pi] * 2, [0, weight(angle)], color=GREY, lw=0.8)
        text = f" {name} = {math.degrees(angle):.0f}° "
        axes.text(angle / np.pi, height, text, color=DARK, fontsize=7, ha=side)
    articulation = np.linspace(-np.pi, np.pi, 401)
    axes.plot(articulation / np.pi, weight(articulation), color=BLUE, lw=1.5)
    axes.set(xlabel=r"Articulation $\delta$ [$\pi$ rad]", ylabel=r"Jackknife weight $w^{jack}$ [1]")
    axes.set_xticks([-1, -0.5, 0, 0.5, 1], ["−1", "−½", "0", "½", "1"])
    return figure


@sheet
def draw_jackknife_histograms(table: pa.Table) -> Figure:
    """Compare jackknifed HAVs with all: lengths, length differences, and positions of the joint."""
    jackknifed = table.filter(table["jackknifed"])
    many, few = _among(table), "jackknifed"
    figure, axes = _panels()
    _draw_histograms(
        axes[0],
        _bins(5.0, _values(table, "vehicle_length").max(initial=0.0)),
        [
            ("all", _values(table, "vehicle_length"), GREY),
            (few, _values(jackknifed, "vehicle_length"), ORANGE),
        ],
        many,
    )
    axes[0].set(xlabel="Vehicle length [m]")
    _draw_histograms(
        axes[1],
        _bins(0.05, 1.0),
        [
            ("all", _values(table, "length_difference"), GREY),
            (few, _values(jackknifed, "length_difference"), ORANGE),
            ("that joint alone", _values(jackknifed, "joint_length_difference"), BLUE),
        ],
        many,
    )
    axes[1].set(xlabel="Length Difference Metric [1]")
    _draw_histograms(
        axes[2],
        _bins(0.05, 1.0),
        [
            ("all joints", _joint_positions(table), GREY),
            (few, _values(jackknifed, "joint_position"), ORANGE),
        ],
        many,
    )
    axes[2].set(xlabel="Joint Position Metric [1]")
    return figure


@sheet
def draw_goal_histograms(table: pa.Table, task: Task = Task()) -> Figure:
    """Compare the goals at the hit: heading difference, distance, and steps since the goal was set.

    A goal is set when every HAV of the episode has hit the previous one, or when the HAV itself
    has, by ``Task.next_goal``.
    """
    goals = goals_of(table.column_names)
    figure, axes = _panels()
    kinds = (
        ("heading_difference", task.heading_tolerance, "Heading difference at hit [rad]"),
        ("distance", task.distance_tolerance, "Distance at hit [m]"),
    )
    for panel, (kind, limit, label) in zip(axes, kinds, strict=False):
        data = [_goal_sample(g, _values(table, f"goal_{g}_{kind}")) for g in goals]
        _draw_histograms(panel, np.linspace(0.0, limit, 26), data, _among(table))
        panel.set(xlabel=label)
    data = [_goal_sample(g, _steps_needed(table, g, task)) for g in goals]
    longest = max(100.0, *(values.max(initial=0.0) for _, values, _ in data))
    bins = np.geomspace(10.0, longest, 31)
    _draw_histograms(axes[2], bins, data, _among(table))
    axes[2].set(xlabel="Steps from goal set to hit [1]", xscale="log")
    return figure


@sheet
def draw_miss_histograms(table: pa.Table, task: Task = Task()) -> Figure:
    """Show the narrowest close misses: heading difference, distance and jackknife weight.

    Each HAV has at most one of either kind for each goal. The upper row shows all, as the paper
    does; most are states on the way to a hit. The lower row shows those of goals that were never
    hit.
    """
    figure, axes = _panels(2)
    columns = (
        ("heading_difference", "Heading difference [rad]", 2 * task.heading_tolerance),
        ("distance", "Distance [m]", 2 * task.distance_tolerance),
        ("jackknife_weight", "Jackknife weight [1]", _MOST_WEIGHT),
    )
    goals = goals_of(table.column_names)
    for column, (measure, label, most) in enumerate(columns):
        for row, missed in enumerate((False, True)):
            data = [_goal_sample(g, _misses(table, g, measure, missed)) for g in goals]
            panel = axes[row, column]
            _draw_histograms(panel, np.linspace(0.0, most, 26), data, _among(table))
            if measure != "jackknife_weight":  # the tolerance is at the middle
                panel.axvline(most / 2, color=LIGHT, lw=0.8, zorder=0)
        axes[1, column].set(xlabel=label)
    for panel, which in zip(axes[:, 0], ("all close misses", "goal never hit"), strict=True):
        panel.set(ylabel=f"{which}\nProbability per bin")
    return figure


def _panels(rows: int = 1) -> tuple[Figure, np.ndarray]:
    """Return a figure and its panels, (3,) or (rows, 3)."""
    figure = new_figure(2.2 * rows)
    axes = figure.subplots(rows, 3, sharex="col")
    axes.flat[0].set(ylabel="Probability per bin")
    return figure, axes


def _bins(width: float, most: float) -> np.ndarray:
    """Return the edges of bins of one width that cover 0 to ``most``."""
    return width * np.arange(max(math.ceil(most / width), 1) + 1)


def _draw_histograms(axes: Axes, bins: np.ndarray, data: Sequence[_Sample], among: str) -> None:
    """Draw the share of each sample in each bin: the first sample filled, the others as lines.

    Values beyond the bins count in the outermost bin; a sample without values is named as absent.
    """
    for k, (name, values, color) in enumerate(data):
        share = np.histogram(np.clip(values, bins[0], bins[-1]), bins)[0] / max(len(values), 1)
        label = f"{name}: n = {len(values):,}" if len(values) else f"{name}: none {among}"
        if k == 0:
            axes.stairs(share, bins, label=label, fill=True, fc=color, alpha=0.45)
        else:
            axes.stairs(share, bins, label=label, lw=1.2, ec=color)
    if any(len(values) for _, values, _ in data):
        axes.margins(y=0.15 * len(data) + 0.05)  # space for the legend
        legend = axes.legend(loc="upper right", borderaxespad=0.0)
        legend.set_in_layout(False)  # the legend lies within the axes
    else:
        text = axes.text(0.5, 0.5, f"none {among}", transform=axes.transAxes, ha="center")
        text.set_bbox({"fc": "white", "ec": "none"})
        axes.set_yticks([])
    axes.set_xlim(bins[0], bins[-1])
    axes.set_ylim(bottom=0.0)


def _values(table: pa.Table, name: str) -> np.ndarray:
    """Return a column without its missing entries."""
    return table[name].drop_null().to_numpy().astype(float)


def _among(table: pa.Table) -> str:
    return f"in {len(table):,} HAVs"


def _goal_sample(goal: int, values: np.ndarray) -> _Sample:
    return f"goal {goal}", values, _GOAL_COLORS[(goal - 1) % len(_GOAL_COLORS)]


def _joint_positions(table: pa.Table) -> np.ndarray:
    """Return the Joint Position Metric of every joint of every HAV."""
    trucks, whole = _values(table, "truck_length"), _values(table, "vehicle_length")
    trailers = table["trailer_lengths"].combine_chunks()
    counts = pc.list_value_length(trailers).to_numpy()
    behind = np.arange(counts.max(initial=0)) < counts[:, np.newaxis]  # (HAVs, joints)
    lengths = np.zeros(behind.shape)
    lengths[behind] = trailers.flatten().to_numpy()
    ahead = np.column_stack([trucks, lengths])[:, : behind.shape[1]]
    return (np.cumsum(ahead, axis=1) / whole[:, np.newaxis])[behind]


def _steps_needed(table: pa.Table, goal: int, task: Task) -> np.ndarray:
    """Return the steps from setting a goal to its hit, of all HAVs that hit it."""
    hit = table.filter(table[f"goal_{goal}_hit"])
    steps = _values(hit, f"goal_{goal}_step")
    if goal == 1:
        return steps
    if task.next_goal == "alone":
        return steps - _values(hit, f"goal_{goal - 1}_step")
    before = hit["episode"].to_numpy()
    table = table.filter(pc.is_in(table["episode"], hit["episode"].combine_chunks()))
    episodes, which = np.unique(table["episode"].to_numpy(), return_inverse=True)
    last = np.zeros(len(episodes))
    np.maximum.at(last, which, table[f"goal_{goal - 1}_step"].to_numpy())
    return steps - last[np.searchsorted(episodes, before)]


def _misses(table: pa.Table, goal: int, measure: str, missed: bool) -> np.ndarray:
    """Return a measure at the narrowest close misses of both kinds.

    Args:
        table: Table of the evaluation.
        goal: Number of the goal.
        measure: End of the column's name.
        missed: Whether to use only HAVs that never hit this goal.
    """
    if missed:
        table = table.filter(pc.invert(table[f"goal_{goal}_hit"]))
    kinds = ("heading", "euclidean")
    return np.concatenate([_values(table, f"goal_{goal}_{k}_miss_{measure}") for k in kinds])
