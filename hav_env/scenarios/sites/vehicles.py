"""This module lists the vehicles of the catalogue on each site."""

SITE_VEHICLES = {
    "gate-2": ("eu-semi-trailer", "eurocombi"),
    "docks-6": ("eu-semi-trailer", "terminal-tractor"),
    "junction-4": ("eu-semi-trailer", "eu-truck-trailer"),
    "parking-8": ("eu-semi-trailer", "eu-truck-trailer"),
    "aisles-6": ("tugger-train",),
    "haul-road-4": ("a-double", "b-double"),
    "roundabout-6": ("eu-semi-trailer", "farm-train"),
    "apron-6": ("baggage-train",),
}
"""Names of vehicles by scenario, in the order of its fleet."""
