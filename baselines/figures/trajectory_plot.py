"""This module plots trajectories to scale, and lays out and saves the sheet of a figure."""

import os
import pathlib
from typing import Any

import numpy as np

from baselines.cli.markup import plot_text
from baselines.figures.drawn_havs import DARK, draw_obstacles, draw_units, explain_drawn
from baselines.figures.plot_labels import Label, label_panels
from baselines.figures.representative_episodes import Excerpt, row_of, rows_between
from baselines.replay.trajectory import Trajectory, chain_points, front_points
from baselines.storage.atomic_files import whole_file
from hav_env import Task
from hav_env.rendering.colors import PALETTE, web_color
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
    raise ImportError(
        "figures need matplotlib: run pip install -e '.[plots]' in the clone"
    ) from error

# Okabe and Ito's colours, distinguishable with any colour vision and in grey
BLUE, ORANGE, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#AA4499"
GREY, LIGHT = "#888888", "#CCCCCC"
HAV_COLORS = tuple(web_color(color) for color in PALETTE)  # as in films and pages

_WIDTH = 7.2  # inches, two columns of a paper
_DPI = 160  # resolution of PNG files
_LEGEND_COLUMNS = 3
_MOST_POINTS = 2_000  # largest number of points of a drawn path
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
"""Decorator that gives the figure of a drawing function the common style."""


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
    """Write name.png and name.svg, each atomically; equal figures give equal bytes.

    The layout is computed once for both files: that takes as long as writing one of them.

    Args:
        figure: Figure to write; it keeps its layout from then on.
        folder: Folder of the files, created if necessary.
        name: Name of the files, without a suffix.
        kinds: Kinds of files to write.

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
        trajectory: Episode, with all or some of its steps.
        title: Title above the figure.
        excerpt: Part to draw; by default all of it.
        moments: Number of chains of each HAV to draw, evenly spread over time; near the excerpt's
            moment and new goals, those replace them.
        task: Rules, for the duration of a step and the tolerances of the goals.
    """
    excerpt = excerpt or Excerpt(0, len(trajectory.num_trailers))
    figure = new_figure(4.0)
    axes = figure.add_subplot()
    labels = draw_episode(axes, trajectory, title, excerpt, moments, task)
    handles = explain_episode(trajectory, excerpt, task)
    figure.legend(handles=handles, loc="outside lower center", ncols=_LEGEND_COLUMNS)
    _fit_height(figure, axes, len(handles))
    label_panels({axes: labels})
    return figure


def draw_episode(
    axes: Axes,
    trajectory: Trajectory,
    title: str,
    excerpt: Excerpt,
    moments: int,
    task: Task = Task(),
) -> list[Label]:
    """Draw the content of ``draw_trajectory`` into axes, without a legend; return its labels."""
    rows, moment = rows_between(trajectory, excerpt), row_of(trajectory, excerpt)
    shown = _choose_moments(trajectory, rows, moments, None if excerpt.moment is None else moment)
    poses: list[Label] = []
    times: list[Label] = []
    for hav in range(len(trajectory.num_trailers)):
        poses += _draw_poses(axes, trajectory, hav, rows, task)
        _draw_path(axes, trajectory, hav, rows)
        times += _draw_chains(axes, trajectory, hav, shown, task.dt)
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
    return poses + times


def _choose_moments(
    trajectory: Trajectory, rows: np.ndarray, count: int, moment: int | None
) -> np.ndarray:
    """Return evenly spread rows; the special moment replaces those near it."""
    special = list(rows[1:][(np.diff(trajectory.phase[rows], axis=0) > 0).any(axis=1)])
    special += [] if moment is None else [moment]
    even = rows[np.linspace(0, len(rows) - 1, count).astype(int)]
    gap = 0.5 * len(rows) / max(count - 1, 1)
    clear = [row for row in even if all(abs(row - other) > gap for other in special)]
    return np.unique([*clear, *special, rows[0], rows[-1]])


def _color(hav: int) -> str:
    return HAV_COLORS[hav % len(HAV_COLORS)]


def _footprint_style(hav: int) -> dict[str, Any]:
    return {"fill": False, "ec": _color(hav), "lw": 0.8, "ls": (0, (1, 1.5)), "zorder": 1}


def _path_style(goal: int) -> dict[str, Any]:
    return {"lw": 0.8, "alpha": 0.65, "ls": "-" if goal == 0 else (0, (4, 1.5))}


def _draw_poses(
    axes: Axes, trajectory: Trajectory, hav: int, rows: np.ndarray, task: Task
) -> list[Label]:
    """Draw arrows, 1.5 trucks long, from start and goals, the latter with their tolerances.

    Returns:
        The names of the poses.
    """
    labels = []
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
        aside = 14 * np.array([-ahead[1], ahead[0]])
        labels.append(Label(np.array([x, y]), name, color, aside))
    return labels


def _draw_path(axes: Axes, trajectory: Trajectory, hav: int, rows: np.ndarray) -> None:
    """Draw the path of the truck's rear axle, solid to the first goal, dashed to later ones."""
    for goal in np.unique(trajectory.phase[rows, hav]):
        part = rows[trajectory.phase[rows, hav] == goal]
        part = np.unique([*part[:: len(part) // _MOST_POINTS + 1], part[-1]])
        x, y = trajectory.x[part, hav], trajectory.y[part, hav]
        axes.plot(x, y, color=_color(hav), zorder=2, **_path_style(goal))


def _draw_chains(
    axes: Axes, trajectory: Trajectory, hav: int, shown: np.ndarray, dt: float
) -> list[Label]:
    """Draw a HAV at some moments, each position once; return the times, except for the start's."""
    labels = []
    previous = None
    for row in shown:
        points = chain_points(trajectory, hav, row)
        if previous is not None and np.array_equal(points, previous):
            continue
        previous = points
        draw_units(axes, trajectory, hav, row, _color(hav))
        ahead = (points[0] - points[1]) / trajectory.length[hav, 0]
        overhang = 0.0 if trajectory.shape is None else trajectory.shape[hav, 0, FRONT]
        if trajectory.step[row] > 0:
            text = f"{trajectory.step[row] * dt:.0f} s"
            labels.append(Label(points[0] + overhang * ahead, text, DARK, 9 * ahead))
    return labels


def _fit_height(figure: Figure, axes: Axes, entries: int) -> None:
    """Fit the figure's height to its content and a legend, within limits."""
    axes.margins(0.04)
    box = axes.dataLim
    height = (_WIDTH - 0.8) * box.height / box.width + 0.6
    legend = 0.17 * -(-entries // _LEGEND_COLUMNS) + 0.1
    figure.set_figheight(float(np.clip(height, 2.4, 5.4)) + legend)


def explain_episode(trajectory: Trajectory, excerpt: Excerpt, task: Task = Task()) -> list[Line2D]:
    """Return the entries of a legend for the content of ``draw_episode``."""
    rows = rows_between(trajectory, excerpt)
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
