"""This module draws text on the picture: clock, counts, a line per HAV, events, a scale bar."""

from collections.abc import Sequence

import numpy as np

from hav_env.rendering.camera import Camera
from hav_env.rendering.canvas import Canvas
from hav_env.rendering.colors import DIM, EVENT_COLORS, INK, PALE, Color, color_of, color_of_bend
from hav_env.rendering.ground import grid_spacing
from hav_env.rendering.history import History
from hav_env.rendering.legend import LEGEND_HEIGHT, draw_legend
from hav_env.rendering.scene import (
    Scene,
    count_flags,
    distance_shown,
    goals_shown,
    harms_of,
    has_arrived,
    lags_behind,
    motion_shown,
    shares_of,
)
from hav_env.world.event_table import HARM

_EDGE = 12  # pixels between a panel and the edge, and within a panel
_LISTED = 10  # largest number of HAVs with a line each
_TEXT_ROW = 19  # pixels
_PANEL = 196  # pixels, breadth of the panels
_CAPTION = 17  # height of the font
_BAR = 38  # pixels, breadth of the bar of a bend
_ROOM = (560, 420)  # pixels that a picture needs for panels


def sidebar_width(size: tuple[int, int]) -> float:
    """Return the pixels on the left of a picture for text; none in a small one."""
    return _EDGE + _PANEL if size[0] >= _ROOM[0] and size[1] >= _ROOM[1] else 0.0


def legend_height(size: tuple[int, int]) -> float:
    """Return the pixels at the bottom of a picture for the legend; none in a small one."""
    return _EDGE + LEGEND_HEIGHT if sidebar_width(size) > 0 else 0.0


def draw_overlay(canvas: Canvas, camera: Camera, scene: Scene, history: History) -> None:
    """Write everything that fits, except for caption and legend."""
    if sidebar_width(canvas.size) > 0:
        bottom = _draw_clock(canvas, scene)
        if len(scene.x) <= _LISTED:
            bottom = _draw_list(canvas, scene, bottom + _EDGE)
            _draw_motion(canvas, scene, bottom + _EDGE)
        _draw_events(canvas, history)
    _draw_scale_bar(canvas, camera)


def draw_caption(canvas: Canvas, lines: Sequence[str], own: int | None = None) -> None:
    """Write lines in the upper right corner, and which HAV the user drives.

    Args:
        canvas: shapes have been shrunk.
        lines: to be written; none in a small picture.
        own: number of the HAV that the user drives; None for none.
    """
    told = [*([f"you drive HAV {own}"] if own is not None else []), *lines]
    if not told or sidebar_width(canvas.size) == 0.0:
        return
    most = canvas.size[0] - _PANEL - 5 * _EDGE
    shown = [fit_text(canvas, line, _CAPTION, most) for line in told]
    width = max(canvas.measure(line, _CAPTION) for line in shown) + 2 * _EDGE
    left = canvas.size[0] - _EDGE - width
    canvas.panel(left, _EDGE, width, _TEXT_ROW * len(shown) + _EDGE)
    for k, line in enumerate(shown):
        color = color_of(own) if own is not None and k == 0 else INK
        canvas.text(line, (left + _EDGE, 1.5 * _EDGE + _TEXT_ROW * k), _CAPTION, color)


def draw_explanation(canvas: Canvas, scene: Scene, circles: bool) -> None:
    """Draw the legend, if the picture is large enough.

    Args:
        canvas: shapes have been shrunk.
        scene: the scene.
        circles: whether footprints are drawn.
    """
    if legend_height(canvas.size) > 0:
        left = sidebar_width(canvas.size) + _EDGE
        draw_legend(canvas, scene, left, circles, len(scene.x) <= _LISTED)


def fit_text(canvas: Canvas, text: str, size: int, most: float) -> str:
    """Return a text, cut so that it is at most so many pixels wide."""
    while len(text) > 4 and canvas.measure(text, size) > most:
        text = f"{text[:-4]}..."
    return text


def _draw_clock(canvas: Canvas, scene: Scene) -> float:
    """Write the time and the number of HAVs in each state; return the end of the panel."""
    waiting = np.count_nonzero(scene.waiting)
    lines = [(f"{waiting} of {len(scene.x)} at goal", INK)]
    for name, count in count_flags(scene).items():
        if count and name != "at goal":
            lines.append((f"{count} {name}", _HARM_COLORS.get(name, INK)))
    height = 2 * _EDGE + 28 + _TEXT_ROW * len(lines)
    canvas.panel(_EDGE, _EDGE, _PANEL, height)
    canvas.text(f"{scene.time:.1f} s", (2 * _EDGE, 2 * _EDGE - 2), 32)
    goals = f"goal {goals_shown(scene)} of {scene.num_goals}"
    canvas.text(goals, (_PANEL, 2 * _EDGE + 5), 18, DIM, "topright")
    for k, (text, color) in enumerate(lines):
        canvas.text(text, (2 * _EDGE, 2 * _EDGE + 31 + _TEXT_ROW * k), 18, color)
    return _EDGE + height


