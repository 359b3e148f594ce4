"""This module defines an apron: baggage trains drive from a hall to parked aircraft.

All drive round the apron in one direction: through the hall to the south, along the road behind
the aircraft, between the wings to the north, and back along the road before their noses.
"""

import math

from hav_env.places import build_site
from hav_env.scenarios.catalogue_fleet import catalogue_fleet
from hav_env.scenarios.site_poses import SitePoses, site_poses
from hav_env.scenarios.sites.vehicles import SITE_VEHICLES

_APRON_NUM_AIRCRAFT, _APRON_PITCH = 3, 58.0
"""Aircraft beside each other, and the distance of their axes [m]; assumed: 22 m between wing tips.
"""
_APRON_AIRCRAFT_HALF = (
    (0.0, 0.0),
    (1.98, -4.0),
    (1.98, -12.0),
    (17.9, -20.0),
    (17.9, -21.5),
    (6.0, -18.5),
    (1.98, -18.5),
    (1.6, -31.0),
    (6.2, -34.0),
    (6.2, -35.5),
    (0.8, -35.5),
    (0.3, -37.6),
)
"""Right half of an aircraft [m], from its nose. It is 37.6 m long with a fuselage of 3.95 m, like
an A320 (Wikipedia, Airbus A320 family). Wings and tail are assumed: a span of 35.8 m."""
_APRON_NUM_LANES = 8
_APRON_LANE, _APRON_WALL, _APRON_LANE_LENGTH = 3.2, 0.3, 22.0
"""Clear width of a lane of the hall, thickness and length of its walls [m]; assumed."""
_APRON_HALL = (-102.0, -8.0)
"""North-western corner of the hall [m]; assumed."""
_APRON_HALL_STOP = -26.0
"""Where the rear axle of a tractor stands in the hall, to the north [m]; assumed."""
_APRON_STAND_ASIDE, _APRON_STAND_STOP = 8.0, -30.0
"""Where it stands beside an aircraft, behind the wing: from its axis and its nose [m]; assumed: a
belt loader fits between the train and the hold."""
_APRON_WEST, _APRON_SOUTH, _APRON_EAST, _APRON_NORTH = -114.0, -70.0, 158.0, 20.0
"""Bounds of the apron [m]; assumed."""
_APRON_BEHIND = tuple((x, -60.0, 0.0, 0.0) for x in (-48.0, 12.0, 72.0))
_APRON_BEFORE = tuple((x, 10.0, math.pi, 0.0) for x in (-58.0, 14.0, 87.0))
"""Poses on the roads behind the aircraft and before their noses; chosen for this scenario."""
_APRON_OUT, _APRON_BETWEEN = (19.0, -25.5), -12.0
"""Poses beside a wing: from the axis and the nose of an aircraft; and between two wings: from their
noses [m]; chosen for this scenario."""


def apron() -> SitePoses:
    """Return the scenario ``apron-6``: from the baggage hall to an aircraft and back."""
    left, top = _APRON_HALL
    pitch = _APRON_LANE + _APRON_WALL
    walls = []
    for k in range(_APRON_NUM_LANES + 1):
        low, high = left + k * pitch, left + k * pitch + _APRON_WALL
        bottom = top - _APRON_LANE_LENGTH
        walls.append([(low, bottom), (high, bottom), (high, top), (low, top)])
    mirrored = [(-x, y) for x, y in _APRON_AIRCRAFT_HALF[:0:-1]]
    axes = [k * _APRON_PITCH for k in range(_APRON_NUM_AIRCRAFT)]
    aircraft = [[(at + x, y) for x, y in (*_APRON_AIRCRAFT_HALF, *mirrored)] for at in axes]
    bounds = [
        (_APRON_WEST, _APRON_SOUTH),
        (_APRON_EAST, _APRON_SOUTH),
        (_APRON_EAST, _APRON_NORTH),
        (_APRON_WEST, _APRON_NORTH),
    ]
    first = left + _APRON_WALL + 0.5 * _APRON_LANE
    places = {
        "hall": [
            (first + k * pitch, _APRON_HALL_STOP, -math.pi / 2) for k in range(_APRON_NUM_LANES)
        ],
        "aircraft": [
            (at + side * _APRON_STAND_ASIDE, _APRON_STAND_STOP, math.pi / 2)
            for at in axes
            for side in (-1.0, 1.0)
        ],
    }
    ways = {"hall": ["aircraft"], "aircraft": ["hall"]}
    site = build_site(bounds, [*walls, *aircraft])
    fleet = catalogue_fleet(SITE_VEHICLES["apron-6"])
    return site_poses(site, fleet, places, ways, ["hall"], 6, road=_road(axes))


def _road(axes: list[float]) -> list[tuple[float, float, float, float]]:
    """Return the road poses: round the apron, and beside each aircraft."""
    aside, y = _APRON_OUT
    out = [
        (at + side * aside, y, 0.0 if side > 0.0 else math.pi, 0.0)
        for at in axes
        for side in (-1.0, 1.0)
    ]
    gaps = [axes[0] - 0.5 * _APRON_PITCH, *(at + 0.5 * _APRON_PITCH for at in axes)]
    between = [(x, _APRON_BETWEEN, math.pi / 2, 0.0) for x in gaps]
    return [*_APRON_BEHIND, *out, *between, *_APRON_BEFORE]
