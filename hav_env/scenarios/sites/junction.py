"""This module has a junction of two roads: HAVs from four arms cross, turn left or turn right.

At the end of each arm is a place to turn round, from where HAVs come back to the junction.
"""

import math

import numpy as np

from hav_env.places import build_site
from hav_env.scenarios.catalogue_fleet import catalogue_fleet
from hav_env.scenarios.site_poses import SitePoses, site_poses

VEHICLES = ("eu-semi-trailer", "eu-truck-trailer")
LANE = 4.0
"""Width of a lane [m], two of which are a road; assumed."""
KERB_RADIUS = 12.0
"""Radius of the kerb between two arms [m]; assumed."""
ARM = 45.0
"""Where the arms end [m], from the middle of the junction; assumed."""
HEAD_LENGTH, HEAD_HALF_WIDTH = 72.0, 26.0
"""Of the place to turn round at the end of each arm [m]; assumed."""
WAITING_AT, WAITING_ASIDE = 73.0, (3.0, 7.5)
"""Where the rear axles of waiting trucks are [m], from the middle and to the right; assumed."""
_KERB_STEPS = 6


def junction() -> SitePoses:
    """Return the scenario ``junction-4``: from the four arms to any other arm."""
    edge, corner = LANE, LANE + KERB_RADIUS
    end = ARM + HEAD_LENGTH
    angle = np.linspace(-math.pi / 2, -math.pi, _KERB_STEPS + 1)
    kerb = corner + KERB_RADIUS * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    # from the end of the arm to the east, counter-clockwise to the next arm
    quarter = [(end, HEAD_HALF_WIDTH), (ARM, HEAD_HALF_WIDTH), (ARM, edge)]
    quarter += kerb.tolist()
    quarter += [(edge, ARM), (HEAD_HALF_WIDTH, ARM), (HEAD_HALF_WIDTH, end)]
    bounds, places = [], {}
    for arm, name in enumerate(("east", "north", "west", "south")):
        cosine, sine = round(math.cos(arm * math.pi / 2)), round(math.sin(arm * math.pi / 2))
        bounds += [(cosine * x - sine * y, sine * x + cosine * y) for x, y in quarter]
        x = WAITING_AT
        places[name] = [
            (cosine * x - sine * y, sine * x + cosine * y, math.pi + arm * math.pi / 2)
            for y in WAITING_ASIDE
        ]
    ways = {name: [other for other in places if other != name] for name in places}
    fleet = catalogue_fleet(VEHICLES)
    return site_poses(build_site(bounds), fleet, places, ways, list(places), 4)
