"""This module reads vehicles that are written down in JSON (``vehicle.schema.json`` has the form).

A unit's ``hitch`` there is where the next unit is hitched behind it, as one measures a vehicle.
Numbers that a file leaves out are assumed: bodies of no width that end at the axle, or at the hitch
behind it, and the limits of a loaded truck.
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
    """Return a vehicle that is written down.

    Args:
        name: of the vehicle.
        written: what JSON has made of it.
        source: where it stands, for the origins of its numbers.

    Raises:
        ValueError: naming the entry, its value and what is allowed.
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
    """Return how far a body reaches behind its axle that a file does not state: to its hitch."""
    return assumed(max(0.0, float(unit.get("hitch", 0.0))), "left out in the file: to the hitch")


def load_combination(path: str | os.PathLike[str]) -> Combination:
    """Read a vehicle from a JSON file; its name is that of the file without the suffix.

    Raises:
        ValueError: when the file has no such vehicle, naming file and entry.
        OSError: when it cannot be read.
    """
    file = pathlib.PurePath(path)
    return read_json(
        path, "vehicle", _MOST_BYTES, lambda data: read_combination(file.stem, data, file.name)
    )
