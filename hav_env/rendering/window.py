"""This module opens the window: pygame has one in a process, so all viewers share it."""

import os
import weakref
from typing import Any, ClassVar

from hav_env.rendering.canvas import pygame

_UNSEEN = ("dummy", "offscreen")  # SDL's fallback without a display


class NoDisplayError(OSError, RuntimeError):
    """There is no display for a window."""


class Window:
    """A viewer's share of the window, which opens with the first picture.

    It stays open as long as a viewer has a share. Another library may close it at any time: it
    opens again with the next picture.
    """

    _holders: ClassVar[weakref.WeakSet["Window"]] = weakref.WeakSet()
    # surface and size that a viewer opened; a viewer never closes another library's window
    _opened: ClassVar[tuple[pygame.Surface, tuple[int, int]] | None] = None

    def __init__(self, size: tuple[int, int]) -> None:
        """Create a share without a window.

        Args:
            size: width and height in pixels.
        """
        self._size = size
        self._asked_to_close = False

    @property
    def asked_to_close(self) -> bool:
        """Whether the user closed the window while this viewer had a share of it."""
        return self._asked_to_close

    def take_events(self) -> list[Any]:
        """Return the keys pressed since the last call; open the window if necessary.

        Raises:
            NoDisplayError: if there is no display.
        """
        self._open()
        events = pygame.event.get()
        if any(event.type == pygame.QUIT for event in events):
            for holder in Window._holders:
                holder._asked_to_close = True
        return [event for event in events if event.type == pygame.KEYDOWN]

    def show(self, picture: pygame.Surface) -> None:
        """Show a picture."""
        self._open().blit(picture, (0, 0))
        pygame.display.flip()

    def close(self) -> None:
        """Release the window; the last viewer closes it. A second call has no effect."""
        if self not in Window._holders:
            return
        Window._holders.discard(self)
        if not Window._holders and Window._is_ours(_surface()):
            pygame.display.quit()
            Window._opened = None

    def _open(self) -> pygame.Surface:
        surface = _surface()
        ours = surface is None or Window._is_ours(surface)
        if surface is None or surface.get_size() != self._size:
            _need_display()
            surface = pygame.display.set_mode(self._size)
            pygame.display.set_caption("hav_env")
        Window._opened = (surface, self._size) if ours else None
        Window._holders.add(self)
        return surface

    @classmethod
    def _is_ours(cls, surface: pygame.Surface | None) -> bool:
        """Return whether a viewer opened a surface and was the last to set its size.

        There is one surface in a process: another library that opens a window takes it over.
        """
        if surface is None or cls._opened is None:
            return False
        opened, size = cls._opened
        return surface is opened and surface.get_size() == size


def _surface() -> pygame.Surface | None:
    return pygame.display.get_surface() if pygame.display.get_init() else None


def _need_display() -> None:
    """Raise NoDisplayError if a window would be invisible, unless the user requested that."""
    if pygame.display.get_init():
        return
    rule = "render_mode is human, but there is no display: use rgb_array"
    try:
        pygame.display.init()
    except pygame.error as error:
        raise NoDisplayError(f"{rule} ({error})") from None
    asked = os.environ.get("SDL_VIDEODRIVER") or os.environ.get("SDL_VIDEO_DRIVER")
    if pygame.display.get_driver() in _UNSEEN and not asked:
        pygame.display.quit()
        raise NoDisplayError(rule)
