"""This module has a junction of two roads: HAVs from four arms cross, turn left or turn right.

At the end of each arm is a place to turn round, from where HAVs come back to the junction.
"""

import math

import numpy as np

from hav_env.places import build_site
from hav_env.scenarios.catalogue_fleet import catalogue_fleet
from hav_env.scenarios.site_poses import SitePoses, site_poses
from hav_env.scenarios.sites.vehicles import SITE_VEHICLES

_JUNCTION_LANE = 4.0
"""Width of a lane [m], two of which are a road; assumed."""
_JUNCTION_KERB_RADIUS = 12.0
"""Radius of the kerb between two arms [m]; assumed."""
_JUNCTION_ARM = 45.0
"""Where the arms end [m], from the middle of the junction; assumed."""
_JUNCTION_HEAD_LENGTH, _JUNCTION_HEAD_HALF_WIDTH = 72.0, 26.0
"""Of the place to turn round at the end of each arm [m]; assumed."""
_JUNCTION_WAITING_AT, _JUNCTION_WAITING_ASIDE = 73.0, (3.0, 7.5)
"""Where the rear axles of waiting trucks are [m], from the middle and to the right; assumed."""
_JUNCTION_KERB_STEPS = 6


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
    return site_poses(build_site(bounds), fleet, places, ways, list(places), 4)
