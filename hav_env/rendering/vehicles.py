"""This module draws HAVs to scale: in detail when near, as chains when far away."""

import itertools

import numpy as np

from hav_env.rendering.bodies import draw_bodies
from hav_env.rendering.camera import Camera, box
from hav_env.rendering.canvas import Canvas
from hav_env.rendering.colors import (
    GROUND,
    INK,
    PAPER,
    RED,
    color_of,
    color_of_bend,
    mix,
    pattern_of,
)
from hav_env.rendering.scene import Scene, chain_of, ends_of, harms_of, shares_of
from hav_env.world.units.parts import FRONT, HALF_WIDTH

_DETAILED = 7.0  # pixels of breadth from which wheels and cabs are visible
_VISIBLE = 3.0  # pixels of breadth from which rectangles are visible
NUMBERED = 1.2  # pixels per metre from which numbers fit
TAG = 9.0  # pixels, radius of a number's disc


def breadth_of(scene: Scene, hav: int) -> float:
    """Return the drawn breadth of a HAV [m]; lines have none."""
    if scene.shape is not None:
        return 2.0 * float(scene.shape[hav, : scene.num_trailers[hav] + 1, HALF_WIDTH].max())
    return float(np.clip(0.4 * scene.length[hav, 0], 1.4, 2.4))


def overhang_of(scene: Scene, hav: int) -> float:
    """Return the front overhang of a truck [m]; lines have none."""
    return 0.0 if scene.shape is None else float(scene.shape[hav, 0, FRONT])


def draw_hav(canvas: Canvas, camera: Camera, scene: Scene, hav: int) -> None:
    """Draw a HAV and its number."""
    axles, ends = chain_of(scene, hav), ends_of(scene, hav)
    pixels = breadth_of(scene, hav) * camera.scale
    near = pixels >= _DETAILED
    if scene.shape is not None and pixels >= _VISIBLE:
        draw_bodies(canvas, camera, scene, hav, near)
        _draw_pattern(canvas, camera.project(axles), hav, pixels)
        draw = _draw_joints if near else _draw_bends
        draw(canvas, camera, scene, hav, axles, ends)
    elif near:
        for unit in range(scene.num_trailers[hav], 0, -1):
            _draw_trailer(canvas, camera, scene, hav, unit, axles[unit + 1])
        _draw_truck(canvas, camera, scene, hav, axles)
        _draw_pattern(canvas, camera.project(axles), hav, pixels)
        _draw_joints(canvas, camera, scene, hav, axles, ends)
    else:
        _draw_chain(canvas, camera, scene, hav, axles, ends)
        _draw_pattern(canvas, camera.project(axles), hav, max(3.0, pixels))
    front, rear = camera.project(axles[:2])
    troubled = bool(harms_of(scene, hav))
    if camera.scale >= NUMBERED:
        ahead = (front - rear) / max(float(np.hypot(*(front - rear))), 1e-9)
        away = (0.5 + overhang_of(scene, hav)) * camera.scale + 14.0
        _draw_tag(canvas, scene, hav, front + away * ahead, troubled)
    elif troubled:
        canvas.disc(rear, 4.5, RED)
        canvas.disc(rear, 2.0, PAPER)


def _draw_pattern(canvas: Canvas, points: np.ndarray, hav: int, breadth: float) -> None:
    """Draw the pattern of a HAV along its axles (K, 2), which are pixels, like its breadth."""
    pattern, width = pattern_of(hav), max(1.0, 0.3 * breadth)
    if pattern == "stripe":
        canvas.stroke(points, PAPER, width)
    for start, end in itertools.pairwise(points) if pattern in ("dashes", "dots") else ():
        if pattern == "dashes":
            canvas.dash(start, end, PAPER, width)
            continue
        count = int(np.hypot(*(end - start)) / max(2.5 * width, 6.0)) + 1
        for share in (np.arange(count) + 0.5) / count:
            canvas.disc(start + share * (end - start), max(1.2, 0.6 * width), PAPER)


def _draw_wheels(canvas: Canvas, camera: Camera, pose: tuple, half: float, turn: float = 0.0):
    """Draw a pair of wheels on an axle at a pose, turned against it."""
    x, y, heading = pose
    for side in (-1.0, 1.0):
        center = np.array([-side * np.sin(heading), side * np.cos(heading)]) * half + (x, y)
        wheel = box(-0.26 * half - 0.2, 0.26 * half + 0.2, 0.1 * half + 0.08)
        canvas.fill(camera.place((center[0], center[1], heading + turn), wheel), INK)


def _draw_trailer(
    canvas: Canvas, camera: Camera, scene: Scene, hav: int, unit: int, axle: np.ndarray
) -> None:
    color, half = color_of(hav), 0.5 * breadth_of(scene, hav)
    length, heading = scene.length[hav, unit], scene.heading[hav, unit]
    pose = (axle[0], axle[1], heading)
    front = length - min(0.3 * length, 1.3 * half)
    _draw_wheels(canvas, camera, pose, half)
    body = camera.place(pose, box(-0.4 * half, front, 0.9 * half))
    canvas.fill(body, mix(color, PAPER, 0.62))
    canvas.outline(body, color, 1.0)
    if 0.5 * front * camera.scale > 8.0:  # direction of the trailer
        middle, reach = 0.5 * front, 0.4 * half
        chevron = [(middle - reach, reach), (middle, 0.0), (middle - reach, -reach)]
        canvas.stroke(camera.place(pose, chevron), color, 1.7)


