"""This module plots trajectories to scale, and lays out and saves the sheet of a figure."""

import os
import pathlib
from typing import Any

import numpy as np

from baselines.cli.markup import plot_text
from baselines.figures.drawn_havs import DARK, draw_obstacles, draw_units, explain_drawn
from baselines.figures.representative_episodes import Excerpt
from baselines.replay.trajectory import Trajectory, chain_points, front_points
from baselines.storage.atomic_files import whole_file
from hav_env import Task
from hav_env.world.arrays import JACKKNIFE
from hav_env.world.event_table import EVENTS
from hav_env.world.units.parts import FRONT

try:
    import matplotlib as mpl
    from matplotlib.axes import Axes
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import PolyCollection  # noqa: F401  (for other figures)
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Circle, Wedge
except ImportError as error:
    raise ImportError("figures need matplotlib: pip install 'hav_env[plots]'") from error

# Okabe and Ito's colours, told apart with any colour vision and in grey
BLUE, ORANGE, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#AA4499"
GREY, LIGHT = "#888888", "#CCCCCC"
HAV_COLORS = (BLUE, ORANGE, GREEN, PURPLE)

_WIDTH = 7.2  # inches, two columns of a paper
_DPI = 160  # of PNG files
_MOST_POINTS = 2_000  # of a drawn path
sheet = mpl.rc_context(
    {
        "font.size": 8,
        "axes.titlesize": 8,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.linewidth": 0.6,
        "axes.labelsize": 8,
        "legend.frameon": False,
        "legend.fontsize": 7,
        "legend.handlelength": 1.8,
        "xtick.labelsize": 7,
        "ytick.labelsize": 7,
        "xtick.major.width": 0.6,
        "ytick.major.width": 0.6,
    }
)
"""Decorates a function that draws, to give its figure the common style."""


def new_figure(height: float, width: float = _WIDTH) -> Figure:
    """Return an empty figure [inches]."""
    figure = Figure(figsize=(width, height), dpi=_DPI, layout="constrained")
    FigureCanvasAgg(figure)  # measures text as PNG files show it
    return figure


def save_figure(
    figure: Figure,
    folder: str | os.PathLike,
    name: str,
    kinds: tuple[str, ...] = ("png", "svg"),
) -> list[str]:
    """Write name.png and name.svg, each whole or not at all; equal figures give equal bytes.

    The figure is laid out once, for both files: that takes as long as writing one of them.

    Args:
        figure: figure to write; it keeps its layout from then on.
        folder: where to; it is made.
        name: of the files, without a suffix.
        kinds: which of the two files.

    Returns:
        The names of the files.
    """
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    # the salt makes identifiers in an SVG file reproducible
    options: dict[str, dict[str, Any]] = {
        "png": {"dpi": _DPI, "metadata": {"Software": None}},
        "svg": {"metadata": {"Date": None, "Creator": None}},
    }
    layout = figure.get_layout_engine()
    if layout is not None:
        layout.execute(figure)
        figure.set_layout_engine(None)  # a placeholder, "none", would draw before every file
    names = []
    for kind in kinds:
        names.append(f"{name}.{kind}")
        with (
            whole_file(folder / names[-1]) as unfinished,
            mpl.rc_context({"svg.hashsalt": "hav_env"}),
        ):
            figure.savefig(unfinished, format=kind, **options[kind])
    return names


@sheet
def draw_trajectory(
    trajectory: Trajectory,
    title: str,
    excerpt: Excerpt | None = None,
    moments: int = 5,
    task: Task = Task(),
) -> Figure:
    """Draw the paths of the trucks, their chains at some moments, start and goals; to scale.

    Args:
        trajectory: an episode, all steps of it or some.
        title: stands above.
        excerpt: the part to draw; by default all of it.
        moments: how many chains of each HAV to draw, evenly spread over time; near the excerpt's
            moment and new goals, those instead.
        task: for the duration of a step and the tolerances of the goals.
    """
    excerpt = excerpt or Excerpt(0, len(trajectory.num_trailers))
    rows = _rows_between(trajectory, excerpt)
    figure = new_figure(4.0)
    axes = figure.add_subplot()
    draw_episode(axes, trajectory, title, excerpt, moments, task)
    _fit_height(figure, axes)
    figure.legend(handles=_legend(trajectory, rows, excerpt, task), loc="outside right upper")
    return figure


