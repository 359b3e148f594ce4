"""This package defines the scenarios, which place HAVs and goals: one file for each kind.

A scenario is a NamedTuple whose type selects its kernel. The arrays get their shapes from its
fields ``num_havs``, ``num_goals`` and ``max_trailers``, and ``num_segments`` if it has obstacles.
A HAV with an articulation above ``articulation_max`` [rad] is jackknifed. ``fleet`` draws the HAVs
and states the limits of all. ``Explicit`` lists each HAV's lengths and limits, and is its own
fleet.
"""

from typing import Any

from hav_env.compiled import generic
from hav_env.models.annotations import show
from hav_env.models.checks import check_model, check_value
from hav_env.models.quantities import (
    Articulation,
    Goals,
    Havs,
    Length,
    Segments,
    Share,
    Speed,
    Steering,
    Trailers,
)
from hav_env.scenarios.catalogue_fleet import CatalogueFleet, catalogue_fleet
from hav_env.scenarios.column import Column, populate_column
from hav_env.scenarios.crossing import Crossing, populate_crossing
from hav_env.scenarios.explicit import Explicit, explicit, populate_explicit
from hav_env.scenarios.explicit_files import load_explicit
from hav_env.scenarios.fleets import RandomFleet
from hav_env.scenarios.random_poses import RandomPoses, populate_random_poses
from hav_env.scenarios.site_poses import SitePoses, populate_site_poses, site_poses
from hav_env.scenarios.sites.field import Field, populate_field
from hav_env.scenarios.sites.random_site_poses import RandomSitePoses, populate_random_site_poses
from hav_env.scenarios.yard import Yard, populate_yard
from hav_env.world.arrays import World

_ALWAYS = {
    "num_havs": Havs,
    "num_goals": Goals,
    "max_trailers": Trailers,
    "articulation_max": Articulation,
}
_OF_FLEET = {
    "min_length": Length,
    "max_length": Length,
    "speed_max": Speed,
    "steering_max": Steering,
    "articulation_max": Articulation,
    "footprint_truck_share": Share,
}


@generic
def populate(scenario: Any, world: World, lane: int) -> bool:
    """Fill fleet, start poses and goals of the world in one lane from the key of its episode.

    Returns False if the scenario found no space for its HAVs.
    """
    raise NotImplementedError


def check_scenario(scenario: Any) -> None:
    """Check a scenario before its use.

    Raises:
        ValueError: if a field is outside its range; the message names its value and the rule.
        TypeError: if this is no scenario, or a field has a value of another kind.
    """
    check_model("scenario", scenario, populate)
    for name, kind in _ALWAYS.items():  # which may be properties
        check_value(f"scenario {name}", kind, getattr(scenario, name, None))
    if not hasattr(scenario, "fleet"):
        raise TypeError(f"scenario is {show(scenario)}, but must have a fleet: its HAVs' limits")
    check_value("scenario num_segments", Segments, segments_of(scenario))
    for name, kind in _OF_FLEET.items():
        check_value(f"fleet {name}", kind, getattr(scenario.fleet, name, None))


def segments_of(scenario: Any) -> int:
    """Return how many segments of obstacles a world of a scenario can have."""
    return getattr(scenario, "num_segments", 0)


class PlacementError(ValueError):
    """A scenario found no space for its HAVs."""


populate.register(RandomPoses)(populate_random_poses)
populate.register(Crossing)(populate_crossing)
populate.register(Field)(populate_field)
populate.register(Yard)(populate_yard)
populate.register(Column)(populate_column)
populate.register(Explicit)(populate_explicit)
populate.register(SitePoses)(populate_site_poses)
populate.register(RandomSitePoses)(populate_random_site_poses)

__all__ = [
    "CatalogueFleet",
    "Column",
    "Crossing",
    "Explicit",
    "Field",
    "PlacementError",
    "RandomFleet",
    "RandomPoses",
    "RandomSitePoses",
    "SitePoses",
    "Yard",
    "catalogue_fleet",
    "check_scenario",
    "explicit",
    "load_explicit",
    "populate",
    "segments_of",
    "site_poses",
]
