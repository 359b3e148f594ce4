"""This module names scenarios, for papers to cite; the meaning of a name does not change.

| name | scenario |
|---|---|
| ``paper-single`` | the paper's with one HAV: random start, two random goals |
| ``paper-pair`` | the paper's with two HAVs, in a square four times as large as their footprints |
| ``swarm-5``, ``-10``, ``-20``, ``-50``, ``-200`` | the same with that number of HAVs |
| ``dense-2``, ``-5``, ``-10``, ``-20``, ``-50`` | the same in half the area |
| ``crossing-2``, ``-8`` | that number of HAVs on a circle, through its centre to the other side |
| ``yard-4``, ``-10`` | from a row of that number of bays into random bays opposite |
| ``column-5`` | five HAVs one behind the other, 200 m straight on |
| ``field-1``, ``field-4`` | that number of real vehicles among 32 random walls in 120 m x 120 m |
| ``gate-2`` | two HAVs from both sides of a gate that is 1 m wider than they |
| ``docks-6`` | six HAVs in a yard: from waiting lanes through docks and back |
| ``junction-4`` | four HAVs at a junction of two roads |
| ``aisles-6`` | six tugger trains in a warehouse with aisles of 3 m |
| ``haul-road-4`` | four long trucks on a two-way road between two loops |
| ``parking-8`` | eight HAVs in two rows of oblique places that they drive through |
| ``roundabout-6`` | six HAVs at a roundabout with four arms |
| ``apron-6`` | six baggage trains between a hall and parked aircraft |

The fleets are the paper's but for those from ``field-1`` on. Their vehicles need
``vehicle="realistic"``. Everything else is in the docstrings of the classes and in
docs/sites-catalogue.md, which has the real places (``SITES``).
"""

import os
from typing import Any, cast

from hav_env.models.annotations import show
from hav_env.models.checks import check_value
from hav_env.models.names import Registry
from hav_env.models.protocols import Scenario
from hav_env.models.quantities import Havs
from hav_env.places import Site
from hav_env.scenarios import (
    Column,
    Crossing,
    Explicit,
    Field,
    RandomPoses,
    Yard,
    check_scenario,
    load_explicit,
    populate,
)
from hav_env.scenarios.catalogue_fleet import fleet_of
from hav_env.scenarios.sites import BUILDERS
from hav_env.scenarios.sites.at_site import put_on_site, read_site

SCENARIOS: dict[str, Any] = {
    "paper-single": RandomPoses(num_havs=1),
    "paper-pair": RandomPoses(num_havs=2),
    **{f"swarm-{n}": RandomPoses(num_havs=n) for n in (5, 10, 20, 50, 200)},
    **{f"dense-{n}": RandomPoses(num_havs=n, area_factor=2.0) for n in (2, 5, 10, 20, 50)},
    "crossing-2": Crossing(num_havs=2),
    "crossing-8": Crossing(num_havs=8),
    "yard-4": Yard(num_havs=4),
    "yard-10": Yard(num_havs=10),
    "column-5": Column(num_havs=5),
}

FIELDS: dict[str, Any] = {f"field-{n}": Field(num_havs=n) for n in (1, 4)}
"""Scenarios among random walls, which need a vehicle model that knows hitches."""

SITES: dict[str, Any] = {name: build() for name, build in BUILDERS.items()}
"""Scenarios at real places, which need a vehicle model that knows hitches."""


REGISTRY = Registry(
    "scenario",
    "hav_env.scenarios",
    populate.table.__contains__,
    "register it with populate.register",
    SCENARIOS | FIELDS | SITES,
    {".json": load_explicit},
)


def find_scenario(name: str | os.PathLike[str]) -> Scenario:
    """Return a scenario by its name; one of a class has that class's defaults.

    Args:
        name: one of those above or of another package, ``module:Class`` of your own, or the path
            of a JSON file. A ``PathLike`` is always a file.

    Raises:
        TypeError: when this is neither a name nor a path, or the class has no defaults.
        ValueError: when there is no such scenario or the file is broken.
    """
    return REGISTRY.make(name if isinstance(name, str | os.PathLike) else REGISTRY.find(name))


def scenario_of(
    scenario: Scenario | str | os.PathLike[str],
    num_havs: int | None = None,
    site: Site | str | os.PathLike[str] | None = None,
    fleet: Any = None,
) -> Scenario:
    """Return a checked scenario.

    Args:
        scenario: a scenario, or its name or file, see ``find_scenario``.
        num_havs: number of HAVs, if it differs from the scenario's.
        site: obstacles and bounds for the scenario, or their file, see ``load_site``.
        fleet: vehicles in place of the scenario's: a fleet, or vehicles as ``fleet_of`` takes them.

    Raises:
        ValueError: when there is no such scenario, a parameter is not allowed, the scenario writes
            its HAVs down and has another number of them or other vehicles, or it cannot be put on
            a site.
        TypeError: when this is no scenario, no site, or no fleet.
    """
    found = find_scenario(scenario) if isinstance(scenario, str | os.PathLike) else scenario
    check_scenario(found)
    if fleet is not None:
        if "fleet" not in found._fields:
            told = f"fleet is {show(fleet)}, but must be None"
            raise ValueError(f"{told}: this {type(found).__name__} states its vehicles itself")
        found = cast(Any, found)._replace(fleet=fleet_of(fleet))
        check_scenario(found)
    if site is not None:
        found = put_on_site(found, read_site(site))
        check_scenario(found)
    if num_havs is None:
        return found
    check_value("num_havs", Havs, num_havs)
    if num_havs == found.num_havs:
        return found
    if isinstance(found, Explicit):
        raise ValueError(
            f"num_havs is {num_havs}, but must be {found.num_havs}, the number of HAVs of the"
            " explicit scenario"
        )
    changed = cast(Any, found)._replace(num_havs=int(num_havs))
    check_scenario(changed)
    return changed