def draw_episode(
    axes: Axes,
    trajectory: Trajectory,
    title: str,
    excerpt: Excerpt,
    moments: int,
    task: Task = Task(),
) -> None:
    """Draw what ``draw_trajectory`` draws into axes, without a legend."""
    rows, moment = _rows_between(trajectory, excerpt), _row_of(trajectory, excerpt)
    shown = _choose_moments(trajectory, rows, moments, None if excerpt.moment is None else moment)
    for hav in range(len(trajectory.num_trailers)):
        _draw_poses(axes, trajectory, hav, rows, task)
        _draw_path(axes, trajectory, hav, rows)
        _draw_chains(axes, trajectory, hav, shown, task.dt)
        if excerpt.evading:
            center = trajectory.x[moment, hav], trajectory.y[moment, hav]
            axes.add_patch(Circle(center, trajectory.footprint[hav], **_footprint_style(hav)))
    draw_obstacles(axes, trajectory, int(trajectory.step[rows[-1]]))
    if excerpt.joint is not None:
        hav, joint = excerpt.joint
        x, y = front_points(trajectory, hav, moment)[joint]
        axes.plot(x, y, "o", ms=13, mfc="none", mec=DARK, mew=1.2, zorder=6)
    axes.set(xlabel="x [m]", ylabel="y [m]", title=plot_text(title))
    axes.set_aspect("equal", adjustable="datalim")


def _rows_between(trajectory: Trajectory, excerpt: Excerpt) -> np.ndarray:
    last = trajectory.step[-1] if excerpt.last is None else excerpt.last
    kept = (trajectory.step >= excerpt.first) & (trajectory.step <= last)
    if not kept.any():
        raise ValueError(f"no state was kept from step {excerpt.first} to {last}")
    return np.flatnonzero(kept)


def _choose_moments(
    trajectory: Trajectory, rows: np.ndarray, count: int, moment: int | None
) -> np.ndarray:
    """Return rows evenly spread, those near a special one replaced by it."""
    special = list(rows[1:][(np.diff(trajectory.phase[rows], axis=0) > 0).any(axis=1)])
    special += [] if moment is None else [moment]
    even = rows[np.linspace(0, len(rows) - 1, count).astype(int)]
    gap = 0.5 * len(rows) / max(count - 1, 1)
    clear = [row for row in even if all(abs(row - other) > gap for other in special)]
    return np.unique([*clear, *special, rows[0], rows[-1]])


def _row_of(trajectory: Trajectory, excerpt: Excerpt) -> int:
    """Return the row of the excerpt's moment, or of the nearest state after it that was kept."""
    row = int(np.searchsorted(trajectory.step, excerpt.moment or 0))
    return min(row, len(trajectory.step) - 1)


def _color(hav: int) -> str:
    return HAV_COLORS[hav % len(HAV_COLORS)]


def _footprint_style(hav: int) -> dict[str, Any]:
    return {"fill": False, "ec": _color(hav), "lw": 0.8, "ls": (0, (1, 1.5)), "zorder": 1}


def _path_style(goal: int) -> dict[str, Any]:
    return {"lw": 0.8, "alpha": 0.65, "ls": "-" if goal == 0 else (0, (4, 1.5))}


def _label(axes: Axes, place, text: str, color: str, offset: np.ndarray) -> None:
    """Write beside a place, ``offset`` in points, on a ground that lets it be read on lines."""
    box = {"boxstyle": "round,pad=0.1", "fc": "white", "ec": "none", "alpha": 0.75}
    beside: dict[str, Any] = {"xytext": offset.tolist(), "textcoords": "offset points"}
    style: dict[str, Any] = {
        "color": color,
        "fontsize": 6.5,
        "ha": "center",
        "va": "center",
        "zorder": 7,
    }
    axes.annotate(text, place, bbox=box, **beside, **style)