def _draw_truck(canvas: Canvas, camera: Camera, scene: Scene, hav: int, axles) -> None:
    color, half = color_of(hav), 0.5 * breadth_of(scene, hav)
    length, heading = scene.length[hav, 0], scene.heading[hav, 0]
    front, pose = (*axles[0], heading), (*axles[1], heading)
    _draw_wheels(canvas, camera, pose, half)
    nose, cab = length + 0.55 * half, length - max(1.3 * half, 0.2 * length)
    deck = camera.place(pose, box(-0.5 * half, cab, 0.62 * half))
    canvas.fill(deck, mix(color, INK, 0.45))
    _draw_wheels(canvas, camera, front, half, scene.steering[hav])
    bevel = 0.3 * half
    shape = [(cab, -half), (nose - bevel, -half), (nose, -half + bevel)]
    shape += [(along, -aside) for along, aside in reversed(shape)]
    body = camera.place(pose, np.array(shape) * (1.0, 0.88))
    canvas.fill(body, color)
    canvas.outline(body, mix(color, INK, 0.5), 1.0)
    glass = box(nose - 0.65 * half, nose - 0.3 * half, 0.62 * half)
    canvas.fill(camera.place(pose, glass), mix(color, PAPER, 0.85))


def _draw_joints(canvas: Canvas, camera: Camera, scene: Scene, hav: int, axles, ends) -> None:
    """Draw drawbars and the bend of every joint, coloured by its nearness to its limit."""
    hitches, half = camera.project(ends[1:]), 0.5 * breadth_of(scene, hav) * camera.scale
    places, shares = camera.project(axles[1:]), shares_of(scene, hav)
    for joint in range(scene.num_trailers[hav], 0, -1):
        nearness = shares[joint - 1]
        color = color_of_bend(nearness)
        hitch, length = hitches[joint - 1], scene.length[hav, joint]
        if nearness > 0.25:  # the angle between straight ahead and the trailer
            ahead, behind = scene.heading[hav, [joint - 1, joint]] + np.pi
            angles = np.linspace(ahead, behind, 14)
            arc = hitch + 1.7 * half * np.stack([np.cos(angles), -np.sin(angles)], axis=1)
            canvas.fill(np.vstack([hitch, arc]), mix(color, GROUND, 0.45))
            canvas.stroke(arc, color, 1.5)
        if scene.shape is None:
            if scene.offset[hav, joint - 1] != 0.0:
                arm = [places[joint - 1], hitch]
                canvas.stroke(arm, mix(color_of(hav), INK, 0.45), max(1.5, 0.2 * half))
            along = (places[joint] - hitch) / (length * camera.scale)
            bar = min(0.3 * length * camera.scale, 1.3 * half) + 0.25 * half
            canvas.stroke([hitch, hitch + bar * along], color, max(1.5, 0.2 * half))
        radius = max(2.2, 0.3 * half)
        canvas.disc(hitch, radius + 1.0, PAPER)
        canvas.disc(hitch, radius, color)


def _draw_bends(canvas: Canvas, camera: Camera, scene: Scene, hav: int, axles, ends) -> None:
    """Mark the joints that are near their limits."""
    breadth = breadth_of(scene, hav) * camera.scale
    for hitch, share in zip(camera.project(ends[1:]), shares_of(scene, hav), strict=True):
        if share > 0.5:
            canvas.disc(hitch, max(2.4, 0.6 * breadth), color_of_bend(share))


def _draw_chain(canvas: Canvas, camera: Camera, scene: Scene, hav: int, axles, ends) -> None:
    """Draw a HAV at a small scale: lines of its lengths, an arrow head for the truck."""
    color, points = color_of(hav), camera.project(axles)
    breadth = breadth_of(scene, hav) * camera.scale
    line = points[1:]
    if scene.offset[hav, : len(ends)].any():  # from axle to hitch to axle
        line = np.insert(line, range(1, len(line)), camera.project(ends[1:]), axis=0)
    canvas.stroke(line, mix(color, PAPER, 0.4), max(3.0, 0.9 * breadth))
    _draw_bends(canvas, camera, scene, hav, axles, ends)
    rear, front = points[0] - points[1], points[1]
    ahead = rear / max(float(np.hypot(*rear)), 1e-9)
    aside = np.array([-ahead[1], ahead[0]])
    canvas.stroke(points[:2], color, max(3.6, 1.1 * breadth))
    size = max(4.0, 0.9 * breadth)
    tip = front + max(float(np.hypot(*rear)), size) * ahead
    head = [tip + size * ahead, tip - size * (ahead - aside), tip - size * (ahead + aside)]
    canvas.fill(np.array(head), color)


def _draw_tag(canvas: Canvas, scene: Scene, hav: int, place: np.ndarray, troubled: bool) -> None:
    """Draw the number of a HAV, with a ring after a failure and a tick while it waits."""
    canvas.disc(place, TAG + 3.0, GROUND)
    if troubled:
        canvas.disc(place, TAG + 2.5, RED)
        canvas.disc(place, TAG + 0.8, PAPER)
    canvas.disc(place, TAG, color_of(hav))
    canvas.label(str(hav), place, 16, PAPER)
    if scene.waiting[hav]:
        corner = place + np.array([TAG + 2.0, -TAG - 1.0])
        canvas.disc(corner, 7.0, PAPER)
        tick = corner + np.array([(-3.5, 0.0), (-1.0, 3.0), (4.0, -3.5)])
        canvas.stroke(tick, INK, 2.0)