def _draw_list(canvas: Canvas, scene: Scene, top: float) -> float:
    """Write each HAV's distance to its goal, and show its largest bend beside the limit.

    Returns:
        The end of the panel.
    """
    height = 2 * _EDGE + _TEXT_ROW * len(scene.x) - 4
    canvas.panel(_EDGE, top, _PANEL, height)
    for hav in range(len(scene.x)):
        middle = top + _EDGE + _TEXT_ROW * (hav + 0.5) - 2
        gone = scene.removed[hav]
        canvas.dot((2 * _EDGE + 6, middle), 5.5, PALE if gone else color_of(hav))
        canvas.text(str(hav), (2 * _EDGE + 20, middle), 18, INK, "midleft")
        state, color = _state_of(scene, hav)
        canvas.text(state, (2 * _EDGE + 36, middle), 18, color, "midleft")
        if not gone:
            share = float(shares_of(scene, hav).max())
            canvas.bar(_PANEL - _BAR, middle - 3, _BAR, 6, PALE)
            canvas.bar(_PANEL - _BAR, middle - 3, _BAR * min(share, 1.0), 6, color_of_bend(share))
    return top + height


def _draw_motion(canvas: Canvas, scene: Scene, top: float) -> None:
    """Write the actual and the commanded motion of HAVs in which they differ."""
    lagging = [hav for hav in range(len(scene.x)) if lags_behind(scene, hav)]
    if lagging:
        canvas.panel(_EDGE, top, _PANEL, 2 * _EDGE + _TEXT_ROW * len(lagging) - 4)
    for line, hav in enumerate(lagging):
        middle = top + _EDGE + _TEXT_ROW * (line + 0.5) - 2
        canvas.dot((2 * _EDGE + 6, middle), 5.5, color_of(hav))
        canvas.text(motion_shown(scene, hav), (2 * _EDGE + 20, middle), 14, INK, "midleft")


_HARM_COLORS = {event.state: EVENT_COLORS[event.color] for event in HARM}


def _state_of(scene: Scene, hav: int) -> tuple[str, Color]:
    """Return the most important state of a HAV in a word or two, and its colour."""
    if scene.removed[hav]:
        return "removed", DIM
    for event in harms_of(scene, hav):
        return event.state, _HARM_COLORS[event.state]
    if scene.waiting[hav]:
        return "arrived" if has_arrived(scene, hav) else "at goal", DIM
    if scene.evaded[hav] >= 0:
        return f"evades HAV {scene.evaded[hav]}", INK
    return f"{distance_shown(scene, hav):.1f} m", INK


def _draw_events(canvas: Canvas, history: History) -> None:
    """Write the latest events above the lower edge."""
    if not history.events:
        return
    height = 2 * _EDGE + _TEXT_ROW * len(history.events) - 6
    top = canvas.size[1] - _EDGE - height
    canvas.panel(_EDGE, top, _PANEL, height)
    for k, (time, text) in enumerate(history.events):
        middle = top + _EDGE + _TEXT_ROW * (k + 0.5) - 3
        canvas.text(f"{time:.1f} s", (_EDGE + 58, middle), 16, DIM, "midright")
        harms = [color for state, color in _HARM_COLORS.items() if text.endswith(state)]
        color = harms[0] if harms else INK
        canvas.text(text, (_EDGE + 66, middle), 16, color, "midleft")


def _draw_scale_bar(canvas: Canvas, camera: Camera) -> None:
    """Draw one side of a cell of the grid."""
    length = grid_spacing(camera)
    pixels = length * camera.scale
    right = canvas.size[0] - 2 * _EDGE
    bottom = canvas.size[1] - 2 * _EDGE - legend_height(canvas.size)
    canvas.panel(right - pixels - _EDGE, bottom - 26, pixels + 2 * _EDGE, 38)
    canvas.bar(right - pixels, bottom - 2, pixels, 3, INK)
    canvas.text(f"{length:g} m", (right - pixels / 2, bottom - 13), 18, INK, "center")
