"""This module draws the legend: the meaning of bars, circles, arrows and outlines of a picture."""

from collections.abc import Callable

from hav_env.rendering.canvas import Canvas
from hav_env.rendering.colors import (
    AMBER,
    CALM,
    EVASION,
    GROUND,
    INK,
    PALE,
    PAPER,
    RED,
    Color,
    mix,
)
from hav_env.rendering.scene import Scene

LEGEND_HEIGHT = 52  # pixels of two rows
_ROW_HEIGHT, _EDGE = 20, 12  # pixels
_ROWS_SHOWN = 2
_FONT = 14
_SIGN, _BETWEEN = 25, 9  # pixels, breadth of a sign; from one entry to the next
_OF_HAVS = CALM  # colour of signs that have each HAV's own colour in the picture

_Place = tuple[float, float]  # middle of a sign
_Entry = tuple[Callable[[Canvas, _Place], None], str]


def draw_legend(canvas: Canvas, scene: Scene, left: float, circles: bool, listed: bool) -> None:
    """Draw the entries for all signs that the picture of a scene can have, in two rows.

    Args:
        canvas: shapes have been shrunk.
        scene: the scene.
        left: left edge of the legend in pixels; it lies on the lower edge of the picture.
        circles: whether footprints are drawn.
        listed: whether the picture has a line with a bar for each HAV.
    """
    width, top = canvas.size[0] - _EDGE - left, canvas.size[1] - _EDGE - LEGEND_HEIGHT
    canvas.panel(left, top, width, LEGEND_HEIGHT)
    rows: list[list[_Entry]] = [[]]
    x = left + _EDGE
    for entry in _entries(scene, circles, listed):
        breadth = _breadth_of(canvas, entry)
        if x + breadth > left + width - _EDGE / 2:
            rows.append([])
            x = left + _EDGE
        rows[-1].append(entry)
        x += breadth + _BETWEEN
    rows = rows[:_ROWS_SHOWN]
    for row, entries in enumerate(rows):
        x, middle = (
            left + _EDGE,
            top + LEGEND_HEIGHT / 2 + _ROW_HEIGHT * (row + 0.5 - len(rows) / 2),
        )
        for entry in entries:
            entry[0](canvas, (x + _SIGN / 2, middle))
            canvas.text(entry[1], (x + _SIGN + 6, middle), _FONT, INK, "midleft")
            x += _breadth_of(canvas, entry) + _BETWEEN


def _breadth_of(canvas: Canvas, entry: _Entry) -> float:
    return _SIGN + 6 + canvas.measure(entry[1], _FONT)


def _entries(scene: Scene, circles: bool, listed: bool) -> list[_Entry]:
    """Return the signs of a scene with their meanings, the most frequent first."""
    many = len(scene.x) > 1
    chosen: list[tuple[bool, _Entry]] = [
        (True, (_draw_goal, "goal")),
        (True, (_draw_tick, "at goal")),
        (True, (_draw_failure, "failed")),
        (True, (_draw_bends, "bent joint")),
        (listed, (_draw_bar, "most bent")),
        (circles, (_draw_circle, "footprint")),
        (circles and many, (_draw_overlap, "overlaps")),
        (scene.reserved is not None, (_draw_reserved, "reserved")),
        (many and scene.reserved is None, (_draw_evasion, "evades")),
        (len(scene.segment) > 0, (_draw_obstacle, "obstacle")),
    ]
    return [entry for shown, entry in chosen if shown]


def _box(canvas: Canvas, place: _Place, size: tuple[float, float], color: Color) -> None:
    canvas.bar(place[0] - size[0] / 2, place[1] - size[1] / 2, *size, color)


def _draw_goal(canvas: Canvas, place: _Place) -> None:
    x, y = place
    _box(canvas, (x - 3, y), (18, 10), _OF_HAVS)
    _box(canvas, (x - 3, y), (15, 7), mix(_OF_HAVS, GROUND, 0.82))
    _box(canvas, (x - 1, y), (14, 2), _OF_HAVS)
    canvas.triangle([(x + 13, y), (x + 5, y - 5), (x + 5, y + 5)], _OF_HAVS)


def _draw_tick(canvas: Canvas, place: _Place) -> None:
    x, y = place
    canvas.dot(place, 7.5, PALE)
    canvas.dot(place, 6.5, PAPER)
    canvas.polyline([(x - 3.5, y), (x - 1, y + 3), (x + 4, y - 3.5)], INK, 2)


def _draw_failure(canvas: Canvas, place: _Place) -> None:
    for radius, color in ((8.0, RED), (6.3, PAPER), (5.3, _OF_HAVS)):
        canvas.dot(place, radius, color)


def _draw_bends(canvas: Canvas, place: _Place) -> None:
    for shift, color in ((-8.0, CALM), (0.0, AMBER), (8.0, RED)):
        canvas.dot((place[0] + shift, place[1]), 3.2, color)


def _draw_bar(canvas: Canvas, place: _Place) -> None:
    _box(canvas, place, (24, 6), PALE)
    _box(canvas, (place[0] - 3, place[1]), (18, 6), AMBER)


def _draw_circle(canvas: Canvas, place: _Place) -> None:
    canvas.dot(place, 8.0, mix(_OF_HAVS, GROUND, 0.4))
    canvas.dot(place, 6.8, PAPER)


def _draw_overlap(canvas: Canvas, place: _Place) -> None:
    for shift in (-5.0, 5.0):
        canvas.dot((place[0] + shift, place[1]), 7.5, mix(RED, GROUND, 0.25))
    for shift in (-5.0, 5.0):
        canvas.dot((place[0] + shift, place[1]), 6.0, PAPER)


def _draw_reserved(canvas: Canvas, place: _Place) -> None:
    _box(canvas, place, (24, 13), mix(_OF_HAVS, GROUND, 0.4))
    _box(canvas, place, (21, 10), mix(_OF_HAVS, GROUND, 0.82))


def _draw_evasion(canvas: Canvas, place: _Place) -> None:
    x, y = place
    _box(canvas, (x - 3, y), (16, 3), EVASION)
    canvas.triangle([(x + 12, y), (x + 4, y - 5), (x + 4, y + 5)], EVASION)


def _draw_obstacle(canvas: Canvas, place: _Place) -> None:
    _box(canvas, place, (24, 3), INK)
