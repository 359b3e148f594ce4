"""Who starts where and must go where: one file for each kind of scenario, chosen by its type.

A scenario is a NamedTuple that has ``num_havs``, ``num_goals`` and ``max_trailers``, from which the
arrays get their shapes, and ``articulation_max``, beyond which its HAVs are jackknifed [rad]. Where
HAVs are drawn, it has a ``fleet``, which says how.
"""

from hav_env.compiled import generic
from hav_env.models.checks import check_model, check_value
from hav_env.models.quantities import Articulation, Goals, Havs, Trailers
from hav_env.scenarios.column import Column, populate_column
from hav_env.scenarios.crossing import Crossing, populate_crossing
from hav_env.scenarios.explicit import Explicit, explicit, populate_explicit
from hav_env.scenarios.explicit_files import load_explicit
from hav_env.scenarios.fleets import RandomFleet
from hav_env.scenarios.random_poses import RandomPoses, populate_random_poses
from hav_env.scenarios.yard import Yard, populate_yard

_ALWAYS = {
    "num_havs": Havs,
    "num_goals": Goals,
    "max_trailers": Trailers,
    "articulation_max": Articulation,
}


@generic
def populate(scenario, world, lane):
    """Fill fleet, start poses and goals of the world in one lane from the key of its episode.

    Returns False when the scenario found no room for its HAVs.
    """


def check_scenario(scenario) -> None:
    """Check a scenario before it is used.

    Raises:
        ValueError: naming the field, its value and what is allowed.
        TypeError: when this is no scenario, or a field has a value of another kind.
    """
    check_model("scenario", scenario, populate)
    for name, kind in _ALWAYS.items():  # which may be properties
        check_value(f"scenario {name}", kind, getattr(scenario, name, None))


class PlacementError(ValueError):
    """A scenario found no room for its HAVs."""


populate.register(RandomPoses)(populate_random_poses)
populate.register(Crossing)(populate_crossing)
populate.register(Yard)(populate_yard)
populate.register(Column)(populate_column)
populate.register(Explicit)(populate_explicit)

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
