"""This module draws HAVs and obstacles into plots: lines of axles and hitches, or rectangles."""

from typing import Any

import numpy as np

from baselines.replay.trajectory import Trajectory, body_corners, chain_points, front_points
from hav_env.rendering.colors import pattern_of
from hav_env.rendering.scene import struck_in
from hav_env.world.arrays import NEVER, OBSTACLE, WHEN

DARK = "#333333"
_PATTERN_LINES: dict[str, Any] = {"stripe": "-", "dashes": (0, (2, 2.5)), "dots": (0, (0.1, 2.5))}
_ALERT = "#B0003A"
_OBSTACLES: dict[str, Any] = {"color": DARK, "lw": 1.2, "label": "obstacles"}
_STRUCK: dict[str, Any] = {"color": _ALERT, "lw": 2.0, "label": "obstacle that was hit"}


def draw_units(axes: Any, trajectory: Trajectory, hav: int, row: int, color: Any) -> None:
    """Draw a HAV in one state, to scale, with the rectangles that collide.

    Args:
        axes: Axes of a plot.
        trajectory: Trajectory with the states.
        hav: Index of the HAV.
        row: Index of the state.
        color: Colour of the truck.
    """
    _draw_pattern(axes, chain_points(trajectory, hav, row)[:2], hav)
    points, fronts = chain_points(trajectory, hav, row), front_points(trajectory, hav, row)
    corners = body_corners(trajectory, hav, row)
    if corners is not None:
        for unit, outline in enumerate(corners):
            axes.fill(*outline.T, fc=color if unit == 0 else "white", alpha=0.75, zorder=4)
            axes.fill(*outline.T, fill=False, ec=DARK, lw=0.6, zorder=4.5)
        axes.plot(*points[1:].T, "o", color=DARK, ms=1.2, zorder=5)
        axes.plot(*fronts[1:].T, "+", color=DARK, ms=3, mew=0.5, zorder=5)
        return
    if trajectory.offset[hav].any():
        line = np.stack([fronts, points[1:]], axis=1).reshape(-1, 2)[1:]
        axes.plot(*line.T, "-", color=DARK, lw=1.0, zorder=4)
        axes.plot(*points[1:].T, "o", color=DARK, ms=2, zorder=4)
    else:
        axes.plot(*points[1:].T, "-o", color=DARK, lw=1.0, ms=2, zorder=4)
    axes.plot(*points[:2].T, "-", color=color, lw=2.8, zorder=5, solid_capstyle="butt")


def _draw_pattern(axes: Any, truck: np.ndarray, hav: int) -> None:
    """Draw the pattern of a HAV on its truck, given the truck's axles (2, 2)."""
    style = _PATTERN_LINES.get(pattern_of(hav))
    if style is not None:
        axes.plot(*truck.T, ls=style, color="white", lw=1.0, zorder=5.2, dash_capstyle="round")


def draw_obstacles(axes: Any, trajectory: Trajectory, last: int) -> None:
    """Draw all obstacles; distant ones do not widen the axes.

    Args:
        axes: Axes of a plot.
        trajectory: Trajectory with the states.
        last: Last step; obstacles that HAVs have hit by then have another colour.
    """
    if len(trajectory.segment):
        from matplotlib.collections import LineCollection  # noqa: PLC0415  others say it is missing

        lines, struck = trajectory.segment.reshape(-1, 2, 2), _struck(trajectory, last)
        for chosen, style in ((lines, _OBSTACLES), (lines[struck], _STRUCK)):
            axes.add_collection(LineCollection(list(chosen), zorder=5.5, **style), autolim=False)


def explain_drawn(trajectory: Trajectory, last: int) -> list[dict[str, Any]]:
    """Return the entries of a legend for the drawn elements, as arguments of Line2D.

    Args:
        trajectory: Trajectory with the states.
        last: Last step, see ``draw_obstacles``.
    """
    obstacles = [_OBSTACLES] * (len(trajectory.segment) > 0)
    obstacles += [_STRUCK] * bool(_struck(trajectory, last))
    if trajectory.shape is None:
        line = {"color": DARK, "lw": 1, "marker": "o", "ms": 2, "label": "trailers and axles"}
        return [line, *obstacles]
    mark: dict[str, Any] = {"color": DARK, "ls": "", "mew": 0.5}
    axles, hitches = {"marker": "o", "ms": 2}, {"marker": "+", "ms": 4}
    return [mark | axles | {"label": "axles"}, mark | hitches | {"label": "hitches"}, *obstacles]


def _struck(trajectory: Trajectory, last: int) -> list[int]:
    """Return the obstacles that HAVs hit first until a step."""
    struck = struck_in(trajectory.first)
    if struck is None:
        return []
    when = trajectory.first[:, OBSTACLE, WHEN]
    return np.unique(struck[(when != NEVER) & (when <= last)]).tolist()