def _draw_poses(axes: Axes, trajectory: Trajectory, hav: int, rows: np.ndarray, task: Task) -> None:
    """Draw arrows, 1.5 trucks long, from start and goals, the latter with their tolerances."""
    color, truck = _color(hav), trajectory.length[hav, 0]
    style: dict[str, Any] = {
        "angles": "xy",
        "scale_units": "xy",
        "scale": 1,
        "units": "inches",
        "width": 0.018,
    }
    under_way = np.unique(trajectory.phase[rows, hav])
    poses = {f"goal {g + 1}": trajectory.goals[hav, g] for g in under_way}
    if trajectory.step[rows[0]] == 0:
        x, y, heading = trajectory.x, trajectory.y, trajectory.heading
        poses["start"] = np.array([x[0, hav], y[0, hav], heading[0, hav, 0]])
    for name, (x, y, heading) in poses.items():
        ahead = np.array([np.cos(heading), np.sin(heading)])
        if name != "start":
            sides = np.degrees(heading + task.heading_tolerance * np.array([-1, 1]))
            axes.add_patch(Wedge((x, y), 1.5 * truck, *sides, fc=color, alpha=0.25, zorder=2))
            axes.add_patch(Circle((x, y), task.distance_tolerance, fc=color, alpha=0.5, zorder=2))
        axes.quiver(x, y, *(1.5 * truck * ahead), color=color, zorder=3, **style)
        _label(axes, (x, y), name, color, 14 * np.array([-ahead[1], ahead[0]]))


def _draw_path(axes: Axes, trajectory: Trajectory, hav: int, rows: np.ndarray) -> None:
    """Draw where the truck's rear axle went, solid to the first goal, dashed to later ones."""
    for goal in np.unique(trajectory.phase[rows, hav]):
        part = rows[trajectory.phase[rows, hav] == goal]
        part = np.unique([*part[:: len(part) // _MOST_POINTS + 1], part[-1]])
        x, y = trajectory.x[part, hav], trajectory.y[part, hav]
        axes.plot(x, y, color=_color(hav), zorder=2, **_path_style(goal))


def _draw_chains(
    axes: Axes, trajectory: Trajectory, hav: int, shown: np.ndarray, dt: float
) -> None:
    """Draw a HAV at some moments, each place once, with the time."""
    previous = None
    for row in shown:
        points = chain_points(trajectory, hav, row)
        if previous is not None and np.array_equal(points, previous):
            continue
        previous = points
        draw_units(axes, trajectory, hav, row, _color(hav))
        ahead = (points[0] - points[1]) / trajectory.length[hav, 0]
        overhang = 0.0 if trajectory.shape is None else trajectory.shape[hav, 0, FRONT]
        text = f"{trajectory.step[row] * dt:.0f} s"
        _label(axes, points[0] + overhang * ahead, text, DARK, 9 * ahead)


def _fit_height(figure: Figure, axes: Axes) -> None:
    """Make the figure as high as what it shows, within reason."""
    axes.margins(0.04)
    box = axes.dataLim
    figure.set_figheight(float(np.clip((_WIDTH - 2.2) * box.height / box.width + 0.6, 2.4, 6.0)))


def _legend(trajectory: Trajectory, rows: np.ndarray, excerpt: Excerpt, task: Task) -> list[Line2D]:
    handles = []
    line = _color(0) if len(trajectory.num_trailers) == 1 else DARK
    for hav, trailers in enumerate(trajectory.num_trailers):
        name = f"truck, {trailers} trailer{'' if trailers == 1 else 's'}"
        if len(trajectory.num_trailers) > 1:
            name = f"HAV {hav}: {name}"
        handles.append(Line2D([], [], color=_color(hav), lw=2.8, label=name))
    last = int(trajectory.step[rows[-1]])
    handles += [Line2D([], [], **style) for style in explain_drawn(trajectory, last)]
    for goal in np.unique(trajectory.phase[rows]):
        label = f"truck's path to goal {goal + 1}"
        handles.append(Line2D([], [], color=line, label=label, **_path_style(goal)))
    tolerance = f"goal pose ± {task.distance_tolerance} m, {task.heading_tolerance} rad"
    handles.append(
        Line2D([], [], color=GREY, ls="", marker=r"$\rightarrow$", ms=10, label=tolerance)
    )
    if excerpt.evading:
        label = f"footprints at {(excerpt.moment or 0) * task.dt:.0f} s"
        handles.append(Line2D([], [], color=line, lw=0.8, ls=(0, (1, 1.5)), label=label))
    if excerpt.joint is not None:
        label = f"first {EVENTS[JACKKNIFE].stem}, joint {excerpt.joint[1]}"
        style: dict[str, Any] = {"ls": "", "marker": "o", "ms": 9, "mfc": "none", "mec": DARK}
        handles.append(Line2D([], [], label=label, **style))
    return handles
