"""This module reads vehicles in JSON (``vehicle.schema.json`` is their schema).

In JSON, a unit's ``hitch`` is the distance from its axle back to the hitch of the next unit, as one
measures a vehicle. Numbers that a file leaves out are assumed: bodies without width that end at the
axle, or at the hitch behind it, and the limits of a loaded truck.
"""

import functools
import importlib.resources
import json
import os
import pathlib
from typing import Any

from hav_env.models.json_files import read_json
from hav_env.models.json_schema import check_document
from hav_env.vehicles.combinations.combination import Combination
from hav_env.vehicles.combinations.limits import RIGHT_ANGLE, loaded_truck
from hav_env.vehicles.combinations.sources import Quantity, Trailer, Truck, assumed, cited, combine

_MOST_BYTES = 2**20  # of a file of one vehicle
_LEFT_OUT = assumed(0.0, "left out in the file")
_LIMITS = ("speed_max", "steering_max", "steering_rate", "acceleration", "braking", "lateral")


@functools.cache
def vehicle_schema() -> dict[str, Any]:
    """Return the JSON Schema of a vehicle."""
    package = importlib.resources.files("hav_env.vehicles.combinations")
    return json.loads((package / "vehicle.schema.json").read_text(encoding="utf-8"))


def read_combination(name: str, written: Any, source: str = "a JSON file") -> Combination:
    """Return a vehicle from JSON.

    Args:
        name: name of the vehicle.
        written: parsed JSON.
        source: source, for the origins of its numbers.

    Raises:
        ValueError: if an entry is wrong; the message names its value and the rule.
    """
    check_document(vehicle_schema(), written, name)
    cite = cited(source)

    def take(unit: dict[str, Any], entry: str, otherwise: Quantity = _LEFT_OUT) -> Quantity:
        return cite(float(unit[entry])) if entry in unit else otherwise

    def half_width(unit: dict[str, Any]) -> Quantity:
        return cite(unit["width"] / 2.0, "half of width") if "width" in unit else _LEFT_OUT

    truck = written["truck"]
    units = written["trailers"] * int(written.get("repeat", 1))
    trailers = tuple(
        Trailer(
            length=cite(float(unit["length"])),
            hitch=take(ahead, "hitch"),
            half_width=half_width(unit),
            front=take(unit, "front"),
            rear=take(unit, "rear", _to_hitch(unit)),
            articulation_max=take(unit, "bend_max", RIGHT_ANGLE),
        )
        for ahead, unit in zip([truck, *units], units, strict=False)
    )
    known = {entry: cite(float(truck[entry])) for entry in _LIMITS if entry in truck}
    return combine(
        name,
        written.get("title", name),
        Truck(
            length=cite(float(truck["wheelbase"])),
            half_width=half_width(truck),
            front=take(truck, "front"),
            rear=take(truck, "rear", _to_hitch(truck)),
        ),
        trailers,
        **loaded_truck(**known),
    )


def _to_hitch(unit: dict[str, Any]) -> Quantity:
    """Return the default reach of a body behind its axle: to its hitch."""
    return assumed(max(0.0, float(unit.get("hitch", 0.0))), "left out in the file: to the hitch")


def load_combination(path: str | os.PathLike[str]) -> Combination:
    """Read a vehicle from a JSON file; its name is that of the file without the suffix.

    Raises:
        ValueError: if the file has no such vehicle; the message names file and entry.
        OSError: if the system cannot read it.
    """
    file = pathlib.PurePath(path)
    return read_json(
        path, "vehicle", _MOST_BYTES, lambda data: read_combination(file.stem, data, file.name)
    )
