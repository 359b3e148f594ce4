"""This module draws the ground: the grid, the trails of the trucks, and obstacles."""

import itertools

import numpy as np

from hav_env.rendering.camera import Camera, clip_segments, round_length
from hav_env.rendering.canvas import Canvas
from hav_env.rendering.colors import GRID, GROUND, INK, RED, color_of, mix
from hav_env.rendering.scene import Scene
from hav_env.world.arrays import NEVER

_CELL = 60.0  # pixels, the least size of a cell of the grid
_FADES = 5  # shades of a trail
_SEGMENT_WIDTH = 2.0  # pixels, breadth of obstacles at any scale: visible gaps stay open


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
    """Draw the past positions of the trucks, fading with age.

    Args:
        canvas: the canvas.
        camera: the view.
        trails: (T, N, 2) [m], oldest first.
        removed: (N,) bool, HAVs without a trail.
    """
    if len(trails) < 2:
        return
    # indistinguishable points cost time
    stride = max(1, int(2.0 / camera.scale))
    points = camera.project(np.concatenate([trails[:-1:stride], trails[-1:]]))
    cuts = np.unique(np.linspace(0, len(points) - 1, _FADES + 1).astype(int))
    for hav in np.flatnonzero(~removed).tolist():
        for k, (first, last) in enumerate(itertools.pairwise(cuts)):
            faded = mix(GROUND, color_of(hav), 0.12 + 0.38 * (k + 1) / (len(cuts) - 1))
            canvas.stroke(points[first : last + 1, hav], faded, 1.5)


def draw_segments(canvas: Canvas, camera: Camera, scene: Scene) -> None:
    """Draw the visible obstacles; those that HAVs hit first are red.

    Args:
        canvas: the canvas.
        camera: the view.
        scene: the scene.
    """
    if not len(scene.segment):
        return
    border = 2.0 * _SEGMENT_WIDTH / camera.scale  # ends of clipped lines are invisible
    low, high = camera.seen()
    seen, parts = clip_segments(scene.segment, low - border, high + border)
    ends = camera.project(parts.reshape(-1, 2)).reshape(-1, 4)
    canvas.lines(ends, INK, _SEGMENT_WIDTH)
    struck = set() if scene.struck is None else set(scene.struck.tolist()) - {NEVER}
    if struck:
        canvas.lines(ends[np.isin(seen, list(struck))], RED, 1.5 * _SEGMENT_WIDTH)
