"""This module draws the figures of docs/safety.md: ``python -m baselines.figures.safety``.

The first figure shows the reserved areas of two HAVs while one gives space to the other. The second
one shows ten HAVs that cross a circle. The third one compares arrival times with AVOID-JACK on the
same episodes.
"""

import dataclasses
import pathlib
import sys

import numpy as np
import pyarrow as pa

from baselines.cli.bounds import check_episodes, check_threads, check_whole
from baselines.figures.drawn_havs import DARK, draw_units
from baselines.figures.reserved_areas import circle_behind, path_ahead, remember, reserved_corners
from baselines.figures.trajectory_plot import (
    BLUE,
    GREY,
    HAV_COLORS,
    LIGHT,
    ORANGE,
    Axes,
    Circle,
    Figure,
    Line2D,
    new_figure,
    save_figure,
    sheet,
)
from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.reserve import Reserve
from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import states
from baselines.policies.reserve.prediction.paths import total_length
from baselines.replay.trajectory import Trajectory, chain_points, record_trajectory
from hav_env import Crossing, RandomPoses, Task
from hav_env.cli.options import run_command
from hav_env.evaluation.rollout import rollout
from hav_env.models.text import visible
from hav_env.scenarios import check_scenario

_FIGURE_SEED = 2026  # seed of all episodes
_PAIR_EPISODE = 29  # episode of a pair in which each HAV blocks the other's path
_MOMENTS = (31.0, 56.0, 240.0)  # [s] moments of that episode
_CROSSING_EPISODE = 2  # episode of HAVs on a circle
_EARLIEST = 5.0  # [s] before the first arrival
_MOST_HAVS, _MOST_STEPS = 1_000, 10**7
_DASHED: dict = {"ls": (0, (4, 1.5)), "lw": 0.8}
_DOTTED: dict = {"ls": (0, (1, 1.2)), "lw": 1.0}
_ARROW: dict = {"ls": "", "marker": r"$\rightarrow$", "ms": 10}
_CHAIN_HANDLE = Line2D(
    [], [], color=DARK, lw=1, marker="o", ms=2, label="trailers and axles; truck: thick"
)


@dataclasses.dataclass(frozen=True)
class Options:
    """Size of the episodes to draw, and folder of the pictures."""

    output: pathlib.Path = pathlib.Path("docs/images")
    """Folder of the pictures, reserve_*.png; existing files are replaced."""
    episodes: int = 500
    """Number of episodes with one HAV, and also with two, whose times are drawn."""
    worlds: int = 40
    """Number of episodes with a swarm whose times are drawn."""
    havs: int = 10
    """Number of HAVs in a swarm, and on the circle."""
    steps: int = Task().max_steps
    """Maximum length of an episode [steps]."""
    threads: int | None = None
    """Number of threads, by default HAV_THREADS or all cores."""


def main(words: list[str] | None = None) -> int:
    """Draw the pictures, and return the exit code. An error is reported in one line."""
    usage, about = "python -m baselines.figures.safety", "Draw the figures of docs/safety.md."
    return run_command(usage, about, Options(), illustrate, words, "no file is partly written")


def illustrate(options: Options) -> str:
    """Draw all pictures, and return the paths of the files, one in each line.

    Raises:
        ValueError: An option is not allowed.
        OSError: The folder cannot be written.
    """
    check_whole("steps", options.steps, 1, _MOST_STEPS)
    check_whole("havs", options.havs, 1, _MOST_HAVS)
    check_scenario(RandomPoses(num_havs=options.havs))
    check_episodes("episodes", options.episodes, 2)
    check_episodes("worlds", options.worlds, options.havs)
    check_threads(options.threads)
    if options.output.exists() and not options.output.is_dir():
        raise ValueError(f"output {options.output} is a file, but must be a folder")
    options.output.mkdir(parents=True, exist_ok=True)  # before the simulation
    task = Task(max_steps=options.steps)
    figures = {
        "reserve_outlines": draw_outlines(task),
        "reserve_roundabout": draw_roundabout(options.havs, task),
        "reserve_times": draw_times(_run(options, task), task),
    }
    names = []
    for name, figure in figures.items():
        names += save_figure(figure, options.output, name, ("png",))
    return "\n".join(visible(str(options.output / name)) for name in names)


