"""This package draws one world: ``Scene`` is its visible state, ``viewer.Viewer`` draws it.

This package needs NumPy only. ``hav_env.rendering.viewer`` needs pygame-ce, so only code that draws
imports it.
"""

from hav_env.rendering.scene import Scene, describe, scene_of

__all__ = ["Scene", "describe", "scene_of"]
