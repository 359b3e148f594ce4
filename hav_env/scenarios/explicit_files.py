"""This module reads a scenario from a JSON file; ``scenario.schema.json`` has its form."""

import functools
import importlib.resources
import json
import os
from typing import Any

from hav_env.models.annotations import show
from hav_env.models.json_files import read_json
from hav_env.models.json_schema import check_document
from hav_env.places.site import join_outlines
from hav_env.places.site_files import SITE_ENTRIES, read_outlines
from hav_env.scenarios.explicit import Explicit, explicit
from hav_env.vehicles.combinations import COMBINATIONS, catalogue, read_combination

_MOST_BYTES = 2**26  # a swarm of 10,000 HAVs with 100 goals each
_LIMIT_NAMES = ("speed_max", "steering_max", "articulation_max", "footprint_truck_share")


def load_explicit(path: str | os.PathLike[str]) -> Explicit:
    """Read a scenario from a JSON file, such as examples/two_havs.json and examples/depot.json.

    The file is in UTF-8, UTF-16 or UTF-32, with a byte order mark or without.

    Raises:
        ValueError: if the file is no such scenario; the message names file and entry. OSError: if
            the system cannot read it.
    """
    return read_json(path, "scenario", _MOST_BYTES, _from_json)


@functools.cache
def scenario_schema() -> dict[str, Any]:
    """Return the JSON Schema of an explicit scenario."""
    package = importlib.resources.files("hav_env.scenarios")
    return json.loads((package / "scenario.schema.json").read_text(encoding="utf-8"))


def _from_json(data: Any) -> Explicit:
    check_document(scenario_schema(), data, "scenario")
    vehicles = {
        name: read_combination(name, told) for name, told in data.get("vehicles", {}).items()
    }
    for agent, hav in enumerate(data["havs"]):
        name = hav.get("vehicle")
        if name in vehicles or name is None:
            continue
        # neither module:NAME nor another file, so that opening a file runs no code
        if name not in COMBINATIONS.names():
            known = ", ".join([*vehicles, *COMBINATIONS.names()])
            raise ValueError(f"HAV {agent} has the unknown vehicle {show(name)}; known: {known}")
        vehicles[name] = catalogue(name)
    columns: dict[str, Any] = {"lengths": [], "start": [], "goals": [], "bends": []}
    for agent, hav in enumerate(data["havs"]):
        if ("lengths" in hav) == ("vehicle" in hav):
            raise ValueError(f'HAV {agent} must have either "lengths" or "vehicle"')
        columns["lengths"].append(hav["lengths"] if "lengths" in hav else vehicles[hav["vehicle"]])
        columns["start"].append(hav["start"])
        columns["goals"].append(hav["goals"])
        columns["bends"].append(hav.get("bends", []))
    limits: dict[str, Any] = {name: data[name] for name in _LIMIT_NAMES if name in data}
    place = {name: data[name] for name in SITE_ENTRIES if name in data}
    site = join_outlines(read_outlines(place, "scenario"))
    return explicit(**limits, **columns, site=site)
