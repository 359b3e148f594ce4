"""This module defines the bodies of vehicles: lines, as in the paper, or rectangles."""

from typing import NamedTuple

import hav_env.world.rectangle_bodies  # noqa: F401  (registers what rectangles do)
from hav_env.models.quantities import BodyWidth, Overhang
from hav_env.world.units.parts import Lines


class Rectangles(NamedTuple):
    """Rectangles from front end to axle of each unit, with overhangs.

    The numbers apply to HAVs whose fleet states no bodies, such as the paper's. The default width
    is the most that Council Directive 96/53/EC allows.
    """

    width: BodyWidth = 2.55
    """Width [m]; 0 gives lines."""
    front: Overhang = 0.0
    """Overhang of a unit ahead of its front end [m]: the truck's front axle, or a hitch."""
    rear: Overhang = 0.0
    """Overhang of a unit behind its axle [m]."""


Bodies = Lines | Rectangles
