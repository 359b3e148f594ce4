"""This module has a yard with walls, and a scenario of one HAV that drives from place to place."""

import math

from hav_env.places import build_site
from hav_env.scenarios import catalogue_fleet, site_poses

SIDE = 80.0  # [m]
SITE = build_site(
    [(0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE)],
    lines=[[(40.0, 0.0), (40.0, 60.0)]],
)
PLACES = {
    "west": [(12.0, 15.0, math.pi / 2), (26.0, 15.0, math.pi / 2)],
    "east": [(56.0, 15.0, -math.pi / 2), (68.0, 20.0, -math.pi / 2)],
}
WAYS = {"west": ["east"], "east": ["west"]}


def yard(num_havs=1, num_goals=1):
    """Return the scenario: HAVs start in the west, and have the wall between them and the east."""
    fleet = catalogue_fleet("terminal-tractor")
    return site_poses(SITE, fleet, PLACES, WAYS, ["west"], num_havs, num_goals)
