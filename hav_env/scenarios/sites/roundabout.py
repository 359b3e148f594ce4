"""This module defines a roundabout with four arms, each with a turning place at its end."""

import math

import numpy as np

from hav_env.places import build_site
from hav_env.scenarios.catalogue_fleet import catalogue_fleet
from hav_env.scenarios.site_poses import SitePoses, site_poses, turn_pose
from hav_env.scenarios.sites.vehicles import SITE_VEHICLES

_ROUNDABOUT_ISLAND = 5.3
"""Radius of the island [m], the inner one of the turning ring in Directive 96/53/EC."""
_ROUNDABOUT_RING = 16.0
"""Outer radius of the ring [m]. The directive's 12.5 m would suffice for ``farm-train`` alone. With
0.3 m to spare outside, ``eu-semi-trailer`` comes within 4.70 m of the centre there. For
``eurocombi`` no drives were found at 16 m."""
_ROUNDABOUT_LANE = 4.0
"""Width of a lane of an arm [m], two of which are a road; assumed."""
_ROUNDABOUT_KERB_RADIUS = 12.0
"""Radius of the kerb between an arm and the ring [m]; assumed."""
_ROUNDABOUT_ARM = 50.0
"""Ends of the arms [m], from the middle of the ring; assumed."""
_ROUNDABOUT_HEAD_LENGTH, _ROUNDABOUT_HEAD_HALF_WIDTH = 88.0, 28.0
"""Size of the turning place at the end of each arm [m]; assumed."""
_ROUNDABOUT_WAITING_AT, _ROUNDABOUT_WAITING_ASIDE = 84.0, (3.0, 7.5)
"""Rear axles of waiting trucks [m], from the middle and to the right; assumed."""
_ROUNDABOUT_ROAD = ((45.0, 2.0, math.pi, 0.0), (48.0, -2.0, 0.0, 0.0))
"""Poses on the lanes of an arm, to the ring and from it; chosen for this scenario."""
_ROUNDABOUT_ON_RING = 11.5
"""Radius of the poses on the ring, halfway between two arms [m]; chosen for this scenario."""
_ROUNDABOUT_STEPS = 6
_ROUNDABOUT_ISLAND_SIDES = 24


def roundabout() -> SitePoses:
    """Return the scenario ``roundabout-6``: from each arm to any other arm."""
    end = _ROUNDABOUT_ARM + _ROUNDABOUT_HEAD_LENGTH
    kerb = (
        math.sqrt(
            (_ROUNDABOUT_RING + _ROUNDABOUT_KERB_RADIUS) ** 2
            - (_ROUNDABOUT_LANE + _ROUNDABOUT_KERB_RADIUS) ** 2
        ),
        _ROUNDABOUT_LANE + _ROUNDABOUT_KERB_RADIUS,
    )
    meets = math.atan2(kerb[1], kerb[0])  # where the kerb touches the ring
    turning = np.linspace(-math.pi / 2, meets - math.pi, _ROUNDABOUT_STEPS + 1)
    entry = np.array(kerb) + _ROUNDABOUT_KERB_RADIUS * np.stack(
        [np.cos(turning), np.sin(turning)], axis=-1
    )
    ring = np.linspace(meets, math.pi / 2 - meets, _ROUNDABOUT_STEPS + 1)[1:-1]
    # from the end of the arm to the east, counter-clockwise to the next arm
    quarter = [
        (end, _ROUNDABOUT_HEAD_HALF_WIDTH),
        (_ROUNDABOUT_ARM, _ROUNDABOUT_HEAD_HALF_WIDTH),
        (_ROUNDABOUT_ARM, _ROUNDABOUT_LANE),
        *entry.tolist(),
    ]
    quarter += [
        (_ROUNDABOUT_RING * math.cos(angle), _ROUNDABOUT_RING * math.sin(angle)) for angle in ring
    ]
    quarter += [(y, x) for x, y in entry[::-1].tolist()]
    quarter += [
        (_ROUNDABOUT_LANE, _ROUNDABOUT_ARM),
        (_ROUNDABOUT_HEAD_HALF_WIDTH, _ROUNDABOUT_ARM),
        (_ROUNDABOUT_HEAD_HALF_WIDTH, end),
    ]
    bounds, places = [], {}
    for arm, name in enumerate(("east", "north", "west", "south")):
        cosine, sine = round(math.cos(arm * math.pi / 2)), round(math.sin(arm * math.pi / 2))
        bounds += [(cosine * x - sine * y, sine * x + cosine * y) for x, y in quarter]
        x = _ROUNDABOUT_WAITING_AT
        places[name] = [
            (cosine * x - sine * y, sine * x + cosine * y, math.pi + arm * math.pi / 2)
            for y in _ROUNDABOUT_WAITING_ASIDE
        ]
    corners = 2.0 * math.pi * np.arange(_ROUNDABOUT_ISLAND_SIDES) / _ROUNDABOUT_ISLAND_SIDES
    island = _ROUNDABOUT_ISLAND * np.stack([np.cos(corners), np.sin(corners)], axis=-1)
    ways = {name: [other for other in places if other != name] for name in places}
    site = build_site(bounds, [island.tolist()])
    aside = _ROUNDABOUT_ON_RING * math.sqrt(0.5)
    on_ring = aside, aside, 0.75 * math.pi, 1.0 / _ROUNDABOUT_ON_RING
    road = [
        turn_pose(pose, arm * math.pi / 2)
        for arm in range(4)
        for pose in (*_ROUNDABOUT_ROAD, on_ring)
    ]
    fleet = catalogue_fleet(SITE_VEHICLES["roundabout-6"])
    return site_poses(site, fleet, places, ways, list(places), 6, road=road)
