"""This module has the bodies of vehicles: lines, as in the paper, or rectangles with a width."""

from typing import NamedTuple

import hav_env.world.rectangle_bodies  # noqa: F401  (registers what rectangles do)
from hav_env.models.quantities import BodyWidth, Overhang
from hav_env.world.units.parts import Lines


class Rectangles(NamedTuple):
    """Each unit is a rectangle, from its front end to its axle and as far beyond as it sticks out.

    The numbers are for HAVs whose fleet states no bodies, as the paper's do not. The default width
    is the most that Council Directive 96/53/EC allows.
    """

    width: BodyWidth = 2.55
    """[m]; 0 gives lines."""
    front: Overhang = 0.0
    """How far a unit sticks out ahead of its front end [m]: the truck's front axle, or a hitch."""
    rear: Overhang = 0.0
    """How far a unit sticks out behind its axle [m]."""


Bodies = Lines | Rectangles
