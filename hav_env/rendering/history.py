"""This module keeps the recent past of a scene: trails of the trucks, and the latest events."""

import collections

import numpy as np

from hav_env.rendering.scene import Scene, harms_of

_FEW_EVADERS = 10  # largest number of HAVs with entries for evasions
_SPACING = 1.0  # s between two points of a trail
_TRAIL = 240  # points
_MOST_NOTED = 6
_AGAIN = 20.0  # s, least time between equal entries: an evasion may flicker


class History:
    """Trails and events, gathered from scene to scene.

    Attributes:
        events: (time [s], text), the latest last.
    """

    def __init__(self) -> None:
        """Create an empty history."""
        self.events: collections.deque[tuple[float, str]] = collections.deque(maxlen=_MOST_NOTED)
        self._places: collections.deque[np.ndarray] = collections.deque(maxlen=_TRAIL)
        self._kept_at = -np.inf
        self._before: Scene | None = None

    def follows(self, scene: Scene) -> bool:
        """Return whether a scene can continue, or repeat, the episode so far."""
        before = self._before
        if before is None:
            return True
        return scene.time >= before.time and len(scene.x) == len(before.x)

    def observe(self, scene: Scene) -> None:
        """Add the next scene."""
        if self._before is not None:
            for text in _tell(self._before, scene):
                if not self._told_lately(text, scene.time):
                    self.events.append((scene.time, text))
        if scene.time >= self._kept_at + _SPACING:
            self._places.append(np.stack([scene.x, scene.y], axis=1))
            self._kept_at = scene.time
        self._before = scene

    def _told_lately(self, text: str, time: float) -> bool:
        return any(told == text and time < when + _AGAIN for when, told in self.events)

    def trails(self, scene: Scene) -> np.ndarray:
        """Return the positions of the trucks, (T, N, 2) [m], from the oldest to the current one."""
        return np.stack([*self._places, np.stack([scene.x, scene.y], axis=1)])


def _tell(before: Scene, scene: Scene) -> list[str]:
    """Return the events between two scenes."""
    told = []
    for hav in range(len(scene.x)):
        name = f"HAV {hav}"
        if scene.hits[hav] > before.hits[hav]:
            verb = "arrives at" if scene.hits[hav] == scene.num_goals else "hits"
            told.append(f"{name} {verb} goal {scene.hits[hav]}")
        known = harms_of(before, hav)
        told += [f"{name} {event.state}" for event in harms_of(scene, hav) if event not in known]
        if scene.removed[hav] and not before.removed[hav]:
            told.append(f"{name} removed")
        evaded = scene.evaded[hav]
        if len(scene.x) <= _FEW_EVADERS and evaded >= 0 and evaded != before.evaded[hav]:
            told.append(f"{name} evades HAV {evaded}")
    together = scene.phase.min() == scene.phase.max()
    if together and scene.phase.min() > before.phase.min():
        told.append(f"goal {scene.phase.min() + 1} for all")
    return told
