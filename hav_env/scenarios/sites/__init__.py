"""This package defines real places for scenarios: yards and roads, one file for each."""

from hav_env.scenarios.sites import (
    aisles,
    apron,
    docks,
    gate,
    haul_road,
    junction,
    parking,
    roundabout,
)
from hav_env.scenarios.sites.vehicles import SITE_VEHICLES

BUILDERS = {
    "gate-2": gate.gate,
    "docks-6": docks.docks,
    "junction-4": junction.junction,
    "aisles-6": aisles.aisles,
    "haul-road-4": haul_road.haul_road,
    "parking-8": parking.parking,
    "roundabout-6": roundabout.roundabout,
    "apron-6": apron.apron,
}
"""Functions that return the scenarios, by name."""

__all__ = ["BUILDERS", "SITE_VEHICLES"]
