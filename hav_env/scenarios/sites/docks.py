"""This module defines a yard with drive-through docks and waiting lanes."""

import math

from hav_env.places import build_site
from hav_env.scenarios.catalogue_fleet import catalogue_fleet
from hav_env.scenarios.site_poses import SitePoses, site_poses
from hav_env.scenarios.sites.vehicles import SITE_VEHICLES

_DOCKS_NUM_DOCKS = 8
_DOCKS_BAY = 4.0
"""Clear width of a bay between two dock walls [m]; chosen for this scenario."""
_DOCKS_WALL, _DOCKS_WALL_LENGTH = 0.3, 18.0
"""Thickness and length of dock walls [m]; assumed: a little longer than an articulated vehicle of
16.5 m, the most that Directive 96/53/EC allows."""
_DOCKS_STOP = 13.0
"""Stop of a truck's rear axle in its bay [m], from the bay's entrance; assumed."""
_DOCKS_LANES_AT = (32.0, 36.5, 41.0)
"""Waiting lanes on each side [m], from the yard's middle axis; assumed."""
_DOCKS_HALF_WIDTH, _DOCKS_SOUTH, _DOCKS_NORTH = 50.0, -46.0, 54.0
"""Bounds of the yard [m]; assumed."""


def docks() -> SitePoses:
    """Return the scenario ``docks-6``: from a waiting lane through a dock and to a lane again."""
    pitch = _DOCKS_BAY + _DOCKS_WALL
    left = -0.5 * _DOCKS_NUM_DOCKS * pitch
    walls = []
    for k in range(_DOCKS_NUM_DOCKS + 1):
        low, high = left + k * pitch - 0.5 * _DOCKS_WALL, left + k * pitch + 0.5 * _DOCKS_WALL
        walls.append(
            [(low, 0.0), (high, 0.0), (high, _DOCKS_WALL_LENGTH), (low, _DOCKS_WALL_LENGTH)]
        )
    bounds = [
        (-_DOCKS_HALF_WIDTH, _DOCKS_SOUTH),
        (_DOCKS_HALF_WIDTH, _DOCKS_SOUTH),
        (_DOCKS_HALF_WIDTH, _DOCKS_NORTH),
        (-_DOCKS_HALF_WIDTH, _DOCKS_NORTH),
    ]
    places = {
        "dock": [
            (left + (k + 0.5) * pitch, _DOCKS_STOP, math.pi / 2) for k in range(_DOCKS_NUM_DOCKS)
        ],
        "lane": [(side * x, 0.0, -math.pi / 2) for side in (-1.0, 1.0) for x in _DOCKS_LANES_AT],
    }
    ways = {"dock": ["lane"], "lane": ["dock"]}
    site = build_site(bounds, walls)
    return site_poses(site, catalogue_fleet(SITE_VEHICLES["docks-6"]), places, ways, ["lane"], 6)
