"""This module defines a junction of two roads: HAVs from four arms cross or turn.

At the end of each arm HAVs turn round and come back to the junction.
"""

import math

import numpy as np

from hav_env.places import build_site
from hav_env.scenarios.catalogue_fleet import catalogue_fleet
from hav_env.scenarios.site_poses import SitePoses, site_poses, turn_pose
from hav_env.scenarios.sites.vehicles import SITE_VEHICLES

_JUNCTION_LANE = 4.0
"""Width of a lane [m], two of which are a road; assumed."""
_JUNCTION_KERB_RADIUS = 12.0
"""Radius of the kerb between two arms [m]; assumed."""
_JUNCTION_ARM = 45.0
"""Ends of the arms [m], from the middle of the junction; assumed."""
_JUNCTION_HEAD_LENGTH, _JUNCTION_HEAD_HALF_WIDTH = 72.0, 26.0
"""Size of the turning place at the end of each arm [m]; assumed."""
_JUNCTION_WAITING_AT, _JUNCTION_WAITING_ASIDE = 73.0, (3.0, 7.5)
"""Rear axles of waiting trucks [m], from the middle and to the right; assumed."""
_JUNCTION_KERB_STEPS = 6
_JUNCTION_ROAD = ((40.0, 2.0, math.pi), (40.0, -1.5, math.pi), (42.0, -2.0, 0.0), (42.0, 1.5, 0.0))
"""Poses on the lanes of an arm, to the junction and from it; chosen for this scenario."""


def junction() -> SitePoses:
    """Return the scenario ``junction-4``: from the four arms to any other arm."""
    edge, corner = _JUNCTION_LANE, _JUNCTION_LANE + _JUNCTION_KERB_RADIUS
    end = _JUNCTION_ARM + _JUNCTION_HEAD_LENGTH
    angle = np.linspace(-math.pi / 2, -math.pi, _JUNCTION_KERB_STEPS + 1)
    kerb = corner + _JUNCTION_KERB_RADIUS * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    # from the end of the arm to the east, counter-clockwise to the next arm
    quarter = [
        (end, _JUNCTION_HEAD_HALF_WIDTH),
        (_JUNCTION_ARM, _JUNCTION_HEAD_HALF_WIDTH),
        (_JUNCTION_ARM, edge),
    ]
    quarter += kerb.tolist()
    quarter += [
        (edge, _JUNCTION_ARM),
        (_JUNCTION_HEAD_HALF_WIDTH, _JUNCTION_ARM),
        (_JUNCTION_HEAD_HALF_WIDTH, end),
    ]
    bounds, places = [], {}
    for arm, name in enumerate(("east", "north", "west", "south")):
        cosine, sine = round(math.cos(arm * math.pi / 2)), round(math.sin(arm * math.pi / 2))
        bounds += [(cosine * x - sine * y, sine * x + cosine * y) for x, y in quarter]
        x = _JUNCTION_WAITING_AT
        places[name] = [
            (cosine * x - sine * y, sine * x + cosine * y, math.pi + arm * math.pi / 2)
            for y in _JUNCTION_WAITING_ASIDE
        ]
    ways = {name: [other for other in places if other != name] for name in places}
    fleet = catalogue_fleet(SITE_VEHICLES["junction-4"])
    road = [
        turn_pose((x, y, heading, 0.0), arm * math.pi / 2)
        for arm in range(4)
        for x, y, heading in _JUNCTION_ROAD
    ]
    return site_poses(build_site(bounds), fleet, places, ways, list(places), 4, road=road)
