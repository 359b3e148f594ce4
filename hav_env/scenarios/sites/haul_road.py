"""This module defines a two-way haul road with a bend, between a loading and a dumping loop."""

import math

import numpy as np

from hav_env.places import build_site
from hav_env.scenarios.catalogue_fleet import catalogue_fleet
from hav_env.scenarios.site_poses import SitePoses, site_poses
from hav_env.scenarios.sites.vehicles import SITE_VEHICLES

_HAUL_LANE = 4.4
"""Width of a lane [m]; assumed: a road of 3.5 times the width of the vehicles, 2.5 m."""
_HAUL_STRAIGHT, _HAUL_BEND = 40.0, 50.0
"""Straights of the road [m], and radius of the quarter circle between them; assumed."""
_HAUL_LOOP_LENGTH, _HAUL_LOOP_HALF_WIDTH = 145.0, 38.0
"""Size of the places with the loops [m]; assumed: vehicles can turn and wait straight."""
_HAUL_PILE = ((-95.0, -3.0), (-40.0, 10.0))
"""Two corners of the pile inside of a loop [m], from the mouth of the road; assumed."""
_HAUL_STOP, _HAUL_LANES_AT = -62.0, (-11.0, -16.0, -21.0, -26.0)
"""Stops of the trucks' rear axles [m], from the mouth of the road; assumed."""
_HAUL_BEND_STEPS = 12


def haul_road() -> SitePoses:
    """Return the scenario ``haul-road-4``: from the loading loop to the dumping loop and back."""
    angle = np.linspace(0.0, math.pi / 2, _HAUL_BEND_STEPS + 1)
    middle = np.array([_HAUL_STRAIGHT, -_HAUL_BEND])
    around = np.stack([np.sin(angle), np.cos(angle)], axis=-1)
    outer = (middle + (_HAUL_BEND + _HAUL_LANE) * around).tolist()
    inner = (middle + (_HAUL_BEND - _HAUL_LANE) * around).tolist()
    loop = [
        (0.0, _HAUL_LANE),
        (0.0, _HAUL_LOOP_HALF_WIDTH),
        (-_HAUL_LOOP_LENGTH, _HAUL_LOOP_HALF_WIDTH),
    ]
    loop += [
        (-_HAUL_LOOP_LENGTH, -_HAUL_LOOP_HALF_WIDTH),
        (0.0, -_HAUL_LOOP_HALF_WIDTH),
        (0.0, -_HAUL_LANE),
    ]
    bounds = [*outer[::-1], *loop, *inner, *map(_turned, loop)]
    (x0, y0), (x1, y1) = _HAUL_PILE
    pile = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    loading = [(_HAUL_STOP, y, 0.0) for y in _HAUL_LANES_AT]
    dumping = [(*_turned((x, y)), math.pi / 2) for x, y, _ in loading]
    site = build_site(bounds, [pile, [_turned(point) for point in pile]])
    fleet = catalogue_fleet(SITE_VEHICLES["haul-road-4"])
    places = {"loading": loading, "dumping": dumping}
    ways = {"loading": ["dumping"], "dumping": ["loading"]}
    return site_poses(site, fleet, places, ways, list(places), 4)


def _turned(point: tuple[float, float]) -> tuple[float, float]:
    """Return the point of the dumping loop that matches a point of the loading loop.

    The map is a quarter turn, as the road's.
    """
    x, y = point
    return _HAUL_STRAIGHT + _HAUL_BEND - y, -_HAUL_BEND - _HAUL_STRAIGHT + x
