"""This module draws marks around the HAVs: goals, footprints, evasions."""

import numpy as np

from hav_env.rendering.camera import Camera, box
from hav_env.rendering.canvas import Canvas
from hav_env.rendering.colors import EVASION, GROUND, INK, PAPER, RED, color_of, mix
from hav_env.rendering.scene import Scene, distance_shown
from hav_env.rendering.vehicles import NUMBERED, TAG, breadth_of, overhang_of
from hav_env.world.units.parts import HALF_WIDTH, REAR

_WORDS_FIT = 3.0  # pixels per metre from which words fit


def draw_goal(canvas: Canvas, camera: Camera, scene: Scene, hav: int) -> None:
    """Draw the current goal pose: a truck's outline with an arrow, and the HAV's number."""
    color, (x, y, heading) = color_of(hav), scene.goal[hav]
    length = max(scene.length[hav, 0], 13.0 / camera.scale)  # keep small ones visible
    half = max(0.5 * breadth_of(scene, hav), 3.5 / camera.scale)
    outline = -0.8 * half, length + 0.2 * half, half
    if scene.shape is not None:
        broad = max(scene.shape[hav, 0, HALF_WIDTH], 3.5 / camera.scale)
        outline = -scene.shape[hav, 0, REAR], length + overhang_of(scene, hav), broad
    ghost = camera.place((x, y, heading), box(*outline))
    far = camera.scale < NUMBERED
    ink = mix(color, GROUND, 0.45 if far else 0.1)
    canvas.fill(ghost, mix(color, GROUND, 0.82))
    canvas.outline(ghost, ink, 1.0 if far else 1.5)
    tail, tip = camera.place((x, y, heading), [(0.0, 0.0), (length + 3.0 * half, 0.0)])
    canvas.arrow(tail, tip, ink, float(np.clip(0.25 * half * camera.scale, 1.2, 4.0)))
    canvas.disc(tail, max(2.0, 0.2 * camera.scale), ink)
    if camera.scale >= NUMBERED and not scene.waiting[hav]:
        tag = tail - (tip - tail) / np.hypot(*(tip - tail)) * (0.8 * half * camera.scale + 13.0)
        canvas.disc(tag, TAG, color)
        canvas.disc(tag, TAG - 1.5, PAPER)
        canvas.label(str(hav), tag, 15, color)


def draw_reserved(canvas: Canvas, camera: Camera, scene: Scene, hav: int) -> None:
    """Draw the area that a HAV has reserved, if it has."""
    if scene.reserved is None or np.isnan(scene.reserved[hav]).any():
        return
    corners = camera.project(scene.reserved[hav])
    canvas.fill(corners, mix(color_of(hav), GROUND, 0.88))
    canvas.outline(corners, mix(color_of(hav), GROUND, 0.4), 1.0)


def draw_way(canvas: Canvas, camera: Camera, scene: Scene, hav: int) -> None:
    """Draw a light line from a HAV to its goal."""
    start, end = camera.project(np.array([[scene.x[hav], scene.y[hav]], scene.goal[hav, :2]]))
    canvas.dash(start, end, mix(color_of(hav), GROUND, 0.7))


def draw_way_out(canvas: Canvas, camera: Camera, scene: Scene, hav: int) -> None:
    """Draw an arrow at the edge of the picture to a HAV's goal outside."""
    goal = camera.project(scene.goal[hav, :2])
    half, away = camera.free / 2.0 - 34.0, goal - camera.middle
    outside = float(np.max(np.abs(away) / half))
    if outside <= 1.0:
        return
    place = camera.middle + away / outside
    along = away / np.hypot(*away)
    canvas.arrow(place - 14.0 * along, place + 16.0 * along, color_of(hav), 3.5)
    told = f"goal {distance_shown(scene, hav):.0f} m"
    canvas.label(told, place - (48.0, 26.0) * along, 17, color_of(hav))


def goal_tips(scene: Scene, havs: np.ndarray) -> np.ndarray:
    """Return the trucks' noses at the goals of some HAVs, (len(havs), 2) [m]."""
    x, y, heading = scene.goal[havs].T
    ahead = scene.length[havs, 0] + [overhang_of(scene, hav) for hav in havs]
    return np.stack([x + ahead * np.cos(heading), y + ahead * np.sin(heading)], axis=1)


def draw_footprint(canvas: Canvas, camera: Camera, scene: Scene, hav: int) -> None:
    """Draw the footprint circle of a HAV; red while another one's overlaps it."""
    center = camera.project(np.array([scene.x[hav], scene.y[hav]]))
    danger = scene.potential[hav]
    color = mix(RED, GROUND, 0.25) if danger else mix(color_of(hav), GROUND, 0.6)
    canvas.ring(center, scene.footprint[hav] * camera.scale, color, 1.5 if danger else 1.0)


def draw_evasion(canvas: Canvas, camera: Camera, scene: Scene, hav: int) -> None:
    """Draw an arrow from the HAV that a HAV evades."""
    other = scene.evaded[hav]
    points = np.stack([scene.x[[hav, other]], scene.y[[hav, other]]], axis=1)
    own, evaded = camera.project(points)
    away = (own - evaded) / max(float(np.hypot(*(own - evaded))), 1e-9)
    canvas.dash(own, (own + evaded) / 2.0, EVASION, 1.2)
    reach = float(np.clip(9.0 * camera.scale, 17.0, 80.0))
    tip = own + reach * away
    canvas.arrow(own, tip, EVASION, float(np.clip(0.5 * camera.scale, 1.4, 4.0)))
    if camera.scale >= _WORDS_FIT:
        canvas.label(f"evades HAV {other}", tip + (36.0, 14.0) * away, 17, mix(EVASION, INK, 0.45))


def draw_own(canvas: Canvas, camera: Camera, scene: Scene, hav: int) -> None:
    """Mark the HAV that the user drives."""
    center = camera.project(np.array([scene.x[hav], scene.y[hav]]))
    radius = max(1.6 * scene.length[hav, 0] * camera.scale, 16.0)
    canvas.ring(center, radius, color_of(hav), 2.5)
    canvas.label("you", center + np.array([radius + 18.0, 0.0]), 20, color_of(hav))
