"""This module draws HAVs into plots: the line of their axles and hitches, or their rectangles."""

from typing import Any

import numpy as np

from baselines.replay.trajectory import Trajectory, body_corners, chain_points, front_points

DARK = "#333333"


def draw_units(axes: Any, trajectory: Trajectory, hav: int, row: int, color: Any) -> None:
    """Draw a HAV in one state, to scale; rectangles are those that collide.

    Args:
        axes: of a plot.
        trajectory: the states.
        hav: which HAV.
        row: which state.
        color: of the truck.
    """
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


def explain_units(trajectory: Trajectory) -> list[dict[str, Any]]:
    """Return the entries of a legend for what ``draw_units`` draws, as arguments of Line2D."""
    if trajectory.shape is None:
        return [{"color": DARK, "lw": 1, "marker": "o", "ms": 2, "label": "trailers and axles"}]
    mark: dict[str, Any] = {"color": DARK, "ls": "", "mew": 0.5}
    axles, hitches = {"marker": "o", "ms": 2}, {"marker": "+", "ms": 4}
    return [mark | axles | {"label": "axles"}, mark | hitches | {"label": "hitches"}]
