"""Who starts where and must go where: one file for each kind of scenario, chosen by its type.

A scenario is a NamedTuple that has ``num_havs``, ``num_goals`` and ``max_trailers``, from which the
arrays get their shapes, and ``articulation_max``, beyond which its HAVs are jackknifed [rad]. Where
HAVs are drawn, it has a ``fleet``, which says how.
"""

import functools

from hav_env.compiled import generic
from hav_env.scenarios.column import Column, check_column, populate_column
from hav_env.scenarios.crossing import Crossing, check_crossing, populate_crossing
from hav_env.scenarios.explicit import (
    Explicit,
    check_explicit,
    explicit,
    load_explicit,
    populate_explicit,
)
from hav_env.scenarios.fleets import RandomFleet
from hav_env.scenarios.random_poses import (
    RandomPoses,
    check_random_poses,
    populate_random_poses,
)
from hav_env.scenarios.yard import Yard, check_yard, populate_yard


@generic
def populate(scenario, world, lane):
    """Fill fleet, start poses and goals of the world in one lane from the key of its episode.

    Returns False when the scenario found no room for its HAVs.
    """


@functools.singledispatch
def check_scenario(scenario) -> None:
    """Check a scenario before it is used.

    Raises:
        ValueError: naming the field, its value and what is allowed.
        TypeError: when this is no scenario.
    """
    raise TypeError(f"{scenario!r} is not a scenario: register its type with populate")


class PlacementError(ValueError):
    """A scenario found no room for its HAVs."""


populate.register(RandomPoses)(populate_random_poses)
check_scenario.register(RandomPoses)(check_random_poses)
populate.register(Crossing)(populate_crossing)
check_scenario.register(Crossing)(check_crossing)
populate.register(Yard)(populate_yard)
check_scenario.register(Yard)(check_yard)
populate.register(Column)(populate_column)
check_scenario.register(Column)(check_column)
populate.register(Explicit)(populate_explicit)
check_scenario.register(Explicit)(check_explicit)

__all__ = [
    "Column",
    "Crossing",
    "Explicit",
    "PlacementError",
    "RandomFleet",
    "RandomPoses",
    "Yard",
    "check_scenario",
    "explicit",
    "load_explicit",
    "populate",
]
