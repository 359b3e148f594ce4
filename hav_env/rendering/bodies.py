"""This module draws HAVs whose bodies are rectangles, with the shapes that collide.

Turned wheels, the steered ones and those of drawbars, may stick out a little.
"""

import math

import numpy as np

from hav_env.rendering.camera import Camera, box
from hav_env.rendering.canvas import Canvas
from hav_env.rendering.colors import INK, PAPER, color_of, mix
from hav_env.rendering.scene import Scene, chain_of, outlines_of
from hav_env.world.units.parts import HALF_WIDTH

_DRAWBAR = 0.35  # [m] half of a width up to which a unit is a drawbar
_CAB, _PANE = 2.2, 0.5  # [m] lengths
_WHEEL, _TYRE = 0.55, 0.16  # [m] halves of length and breadth


def draw_bodies(canvas: Canvas, camera: Camera, scene: Scene, hav: int, near: bool) -> None:
    """Draw the rectangles of a HAV from front to rear, drawbars below the others.

    Args:
        canvas: the unfinished picture.
        camera: the view.
        scene: the scene; its bodies are rectangles.
        hav: number of the HAV.
        near: whether wheels and cabs are large enough to see.
    """
    outlines = outlines_of(scene, hav)
    assert scene.shape is not None
    assert outlines is not None
    color, units = color_of(hav), range(1, scene.num_trailers[hav] + 1)
    corners = camera.project(outlines)
    half = scene.shape[hav, :, HALF_WIDTH]
    bars = [unit for unit in units if half[unit] <= _DRAWBAR]
    for unit in bars:
        canvas.fill(corners[unit], mix(color, INK, 0.45))
    if near:
        _draw_truck(canvas, camera, scene, hav, corners[0])
    else:
        canvas.fill(corners[0], color)
    axles, widest = chain_of(scene, hav)[1:], float(half[: len(corners)].max())
    for unit in units:
        pose = *axles[unit], scene.heading[hav, unit]
        if unit not in bars:
            canvas.fill(corners[unit], mix(color, PAPER, 0.62 if near else 0.4))
            if near:
                _draw_wheels(canvas, camera, pose, half[unit])
                canvas.outline(corners[unit], color, 1.0)
    for unit in bars if near else ():  # its wheels are below the body behind it
        pose = *axles[unit], scene.heading[hav, unit]
        _draw_wheels(canvas, camera, pose, widest)


def _draw_truck(canvas: Canvas, camera: Camera, scene: Scene, hav: int, corners) -> None:
    """Draw a deck with a cab in front; the front wheels are steered."""
    assert scene.shape is not None
    color, (half, ahead, behind) = color_of(hav), scene.shape[hav, 0]
    length, heading = scene.length[hav, 0], scene.heading[hav, 0]
    x, y = scene.x[hav], scene.y[hav]
    nose = length + ahead
    cab = nose - min(_CAB, 0.45 * (nose + behind))
    canvas.fill(corners, mix(color, INK, 0.45))
    canvas.fill(camera.place((x, y, heading), box(cab, nose, half)), color)
    pane = box(max(nose - 2.0 * _PANE, cab), max(nose - _PANE, cab), 0.8 * half)
    canvas.fill(camera.place((x, y, heading), pane), mix(color, PAPER, 0.85))
    front = x + length * math.cos(heading), y + length * math.sin(heading), heading
    _draw_wheels(canvas, camera, (x, y, heading), half)
    _draw_wheels(canvas, camera, front, half, scene.steering[hav])
    canvas.outline(corners, mix(color, INK, 0.5), 1.0)


def _draw_wheels(canvas: Canvas, camera: Camera, pose: tuple, half: float, turn: float = 0.0):
    """Draw a pair of wheels on an axle at a pose, turned against it, inside half a width [m]."""
    x, y, heading = pose
    wheel = box(-min(_WHEEL, 0.45 * half), min(_WHEEL, 0.45 * half), min(_TYRE, 0.13 * half))
    tyre = wheel[2, 1]
    aside = (half - tyre) * np.array([-math.sin(heading), math.cos(heading)])
    for side in (-1.0, 1.0):
        center = side * aside
        place = x + center[0], y + center[1], heading + turn
        canvas.fill(camera.place(place, wheel), INK)
