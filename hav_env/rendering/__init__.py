"""Drawing of one world: ``Scene`` is what there is to see, ``viewer.Viewer`` draws it.

This package needs NumPy only; ``hav_env.rendering.viewer`` needs pygame-ce and is imported by those
who draw.
"""

from hav_env.rendering.scene import Scene, describe, scene_of

__all__ = ["Scene", "describe", "scene_of"]
