"""This module defines the viewer, which draws scenes one by one into arrays or a window.

A copied or unpickled viewer draws what the viewer itself would have drawn.

Keys in the window: F follows one HAV after the other, then shows all; + and - zoom; T trails;
C circles; H hides caption and legend; space pauses. Closing the window ends the drawing, not the
program.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from hav_env.rendering.camera import Camera, clip_segments
from hav_env.rendering.canvas import Canvas, pygame
from hav_env.rendering.ground import draw_grid, draw_segments, draw_trails
from hav_env.rendering.history import History
from hav_env.rendering.marks import (
    draw_evasion,
    draw_footprint,
    draw_goal,
    draw_own,
    draw_reserved,
    draw_way,
    draw_way_out,
    goal_tips,
)
from hav_env.rendering.overlay import (
    draw_caption,
    draw_explanation,
    draw_overlay,
    legend_height,
    sidebar_width,
)
from hav_env.rendering.scene import Scene, chain_of, outlines_of
from hav_env.rendering.vehicles import draw_hav
from hav_env.rendering.window import Window

DRAWN_MODES = ("human", "rgb_array")
_FEW_WAYS = 4  # largest number of HAVs with lines to their goals
_BORDER = 0.09  # share of the picture's height that stays free at the edges
_NEARBY = 8.0  # m round HAVs and goals within which obstacles are in the picture too
_ZOOM = 1.25  # zoom of one press of a key
_MOST_PIXELS = 8_192  # pixels of a side: the canvas is twice as large
_MOST_FRAMES = 1_000  # frames per second: pygame's clock counts milliseconds


class Viewer:
    """A viewer of one world. All viewers of a process share one window.

    Attributes:
        follow: number of the HAV that the camera follows, None for all.
        trails: whether the viewer draws trails.
        circles: whether the viewer draws footprints as circles.
        legend: whether the viewer draws the caption and the legend.
        caption: lines in the upper right corner.
        own: number of the HAV that the user drives, which is marked; None for none.
        closed: nothing is drawn any more, since ``close`` was called or the window was closed.
    """

    def __init__(
        self,
        render_mode: str,
        *,
        size: tuple[int, int] = (960, 720),
        frames_per_second: float = 30,
        follow: int | None = None,
        caption: Sequence[str] = (),
        own: int | None = None,
    ) -> None:
        """Create a viewer; a window opens with the first scene.

        Args:
            render_mode: "human" for a window, "rgb_array" for arrays, which needs no display.
            size: width and height in pixels.
            frames_per_second: how fast a window shows scenes, and how fast the camera moves.
            follow: which HAV to follow from the start.
            caption: lines in the upper right corner, such as the policy or the keys.
            own: number of the HAV that the user drives; None for none.

        Raises:
            ValueError: if the render mode is unknown, or a size or rate is out of range.
        """
        if render_mode not in DRAWN_MODES:
            allowed = ", ".join(DRAWN_MODES)
            raise ValueError(f"render_mode is {render_mode!r}, but must be one of: {allowed}")
        if not 1 <= min(size) <= max(size) <= _MOST_PIXELS:
            raise ValueError(f"size is {size}, but must be from 1 to {_MOST_PIXELS} pixels")
        if not 0 < frames_per_second <= _MOST_FRAMES:
            told = f"frames_per_second is {frames_per_second}"
            raise ValueError(f"{told}, but must be above 0 and at most {_MOST_FRAMES}")
        self.render_mode = render_mode
        self.size = (int(size[0]), int(size[1]))
        self.frames_per_second = frames_per_second
        self.follow = follow
        self.caption, self.own = tuple(caption), own
        self.trails = self.circles = self.legend = True
        self.closed = False
        self._zoom = 1.0
        self._paused = False
        edges = sidebar_width(self.size), frames_per_second, legend_height(self.size)
        self._camera = Camera(self.size, *edges)
        self._history = History()
        self._set_up()

    def _set_up(self) -> None:
        """Create the objects of pygame, which cannot be copied."""
        self._canvas, self._window = Canvas(self.size), Window(self.size)
        self._clock = pygame.time.Clock()

    def __getstate__(self) -> dict[str, Any]:
        """Leave out the objects of pygame."""
        made = ("_canvas", "_window", "_clock")
        return {name: value for name, value in self.__dict__.items() if name not in made}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Create the objects of pygame again; a window opens with the next scene."""
        self.__dict__.update(state)
        self._set_up()

    def observe(self, scene: Scene) -> None:
        """Continue trails, events and the camera's motion with a scene that is not drawn."""
        if not self._history.follows(scene):
            self.forget()
        self._history.observe(scene)
        self._aim(scene, np.flatnonzero(~scene.removed))

    def draw(self, scene: Scene) -> np.ndarray | None:
        """Draw a scene.

        A scene earlier than the one before it, or of other HAVs, begins a new episode.

        Returns:
            (height, width, 3) uint8, a new array, or None if drawn in a window or closed.

        Raises:
            NoDisplayError: an OSError, if there is no display for a window.
        """
        if self.closed:
            return None
        if not self._history.follows(scene):
            self.forget()
        self._history.observe(scene)
        if self.render_mode == "rgb_array":
            self._paint(scene)
            return self._canvas.frame()
        self._show(scene)
        while self._paused and not self.closed:
            self._show(scene)
        return None

    def forget(self) -> None:
        """Begin a new episode: clear trails and events, and reset the camera."""
        self._history = History()
        self._camera.forget()

    def close(self) -> None:
        """Close the window, if there is one, and draw no more; a second call has no effect."""
        self.closed = True
        self._window.close()

    def _show(self, scene: Scene) -> None:
        """Draw in the window, and handle the user's keys."""
        for event in self._window.take_events():
            self._press(event.key, len(scene.x))
        if self._window.asked_to_close:
            self.close()
            return
        self._paint(scene)
        self._window.show(self._canvas.surface)
        self._clock.tick(self.frames_per_second)

    def _press(self, key: int, num_havs: int) -> None:
        """Carry out the command of a key."""
        if key == pygame.K_f:
            after = 0 if self.follow is None else self.follow + 1
            self.follow = after if after < num_havs else None
        elif key in (pygame.K_PLUS, pygame.K_EQUALS, pygame.K_KP_PLUS):
            self._zoom *= _ZOOM
        elif key in (pygame.K_MINUS, pygame.K_KP_MINUS):
            self._zoom /= _ZOOM
        elif key == pygame.K_t:
            self.trails = not self.trails
        elif key == pygame.K_c:
            self.circles = not self.circles
        elif key == pygame.K_h:
            self.legend = not self.legend
        elif key == pygame.K_SPACE:
            self._paused = not self._paused

    def _paint(self, scene: Scene) -> None:
        """Draw a scene on the canvas."""
        canvas, camera = self._canvas, self._camera
        present = np.flatnonzero(~scene.removed)
        self._aim(scene, present)
        canvas.clear()
        draw_grid(canvas, camera)
        for hav in present if scene.reserved is not None else ():
            draw_reserved(canvas, camera, scene, int(hav))
        if self.trails:
            draw_trails(canvas, camera, self._history.trails(scene), scene.removed)
        near = self._in_sight(scene, present)
        evading = near[scene.evaded[near] >= 0]
        layers: list[tuple[Callable, list | np.ndarray]] = [
            (draw_footprint, near if self.circles else []),
            (draw_way, present[~scene.waiting[present]] if len(scene.x) <= _FEW_WAYS else []),
            (draw_goal, present),
            (draw_evasion, evading),
            (draw_hav, near),
        ]
        for layer, havs in layers:
            for hav in havs:
                layer(canvas, camera, scene, hav)
        draw_segments(canvas, camera, scene)
        if self.follow is not None and self.follow in present:
            draw_way_out(canvas, camera, scene, self.follow)
        if self.own is not None and self.own in present:
            draw_own(canvas, camera, scene, self.own)
        canvas.shrink()
        draw_overlay(canvas, camera, scene, self._history)
        if self.legend:
            draw_caption(canvas, self.caption, self.own)
            draw_explanation(canvas, scene, self.circles)

    def _in_sight(self, scene: Scene, present: np.ndarray) -> np.ndarray:
        """Return the HAVs that may be visible: drawing the others takes as long."""
        low, high = self._camera.seen()
        places = np.stack([scene.x[present], scene.y[present]], axis=1)
        reach = np.maximum(scene.footprint[present], 2.0 * scene.length[present, 0])[:, None]
        if scene.shape is not None:  # no corner is farther from its axle, or front end
            reach = reach + scene.shape[present].sum(axis=-1).max(axis=-1)[:, None]
        seen = ((places + reach > low) & (places - reach < high)).all(axis=1)
        return present[seen]

    def _aim(self, scene: Scene, present: np.ndarray) -> None:
        """Aim the camera at the followed HAV, or at all HAVs, goals and near obstacles."""
        if not len(present):
            return
        if self.follow is not None and self.follow in present:
            hav = self.follow
            center = np.array([scene.x[hav], scene.y[hav]])
            reach = 0.9 * max(scene.footprint[hav], scene.length[hav, 0]) + 8.0  # [m]
            corners = center - reach, center + reach
        else:
            axles = [chain_of(scene, hav) for hav in present]
            outlines = [outlines_of(scene, hav) for hav in present]
            corners_of_all = [found.reshape(-1, 2) for found in outlines if found is not None]
            goals = [scene.goal[present, :2], goal_tips(scene, present)]
            points = np.concatenate([*axles, *corners_of_all, *goals])
            corners = _with_nearby(scene, points.min(axis=0), points.max(axis=0))
        self._camera.aim(*corners, margin=_BORDER * self.size[1], zoom=self._zoom)


def _with_nearby(scene: Scene, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners (2,) of a box [m], extended to the near parts of obstacles."""
    _, parts = clip_segments(scene.segment, low - _NEARBY, high + _NEARBY)
    points = np.concatenate([[low, high], parts.reshape(-1, 2)])
    return points.min(axis=0), points.max(axis=0)
