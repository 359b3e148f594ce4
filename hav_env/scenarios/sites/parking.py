"""This module defines a parking area with two rows of oblique drive-through places."""

import math

from hav_env.places import build_site
from hav_env.scenarios.catalogue_fleet import catalogue_fleet
from hav_env.scenarios.site_poses import SitePoses, site_poses
from hav_env.scenarios.sites.vehicles import SITE_VEHICLES

_PARKING_IN_A_ROW = 5
_PARKING_OBLIQUE = math.radians(60.0)
"""Angle between the places and the row [rad]; assumed."""
_PARKING_WIDTH = 4.2
"""Width of a place [m], with half of the kerbs on both sides; assumed."""
_PARKING_KERB, _PARKING_KERB_LENGTH = 0.4, 12.0
"""Width and length of the kerbs between places [m]; assumed."""
_PARKING_STOP = 3.0
"""Stop of a truck's rear axle ahead of the middle of its place [m]; assumed."""
_PARKING_GAP = 26.0
"""Distance of the rows [m]; assumed, with a building in the middle."""
_PARKING_BUILDING = 8.0
"""Length and width of the building [m]; assumed."""
_PARKING_BESIDE, _PARKING_DEPTH = 32.0, 42.0
"""Distances from the rows, and from the middle of a row, to the bounds [m]; assumed."""


def parking() -> SitePoses:
    """Return the scenario ``parking-8``: from a place of one row to a place of the other."""
    pitch = _PARKING_WIDTH / math.sin(_PARKING_OBLIQUE)
    cosine, sine = math.cos(_PARKING_OBLIQUE), math.sin(_PARKING_OBLIQUE)
    row = _PARKING_IN_A_ROW * pitch
    kerbs, places = [], {}
    for name, left, side in (
        ("west", -_PARKING_GAP / 2 - row, 1.0),
        ("east", _PARKING_GAP / 2, -1.0),
    ):
        heading = _PARKING_OBLIQUE if side > 0.0 else _PARKING_OBLIQUE - math.pi
        places[name] = [
            (
                left + (k + 0.5) * pitch + side * _PARKING_STOP * cosine,
                side * _PARKING_STOP * sine,
                heading,
            )
            for k in range(_PARKING_IN_A_ROW)
        ]
        for k in range(_PARKING_IN_A_ROW + 1):
            x, half, thick = (
                left + k * pitch,
                0.5 * _PARKING_KERB_LENGTH,
                0.5 * _PARKING_KERB / sine,
            )
            ends = half * cosine, half * sine
            kerbs.append(
                [
                    (x - ends[0] - thick, -ends[1]),
                    (x - ends[0] + thick, -ends[1]),
                    (x + ends[0] + thick, ends[1]),
                    (x + ends[0] - thick, ends[1]),
                ]
            )
    b, end = 0.5 * _PARKING_BUILDING, _PARKING_GAP / 2 + row + _PARKING_BESIDE
    building = [(-b, -b), (b, -b), (b, b), (-b, b)]
    bounds = [
        (-end, -_PARKING_DEPTH),
        (end, -_PARKING_DEPTH),
        (end, _PARKING_DEPTH),
        (-end, _PARKING_DEPTH),
    ]
    ways = {"west": ["east"], "east": ["west"]}
    site = build_site(bounds, [*kerbs, building])
    return site_poses(
        site, catalogue_fleet(SITE_VEHICLES["parking-8"]), places, ways, list(places), 8
    )
