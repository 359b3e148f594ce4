"""This package has real places for scenarios: yards, roads, halls and aprons, one file for each."""

from hav_env.scenarios.sites import docks, gate, junction

BUILDERS = {
    "gate-2": gate.gate,
    "docks-6": docks.docks,
    "junction-4": junction.junction,
}
"""Functions that return the scenarios, by name."""

VEHICLES = {
    "gate-2": gate.VEHICLES,
    "docks-6": docks.VEHICLES,
    "junction-4": junction.VEHICLES,
}
"""Names of the vehicles of each scenario, in the order of its fleet."""

__all__ = ["BUILDERS", "VEHICLES"]
