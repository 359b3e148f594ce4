"""This module draws a site without a window: forbidden areas are dark."""

import pathlib
from typing import Any

import numpy as np

from hav_env.places import BOUNDARY, Site, chains_of
from hav_env.places.areas import covered_area, free_area
from hav_env.places.libraries import import_maps
from hav_env.rendering.camera import Camera
from hav_env.rendering.canvas import Canvas
from hav_env.rendering.colors import CALM, DIM, GROUND, INK, PALE, PAPER, Color
from hav_env.rendering.ground import draw_grid, grid_spacing

_WIDTH, _MARGIN = 1200, 40  # pixels
_LOWEST, _HIGHEST = 300, 1600  # pixels of height


def save_picture(site: Site, name: str, path: pathlib.Path) -> None:
    """Write a picture of a site as PNG.

    Args:
        site: a site with at least one segment.
        name: name of the site, shown in the picture.
        path: path of the picture.

    Raises:
        ImportError: If the extra ``maps`` or ``rendering`` is missing.
        OSError: If the picture cannot be written.
    """
    import_maps("PIL.Image").fromarray(draw_site(site, name)).save(path)


def draw_site(site: Site, name: str) -> np.ndarray:
    """Return a picture of a site, (height, width, 3) uint8.

    Args:
        site: a site with at least one segment.
        name: name of the site, shown in the picture.

    Raises:
        ImportError: If the extra ``maps`` or ``rendering`` is missing.
    """
    low, high = np.array(site.bounds).reshape(2, 2)
    tall, wide = high[::-1] - low[::-1]
    shown = (_WIDTH - 2 * _MARGIN) * tall / max(wide, 1e-9) + 2 * _MARGIN
    canvas = Canvas((_WIDTH, int(np.clip(shown, _LOWEST, _HIGHEST))))
    camera = Camera(canvas.size, 0.0, 1.0)
    camera.aim(low, high, _MARGIN)
    canvas.clear()
    free = free_area(site)
    if free is not None:
        everything = np.array([(0, 0), (1, 0), (1, 1), (0, 1)]) * canvas.size
        canvas.fill(everything, PALE)
        _fill(canvas, camera, free, PAPER, PALE)
    draw_grid(canvas, camera)
    covered = covered_area(site)
    _fill(canvas, camera, covered, CALM, GROUND if free is None else PAPER)
    for kind, points in chains_of(site):
        canvas.stroke(camera.project(points), INK, 3.0 if kind == BOUNDARY else 1.5)
    canvas.shrink()
    canvas.text(f"{name}    one cell of the grid is {grid_spacing(camera):g} m", (12, 8), 20, DIM)
    return canvas.frame()


def _fill(canvas: Canvas, camera: Camera, area: Any, color: Color, beyond: Color) -> None:
    """Fill an area, the largest polygons first: smaller ones may lie in their holes."""
    parts = [part for part in getattr(area, "geoms", [area]) if part.geom_type == "Polygon"]
    for part in sorted(parts, key=lambda part: -part.envelope.area):
        if part.is_empty:
            continue
        canvas.fill(camera.project(np.asarray(part.exterior.coords)), color)
        for hole in part.interiors:
            canvas.fill(camera.project(np.asarray(hole.coords)), beyond)
