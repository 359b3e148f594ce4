"""This module defines a wall with a narrow gate that HAVs pass from both sides.

Behind the gate, on both sides, is a yard where a HAV turns round and waits for its next passage.
"""

import math

from hav_env.places import build_site
from hav_env.scenarios.catalogue_fleet import catalogue_fleet
from hav_env.scenarios.site_poses import SitePoses, site_poses, turn_pose
from hav_env.scenarios.sites.vehicles import SITE_VEHICLES

_GATE_VEHICLE_WIDTH = 2.55
"""Width of both vehicles [m], the most that Directive 96/53/EC allows."""
_GATE_SPARE = 1.0
"""Width of the gate beyond that [m]; chosen for this scenario."""
_GATE_WALL = 0.4
"""Thickness of the wall [m]; assumed."""
_GATE_YARD_LENGTH, _GATE_YARD_WIDTH = 100.0, 52.0
"""Size of the yard on each side [m]; assumed: a half circle of the longest vehicle fits."""
_GATE_WAITING_AT, _GATE_WAITING_ASIDE = 54.0, 13.0
"""Rear axles of waiting trucks [m], from the gate and from its axis; assumed."""
_GATE_ROAD_AT = (-9.0, 22.0)
"""Positions before and behind the gate where vehicles are straight [m]; chosen."""


def gate() -> SitePoses:
    """Return the scenario ``gate-2``: one HAV starts on each side."""
    half, opening, thick = (
        0.5 * _GATE_YARD_WIDTH,
        0.5 * (_GATE_VEHICLE_WIDTH + _GATE_SPARE),
        0.5 * _GATE_WALL,
    )
    walls = [
        [
            (x, side * y)
            for x, y in ((-thick, opening), (thick, opening), (thick, half), (-thick, half))
        ]
        for side in (-1.0, 1.0)
    ]
    ends = [
        (-_GATE_YARD_LENGTH, -half),
        (_GATE_YARD_LENGTH, -half),
        (_GATE_YARD_LENGTH, half),
        (-_GATE_YARD_LENGTH, half),
    ]
    x, y = _GATE_WAITING_AT, _GATE_WAITING_ASIDE
    places = {
        "west": [(-x, -y, 0.0)],
        "other west": [(-x, y, 0.0)],
        "east": [(x, y, math.pi)],
        "other east": [(x, -y, math.pi)],
    }
    west, east = ("west", "other west"), ("east", "other east")
    ways = {**dict.fromkeys(west, east), **dict.fromkeys(east, west)}
    fleet = catalogue_fleet(SITE_VEHICLES["gate-2"])
    road = [turn_pose((x, 0.0, 0.0, 0.0), angle) for x in _GATE_ROAD_AT for angle in (0.0, math.pi)]
    site = build_site(ends, walls)
    return site_poses(site, fleet, places, ways, ("west", "east"), 2, road=road)
