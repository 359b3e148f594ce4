"""This module renders environments, and imports pygame only for those that draw."""

from typing import Any

import numpy as np

from hav_env.models.annotations import show
from hav_env.simulator.batch import Batch
from hav_env.world.arrays import STEP

ENV_RENDER_MODES = ["human", "rgb_array", "ansi"]
RENDER_FPS = 30
_DRAWN = ("human", "rgb_array")


class Screen:
    """Shows worlds of a batch in one mode, with one viewer for each shown world."""

    def __init__(
        self,
        render_mode: str | None,
        batch: Batch,
        modes: list[str] = ENV_RENDER_MODES,
        command: np.ndarray | None = None,
    ) -> None:
        """Create no viewer yet.

        Args:
            render_mode: None, or one of ``modes``.
            batch: The worlds.
            modes: Modes that the environment supports.
            command: (2, N, W) array that will hold the last commands; None if unknown.

        Raises:
            ValueError: If the mode is neither None nor one of ``modes``.
            ImportError: If the mode needs pygame-ce and it is not installed.
        """
        known = isinstance(render_mode, str) and render_mode in modes
        if render_mode is not None and not known:
            message = f"render_mode is {show(render_mode)}"
            raise ValueError(f"{message}, but must be None or one of {', '.join(modes)}")
        if render_mode in _DRAWN:
            import hav_env.rendering.viewer  # noqa: F401, PLC0415  see above
        self.render_mode, self._batch, self._command = render_mode, batch, command
        self.caption: tuple[str, ...] = ()  # of the viewers that are made from now on
        self.own: int | None = None  # number of the HAV that the user drives
        self._viewers: dict[int, Any] = {}

    def show(self, w: int = 0) -> np.ndarray | str | None:
        """Return the picture of a world: an array (H, W, 3), a line of text, or None (a window).

        Raises:
            OSError: If there is no display for a window.
        """
        if self.render_mode is None:
            return None
        from hav_env.rendering.scene import describe, scene_of  # noqa: PLC0415  (see above)

        worlds, command = self._batch.worlds, None
        if self._command is not None and worlds.state.clock[STEP, w] > 0:
            command = self._command[:, :, w].T
        scene = scene_of(worlds, w, self._batch.task.dt, command=command)
        if self.render_mode == "ansi":
            return describe(scene)
        if w not in self._viewers:
            from hav_env.rendering.viewer import Viewer  # noqa: PLC0415

            self._viewers[w] = Viewer(
                self.render_mode,
                frames_per_second=RENDER_FPS,
                caption=self.caption,
                own=self.own,
            )
        return self._viewers[w].draw(scene)

    def forget(self, worlds: np.ndarray) -> None:
        """Start new trails in the worlds (W,) that are true."""
        for w, viewer in self._viewers.items():
            if worlds[w]:
                viewer.forget()

    def close(self) -> None:
        """Close all windows."""
        for viewer in self._viewers.values():
            viewer.close()
        self._viewers.clear()
