"""This package defines the catalogue of real vehicles, one file for each family.

A vehicle is a ``Combination`` of numbers. Each number has its source, or the reason for an
assumption. A package of your own adds vehicles by entry points in the group
``hav_env.combinations``, or in JSON files.
"""

from hav_env.models.names import Registry
from hav_env.vehicles.combinations import australia, europe, north_america, yards
from hav_env.vehicles.combinations.combination import Combination, Origin, Unit
from hav_env.vehicles.combinations.written import load_combination, read_combination

_BUILT_IN = (
    *(europe.SEMI_TRAILER, europe.LONG_SEMI_TRAILER, europe.TRUCK_AND_TRAILER),
    *(europe.EUROCOMBI, europe.A_DOUBLE),
    *(north_america.WB_67, north_america.WB_67D, north_america.WB_100T, north_america.WB_109D),
    *(australia.B_DOUBLE, australia.A_TRIPLE),
    *(yards.TERMINAL_TRACTOR, yards.BAGGAGE_TRAIN, yards.TUGGER_TRAIN, yards.FARM_TRAIN),
)

COMBINATIONS = Registry(
    "combination",
    "hav_env.combinations",
    lambda model_class: model_class is Combination,
    "it must be a hav_env.vehicles.Combination",
    {combination.name: combination for combination in _BUILT_IN},
    {".json": load_combination},
)


def catalogue(name: str) -> Combination:
    """Return a real vehicle.

    Args:
        name: a name such as ``"wb-67"``; ``COMBINATIONS.names()`` lists all. ``module:NAME`` is a
            vehicle of your own, and so is the path of a JSON file (``vehicle.schema.json``).

    Raises:
        TypeError: if the name is no text.
        ValueError: if there is no such vehicle; the message lists the names.
    """
    return COMBINATIONS.find(name)


__all__ = [
    "COMBINATIONS",
    "Combination",
    "Origin",
    "Unit",
    "catalogue",
    "load_combination",
    "read_combination",
]