def _run(options: Options, task: Task) -> dict[str, list[pa.Table]]:
    """Return the tables of Reserve and of AVOID-JACK by the title of a panel."""
    tables = {}
    for havs, episodes in (
        (1, options.episodes),
        (2, options.episodes),
        (options.havs, options.worlds),
    ):
        scenario, numbers = RandomPoses(num_havs=havs), np.arange(episodes)
        title = f"{havs} HAV{'s' if havs > 1 else ''}, {episodes:,} episodes"
        tables[title] = [
            rollout(policy, scenario, _FIGURE_SEED, numbers, task, threads=options.threads)
            for policy in (Reserve(), AvoidJack())
        ]
    return tables


@sheet
def draw_outlines(task: Task = Task()) -> Figure:
    """Draw a pair of HAVs and what they have reserved at three moments, to scale."""
    scenario = RandomPoses(num_havs=2, num_goals=1)
    trajectory = record_trajectory(Reserve(), scenario, _FIGURE_SEED, _PAIR_EPISODE, task)
    memories = remember(Reserve(), scenario, _FIGURE_SEED, _PAIR_EPISODE, task)
    figure = new_figure(3.6)
    figure.set_layout_engine("constrained", h_pad=0.1)
    panels = figure.subplots(1, len(_MOMENTS), sharex=True, sharey=True)
    for axes, moment in zip(panels, _MOMENTS, strict=True):
        state = min(round(moment / task.dt), len(memories) - 1)
        axes.set_title(f"{state * task.dt:.0f} s", pad=25)
        for hav in range(2):
            _draw_reserved(axes, trajectory, hav, state, memories[state, hav])
            text = f"HAV {hav} {_doing(trajectory, memories[state, hav], hav, state)}"
            above: dict = {"xytext": (0, 15 - 10 * hav), "textcoords": "offset points"}
            above |= {"xycoords": "axes fraction", "fontsize": 7, "ha": "center"}
            axes.annotate(text, (0.5, 1.0), color=HAV_COLORS[hav], **above)
        axes.set(xlabel="x [m]", aspect="equal")
    panels[0].set(ylabel="y [m]")
    square: dict = {"ls": "", "marker": "s", "ms": 8, "mfc": LIGHT, "mec": GREY}
    handles = [
        _CHAIN_HANDLE,
        Line2D([], [], label="reserved: the outline that is broadcast", **square),
        Line2D([], [], color=GREY, label="circle to drive on without end, reserved too", **_DASHED),
        Line2D([], [], color=GREY, label="planned path, to be reserved part by part", **_DOTTED),
        Line2D([], [], color=GREY, label="truck at its goal", **_ARROW),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return figure


def _doing(trajectory: Trajectory, rows: np.ndarray, hav: int, state: int) -> str:
    """Return the activity of a HAV in a state with the memory ``rows``."""
    if trajectory.waiting[state, hav]:
        return "has arrived"
    if rows[m.MODE] != states.RESERVED:
        return "stands, nothing reserved"
    if trajectory.speed[max(state - 1, 0), hav] == 0.0:
        return "waits for its next part"
    if rows[m.PURPOSE] == states.CIRCLE_PATH:
        return "drives round its circle"
    if rows[m.CIRCLE_SIDE] == 0.0:
        return "drives the rest to its goal"
    return "drives a part of its path"


def _draw_reserved(
    axes: Axes, trajectory: Trajectory, hav: int, state: int, rows: np.ndarray
) -> None:
    """Draw a HAV, its goal, its path, and its reserved area."""
    color = HAV_COLORS[hav]
    pose = trajectory.x[state, hav], trajectory.y[state, hav], trajectory.heading[state, hav, 0]
    corners, circle = reserved_corners(rows, *pose), circle_behind(rows, *pose)
    if corners is not None:
        axes.fill(*corners.T, fc=color, alpha=0.2, zorder=1)
        axes.fill(*corners.T, fill=False, ec=color, lw=0.8, zorder=2)
        if rows[m.PURPOSE] == states.GOAL_PATH:
            path = path_ahead(rows, *pose, total_length(rows, m.CURRENT_PATH))
            axes.plot(*path[:, :2].T, color=color, zorder=2, **_DOTTED)
    if circle is not None:
        (x, y), radius = circle
        axes.add_patch(Circle((x, y), radius, fill=False, ec=color, zorder=2, **_DASHED))
    _draw_chain(axes, trajectory, hav, state, color)
    _draw_goal(axes, trajectory, hav, color, trajectory.length[hav, 0])


def _draw_chain(axes: Axes, trajectory: Trajectory, hav: int, state: int, color) -> None:
    """Draw a HAV with its number in front."""
    points = chain_points(trajectory, hav, state)
    draw_units(axes, trajectory, hav, state, color)
    ahead = points[0] - points[1]
    beside: dict = {"xytext": 8 * ahead / np.hypot(*ahead), "textcoords": "offset points"}
    style: dict = {"color": color, "fontsize": 7, "ha": "center", "va": "center", "zorder": 6}
    box = {"boxstyle": "round,pad=0.05", "fc": "white", "ec": "none", "alpha": 0.75}
    axes.annotate(str(hav), points[0], bbox=box, **beside, **style)


def _draw_goal(axes: Axes, trajectory: Trajectory, hav: int, color, length: float) -> None:
    """Draw an arrow from the goal position of the truck's rear axle."""
    x, y, heading = trajectory.goals[hav, 0]
    ahead = length * np.array([np.cos(heading), np.sin(heading)])
    style: dict = {"angles": "xy", "scale_units": "xy", "scale": 1, "units": "inches"}
    axes.quiver(x, y, *ahead, color=color, width=0.018, zorder=3, **style)


@sheet
def draw_roundabout(havs: int = 10, task: Task = Task()) -> Figure:
    """Draw HAVs that cross a circle to the opposite side, at four moments, to scale."""
    scenario = Crossing(num_havs=havs)
    trajectory = record_trajectory(Reserve(), scenario, _FIGURE_SEED, _CROSSING_EPISODE, task)
    colors = [HAV_COLORS[hav % len(HAV_COLORS)] for hav in range(havs)]
    figure = new_figure(6.9, 6.4)
    panels = figure.subplots(2, 2, sharex=True, sharey=True)
    moments = np.linspace(0, len(trajectory.step) - 1, panels.size + 1).astype(int)
    for first, state, axes in zip(moments, moments[1:], panels.flat, strict=False):
        arrived = np.count_nonzero(trajectory.waiting[state])
        span = f"{first * task.dt:.0f} s to {state * task.dt:.0f} s"
        axes.set_title(f"{span}: {arrived} of {havs} have arrived")
        for hav, color in enumerate(colors):
            driven = slice(first, state + 1)
            axes.plot(trajectory.x[driven, hav], trajectory.y[driven, hav], color=color, lw=0.8)
            _draw_chain(axes, trajectory, hav, state, color)
            _draw_goal(axes, trajectory, hav, color, 0.1 * trajectory.x[0, 0])
        axes.update_datalim(np.array([[-1.0], [1.0]]) * np.full(2, trajectory.x[0, 0]))
        axes.set(aspect="equal")
        axes.margins(0.08)
    for below, left in zip(panels[1], panels[:, 0], strict=True):
        below.set(xlabel="x [m]")
        left.set(ylabel="y [m]")
    handles = [
        _CHAIN_HANDLE,
        Line2D([], [], color=GREY, lw=0.8, label="truck's path in these seconds"),
        Line2D([], [], color=GREY, label="goal, opposite the start", **_ARROW),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return figure


@sheet
def draw_times(tables: dict[str, list[pa.Table]], task: Task = Task()) -> Figure:
    """Draw the share of HAVs that have arrived at their first goal, over time.

    Args:
        tables: Tables of Reserve and AVOID-JACK on the same episodes, by the title of their panel.
        task: Rules of the episodes.
    """
    figure = new_figure(2.5)
    panels = figure.subplots(1, len(tables), sharex=True, sharey=True)
    last = task.max_steps * task.dt
    for axes, (title, both) in zip(panels, tables.items(), strict=True):
        axes.axhline(100.0, color=LIGHT, lw=0.8, zorder=0)
        for table, name, color in zip(both, ("Reserve", "AVOID-JACK"), (BLUE, ORANGE), strict=True):
            times = np.sort(task.dt * table["goal_1_step"].drop_null().to_numpy())
            shares = 100.0 * np.arange(len(times) + 1) / len(table)
            axes.step([*times, last], shares, color=color, lw=1.4, label=name, where="pre")
            beside: dict = {"xytext": (3, 0), "textcoords": "offset points", "va": "center"}
            end = (last, shares[-1])
            axes.annotate(f"{shares[-1]:.1f} %", end, color=color, fontsize=7, **beside)
        limits: dict = {"xlim": (min(_EARLIEST, 0.5 * last), last), "ylim": (0, 105)}
        axes.set(title=title, xscale="log", xlabel="Time [s]", **limits)
        axes.xaxis.set_major_formatter("{x:,.0f}")
    panels[0].set(ylabel="HAVs that have reached\ntheir first goal [%]")
    panels[-1].legend(loc="upper left", bbox_to_anchor=(0.0, 0.92), borderaxespad=0.2)
    return figure


if __name__ == "__main__":
    sys.exit(main())
