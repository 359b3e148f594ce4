"""This module labels positions in a plot: it places texts where they overlap no other text."""

from typing import Any, NamedTuple

import numpy as np

_SIZE = 6.5  # points, of the letters
_LETTER, _LINE_STEP = 0.56, 1.35  # breadth of a letter and height of a line, over their size
_REACHES = (1.0, 1.6, 2.4, 3.4)  # distances that are tried, over the usual one
_TURNS = np.radians([0, 30, -30, 60, -60, 90, -90, 120, -120, 150, -150, 180])


class Label(NamedTuple):
    """A text beside a position."""

    place: np.ndarray  # (2,) x and y [m]
    text: str
    color: str
    offset: np.ndarray  # (2,) preferred offset of the text's middle [points]


def label_panels(labels: dict[Any, list[Label]]) -> None:
    """Compute the layout of a figure, and place the labels of its panels.

    Args:
        labels: Labels by the axes of their panel.
    """
    figure = next(iter(labels)).figure
    layout = figure.get_layout_engine()
    if layout is not None:
        layout.execute(figure)
    for axes, own in labels.items():
        axes.autoscale_view()
        axes.apply_aspect()
        place_labels(axes, own)


def place_labels(axes: Any, labels: list[Label]) -> None:
    """Write labels into axes whose limits and size are final, each where it overlaps least.

    A label tries its own offset first, then other directions, then larger distances. A line leads
    from a distant label to its position.

    Args:
        axes: Axes of a plot with a finished layout.
        labels: Labels; the first ones have the first choice.
    """
    points = 72.0 / axes.figure.dpi  # of a pixel
    frame = axes.get_window_extent().get_points() * points
    taken: list[np.ndarray] = []
    for label in labels:
        anchor = axes.transData.transform(label.place) * points
        half = 0.5 * _SIZE * np.array([_LETTER * len(label.text) + 0.5, _LINE_STEP])
        tried = [reach * _turned(label.offset, turn) for reach in _REACHES for turn in _TURNS]
        costs = [_overlap(anchor + offset, half, taken, frame) for offset in tried]
        chosen = tried[int(np.argmin(costs))]  # the first of the best
        taken.append(np.stack([anchor + chosen - half, anchor + chosen + half]))
        _write(axes, label, chosen)


def _turned(offset: np.ndarray, turn: float) -> np.ndarray:
    cosine, sine = np.cos(turn), np.sin(turn)
    return np.array([[cosine, -sine], [sine, cosine]]) @ offset


def _overlap(
    middle: np.ndarray, half: np.ndarray, taken: list[np.ndarray], frame: np.ndarray
) -> float:
    """Return the area [points^2] that a text shares with other texts, or has outside a frame."""
    low, high = middle - half, middle + half
    area = 0.0
    for other_low, other_high in taken:
        area += float(
            np.prod(np.maximum(np.minimum(high, other_high) - np.maximum(low, other_low), 0))
        )
    inside = np.maximum(np.minimum(high, frame[1]) - np.maximum(low, frame[0]), 0.0)
    outside = float(np.prod(2.0 * half) - np.prod(inside))
    return round(area + outside, 3)  # equal costs are equal in spite of rounding


def _write(axes: Any, label: Label, offset: np.ndarray) -> None:
    """Write a label on a background that is legible on lines."""
    style: dict[str, Any] = {
        "bbox": {"boxstyle": "round,pad=0.1", "fc": "white", "ec": "none", "alpha": 0.75},
        "color": label.color,
        "fontsize": _SIZE,
        "ha": "center",
        "va": "center",
        "zorder": 7,
    }
    if np.hypot(*offset) > 1.5 * np.hypot(*label.offset):
        line = {"arrowstyle": "-", "color": label.color, "lw": 0.4, "shrinkA": 0, "shrinkB": 0}
        style["arrowprops"] = line
    beside = {"xytext": offset.tolist(), "textcoords": "offset points"}
    text = axes.annotate(label.text, label.place, annotation_clip=False, **beside, **style)
    text.set_in_layout(False)  # it must not change the layout for which it was placed
