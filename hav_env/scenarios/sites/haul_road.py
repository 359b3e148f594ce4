"""This module defines a two-way haul road with a bend, between a loading and a dumping loop."""

import math

import numpy as np

from hav_env.places import build_site
from hav_env.scenarios.catalogue_fleet import catalogue_fleet
from hav_env.scenarios.site_poses import SitePoses, site_poses, turn_pose
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
_HAUL_OUT, _HAUL_INTO = (30.0, -2.2, 0.0, 0.0), (9.0, 2.2, math.pi, 0.0)
"""Poses on the lanes of the road, out of a loop and into it; chosen for this scenario."""
_HAUL_ROUND_PILE = ((-55.0, 22.0, math.pi, 0.0), (-118.0, 2.0, -math.pi / 2, 0.0))
"""Poses round the pile; chosen for this scenario."""
_HAUL_IN_BEND = 49.6, 52.2
"""Radii of the poses in the middle of the bend [m], to the dumping loop and from it; chosen: road
trains on the inner lane need a part of the outer one."""
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
    return site_poses(site, fleet, places, ways, list(places), 4, road=_road())


def _road() -> list[tuple[float, float, float, float]]:
    """Return the road poses: along the lanes, and round the piles."""
    loop = [_HAUL_OUT, _HAUL_INTO, *_HAUL_ROUND_PILE]
    road = [
        *loop,
        *((*_turned((x, y)), *turn_pose((x, y, h, k), math.pi / 2)[2:]) for x, y, h, k in loop),
    ]
    for radius, side in zip(_HAUL_IN_BEND, (-1.0, 1.0), strict=True):
        aside = radius * math.sqrt(0.5)
        x, y = _HAUL_STRAIGHT + aside, aside - _HAUL_BEND
        heading = -math.pi / 4 if side < 0.0 else 0.75 * math.pi
        road.append((x, y, heading, side / radius))
    return road


def _turned(point: tuple[float, float]) -> tuple[float, float]:
    """Return the point of the dumping loop that matches a point of the loading loop.

    The map is a quarter turn, as the road's.
    """
    x, y = point
    return _HAUL_STRAIGHT + _HAUL_BEND - y, -_HAUL_BEND - _HAUL_STRAIGHT + x
