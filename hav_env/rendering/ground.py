"""This module draws the ground below the HAVs: the grid, and the trails of the trucks."""

import itertools

import numpy as np

from hav_env.rendering.camera import Camera, round_length
from hav_env.rendering.canvas import Canvas
from hav_env.rendering.colors import GRID, GROUND, color_of, mix

_CELL = 60.0  # pixels, the least size of a cell of the grid
_FADES = 5  # shades of a trail


def grid_spacing(camera: Camera) -> float:
    """Return the side of a cell of the grid [m], which is also the length of the scale bar."""
    return round_length(_CELL / camera.scale)


def draw_grid(canvas: Canvas, camera: Camera) -> None:
    """Draw lines at whole multiples of the spacing."""
    spacing, (low, high) = grid_spacing(camera), camera.seen()
    for axis in (0, 1):
        first, last = np.ceil(low[axis] / spacing), np.floor(high[axis] / spacing)
        for place in spacing * np.arange(first, last + 1):
            ends = np.array([low, high])
            ends[:, axis] = place
            canvas.stroke(camera.project(ends), GRID, 1.0)


def draw_trails(canvas: Canvas, camera: Camera, trails: np.ndarray, removed: np.ndarray) -> None:
    """Draw where the trucks were, fading with age.

    Args:
        canvas: what to draw on.
        camera: the view.
        trails: (T, N, 2) [m], oldest first.
        removed: (N,) bool: these are passed over.
    """
    if len(trails) < 2:
        return
    # points closer than can be told take time
    stride = max(1, int(2.0 / camera.scale))
    points = camera.project(np.concatenate([trails[:-1:stride], trails[-1:]]))
    cuts = np.unique(np.linspace(0, len(points) - 1, _FADES + 1).astype(int))
    for hav in np.flatnonzero(~removed).tolist():
        for k, (first, last) in enumerate(itertools.pairwise(cuts)):
            faded = mix(GROUND, color_of(hav), 0.12 + 0.38 * (k + 1) / (len(cuts) - 1))
            canvas.stroke(points[first : last + 1, hav], faded, 1.5)
