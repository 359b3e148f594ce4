"""This module defines the canvas, which draws shapes and texts by pygame.

It draws shapes twice as large and shrinks them, which smooths their edges. Then it draws texts.
"""

import itertools
import math
import os
from collections.abc import Sequence

import numpy as np

from hav_env.rendering.colors import GROUND, INK, PAPER, Color

# pygame prints a greeting, but standard output belongs to the program
os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
try:
    import pygame
    import pygame.font
    from pygame import IS_CE  # noqa: F401  the older pygame has neither this nor smooth discs
except ImportError as error:
    raise ImportError(
        "rendering needs pygame-ce: run pip install -e '.[rendering]' in the clone"
    ) from error

FINER = 2  # drawn size of shapes over their final size
_FINER_TEXT = 4  # the same for letters, whose spacing is uneven in small sizes
_MOST_TEXTS = 512  # texts in the cache
_DASH = 9.0  # pixels from one dash to the next
_MOST_DASHES = 300  # of a line that goes far beyond the picture


class Canvas:
    """An unfinished picture; needs no display. All places and sizes are in pixels of the picture.

    First the shapes, then ``shrink``, then the texts.
    """

    def __init__(self, size: tuple[int, int]) -> None:
        """Allocate a picture of this width and height."""
        pygame.font.init()
        self.size = size
        self._fine = pygame.Surface((FINER * size[0], FINER * size[1]), 0, 32)
        self.surface = pygame.Surface(size, 0, 32)
        self._fonts: dict[int, pygame.font.Font] = {}
        self._texts: dict[tuple[str, int, Color], pygame.Surface] = {}
        self._labels: list[tuple] = []

    def clear(self) -> None:
        """Begin a new picture."""
        self._fine.fill(GROUND)
        self._labels.clear()

    def fill(self, points: np.ndarray, color: Color) -> None:
        """Fill a polygon (K, 2)."""
        pygame.draw.polygon(self._fine, color, (FINER * points).tolist())

    def outline(self, points: np.ndarray, color: Color, width: float) -> None:
        """Draw the edge of a polygon (K, 2)."""
        self.stroke([*points, points[0]], color, width)

    def stroke(self, points: Sequence | np.ndarray, color: Color, width: float) -> None:
        """Draw a line through points (K, 2), with round joints and ends if they are visible."""
        at = (FINER * np.asarray(points, float)).tolist()
        if FINER * width < 3.5:
            thin = max(round(FINER * width), 1)
            pygame.draw.lines(self._fine, color, False, at, thin)
            return
        half = FINER * width / 2.0
        for (x, y), (to_x, to_y) in itertools.pairwise(at):
            dx, dy = to_x - x, to_y - y
            share = half / max(math.sqrt(dx * dx + dy * dy), 1e-9)
            dx, dy = share * dx, share * dy
            corners = (
                *((x - dy, y + dx), (to_x - dy, to_y + dx)),
                *((to_x + dy, to_y - dx), (x + dy, y - dx)),
            )
            pygame.draw.polygon(self._fine, color, corners)
        for point in at:
            pygame.draw.circle(self._fine, color, point, half)

    def lines(self, ends: np.ndarray, color: Color, width: float) -> None:
        """Draw many thin straight lines (K, 4), from x and y to x and y, none far outside."""
        draw, surface, thin = pygame.draw.line, self._fine, max(round(FINER * width), 1)
        for x, y, to_x, to_y in (FINER * ends).tolist():
            draw(surface, color, (x, y), (to_x, to_y), thin)

    def dash(self, start: np.ndarray, end: np.ndarray, color: Color, width: float = 1.0) -> None:
        """Draw a dashed line from a place to another one."""
        count = int(min(np.hypot(*(end - start)) / _DASH, _MOST_DASHES)) or 1
        shares = np.linspace(0.0, 1.0, 2 * count + 1)[:, None]
        places = (FINER * (start + shares * (end - start))).tolist()
        thin = max(round(FINER * width), 1)
        for k in range(0, 2 * count, 2):
            pygame.draw.line(self._fine, color, places[k], places[k + 1], thin)

    def disc(self, center: np.ndarray, radius: float, color: Color) -> None:
        """Fill a circle."""
        pygame.draw.circle(self._fine, color, (FINER * center).tolist(), FINER * radius)

    def ring(self, center: np.ndarray, radius: float, color: Color, width: float = 1.0) -> None:
        """Draw a circle, unless it is so large that its arc looks straight."""
        if radius < 8 * max(self.size):
            thin = max(round(FINER * width), 1)
            place = (FINER * center).tolist()
            pygame.draw.circle(self._fine, color, place, FINER * radius, thin)

    def arrow(self, tail: np.ndarray, tip: np.ndarray, color: Color, width: float) -> None:
        """Draw an arrow with a filled head of three widths."""
        along = (tip - tail) / max(float(np.hypot(*(tip - tail))), 1e-9)
        aside, neck = np.array([-along[1], along[0]]), tip - 4.5 * width * along
        self.stroke([tail, neck], color, width)
        self.fill(np.array([tip, neck + 2.4 * width * aside, neck - 2.4 * width * aside]), color)

    def label(
        self, text: str, place: np.ndarray, size: int, color: Color, anchor: str = "center"
    ) -> None:
        """Write a line after the shapes are shrunk; arguments as for ``text``."""
        self._labels.append((text, tuple(place), size, color, anchor))

    def shrink(self) -> None:
        """Turn the shapes into the picture; texts are drawn upon it."""
        pygame.transform.smoothscale(self._fine, self.size, self.surface)
        for label in self._labels:
            self.text(*label)
        self._labels.clear()

    def text(
        self,
        text: str,
        place: Sequence[float],
        size: int,
        color: Color = INK,
        anchor: str = "topleft",
    ) -> tuple[int, int]:
        """Write a line.

        Args:
            text: text to write.
            place: place of its anchor.
            size: height of the font.
            color: colour of the letters.
            anchor: "topleft", "center", "midleft", "midright", ...

        Returns:
            Width and height of the text.
        """
        drawn = self._draw_text(text, size, color)
        box = drawn.get_rect()
        setattr(box, anchor, (round(place[0]), round(place[1])))
        self.surface.blit(drawn, box)
        return box.size

    def measure(self, text: str, size: int) -> int:
        """Return the width of a text."""
        return self._draw_text(text, size, INK).get_width()

    def panel(self, left: float, top: float, width: float, height: float) -> None:
        """Draw an almost opaque background for text."""
        sheet = pygame.Surface((round(width), round(height)), pygame.SRCALPHA)
        pygame.draw.rect(sheet, (*PAPER, 215), sheet.get_rect(), border_radius=6)
        self.surface.blit(sheet, (round(left), round(top)))

    def bar(self, left: float, top: float, width: float, height: float, color: Color) -> None:
        """Fill an upright rectangle on the picture."""
        box = (round(left), round(top), max(round(width), 1), round(height))
        pygame.draw.rect(self.surface, color, box)

    def dot(self, center: Sequence[float], radius: float, color: Color) -> None:
        """Fill a circle on the picture."""
        pygame.draw.aacircle(self.surface, color, (center[0], center[1]), radius)

    def triangle(self, points: Sequence[Sequence[float]], color: Color) -> None:
        """Fill a polygon on the picture."""
        pygame.draw.polygon(self.surface, color, points)

    def polyline(self, points: Sequence[Sequence[float]], color: Color, width: int) -> None:
        """Draw a line on the picture."""
        pygame.draw.lines(self.surface, color, False, points, width)

    def frame(self) -> np.ndarray:
        """Return the picture, (height, width, 3) uint8, a copy."""
        pixels = bytearray(pygame.image.tobytes(self.surface, "RGB"))
        return np.frombuffer(pixels, np.uint8).reshape(self.size[1], self.size[0], 3)

    def _draw_text(self, text: str, size: int, color: Color) -> pygame.Surface:
        known = self._texts.get((text, size, color))
        if known is not None:
            return known
        if len(self._texts) >= _MOST_TEXTS:
            self._texts.clear()
        try:
            fine = self._font(size).render(text, True, color)
        except pygame.error:  # another library quit pygame, and its fonts with it
            pygame.font.init()
            self._fonts.clear()
            fine = self._font(size).render(text, True, color)
        shown = [max(round(side / _FINER_TEXT), 1) for side in fine.get_size()]
        drawn = pygame.transform.smoothscale(fine, shown)
        self._texts[text, size, color] = drawn
        return drawn

    def _font(self, size: int) -> pygame.font.Font:
        if size not in self._fonts:
            # pygame's own font
            self._fonts[size] = pygame.font.Font(None, _FINER_TEXT * size)
        return self._fonts[size]
