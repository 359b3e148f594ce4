"""This module defines the aisles of a warehouse, where tugger trains drive between racks."""

import math

from hav_env.places import build_site
from hav_env.scenarios.catalogue_fleet import catalogue_fleet
from hav_env.scenarios.site_poses import SitePoses, site_poses
from hav_env.scenarios.sites.vehicles import SITE_VEHICLES

_AISLES_NUM_AISLES = 8
_AISLES_AISLE = 3.0
"""Width of an aisle between two racks [m]; chosen for this scenario."""
_AISLES_RACK, _AISLES_RACK_LENGTH = 2.4, 22.0
"""Depth and length of a double rack [m]; assumed: two pallets of 1.2 m."""
_AISLES_CROSS_AISLE = 5.0
"""Width of the aisles at both ends of the racks [m]; assumed."""
_AISLES_STOP = 5.0
"""Stop of a truck's rear axle ahead of the middle of its aisle [m]; assumed."""
_AISLES_ROAD_AT = 14.0
"""Poses in the cross aisles, in both directions between two aisles [m]; chosen."""


def aisles() -> SitePoses:
    """Return the scenario ``aisles-6``: from a place in one aisle to a place in another.

    Aisles are one-way, alternately to the north and to the south.
    """
    pitch, half = _AISLES_AISLE + _AISLES_RACK, 0.5 * _AISLES_RACK_LENGTH
    left = -0.5 * _AISLES_NUM_AISLES * pitch
    racks = []
    for k in range(_AISLES_NUM_AISLES + 1):
        low, high = left + k * pitch - 0.5 * _AISLES_RACK, left + k * pitch + 0.5 * _AISLES_RACK
        racks.append([(low, -half), (high, -half), (high, half), (low, half)])
    end, top = -left + 0.5 * _AISLES_RACK + _AISLES_CROSS_AISLE, half + _AISLES_CROSS_AISLE
    places: dict[str, list[tuple[float, float, float]]] = {"north": [], "south": []}
    for k in range(_AISLES_NUM_AISLES):
        name, side = ("north", 1.0) if k % 2 == 0 else ("south", -1.0)
        places[name].append((left + (k + 0.5) * pitch, side * _AISLES_STOP, side * math.pi / 2))
    ways = {"north": ["south"], "south": ["north"]}
    site = build_site([(-end, -top), (end, -top), (end, top), (-end, top)], racks)
    road = [
        (left + k * pitch, side * _AISLES_ROAD_AT, heading, 0.0)
        for side in (1.0, -1.0)
        for k in range(1, _AISLES_NUM_AISLES)
        for heading in (0.0, math.pi)
    ]
    fleet = catalogue_fleet(SITE_VEHICLES["aisles-6"])
    return site_poses(site, fleet, places, ways, list(places), 6, road=road)
