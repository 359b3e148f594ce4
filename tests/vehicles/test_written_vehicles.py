"""Vehicles in JSON files: their contents define the vehicle, and every mistake is named."""

import copy
import json
import math
import re
from typing import get_args

import pytest

from hav_env.models import quantities
from hav_env.vehicles import COMBINATIONS, catalogue
from hav_env.vehicles.combinations import read_combination
from hav_env.vehicles.combinations.written import vehicle_schema
from tests.support.paths import ROOT

TEXT = (ROOT / "docs/vehicles.md").read_text()
(BLOCK,) = re.findall(r"```json\n(.*?)```", TEXT, re.DOTALL)
TRAIN = json.loads(BLOCK)


def written_back(vehicle):
    """Return the contents of a JSON file of a vehicle of the catalogue."""
    units = [
        {
            "hitch": behind.hitch if behind else 0.0,
            "width": 2.0 * unit.half_width,
            "front": unit.front,
            "rear": unit.rear,
        }
        for unit, behind in zip(vehicle.units, [*vehicle.units[1:], None], strict=True)
    ]
    names = ("speed_max", "steering_max", "steering_rate", "acceleration", "braking", "lateral")
    truck = units[0] | {"wheelbase": vehicle.units[0].length}
    truck |= {name: getattr(vehicle, name) for name in names}
    trailers = [
        entries | {"length": unit.length, "bend_max": unit.articulation_max}
        for entries, unit in zip(units[1:], vehicle.units[1:], strict=True)
    ]
    return {"title": vehicle.title, "truck": truck, "trailers": trailers}


@pytest.mark.parametrize("name", COMBINATIONS.names())
def test_every_vehicle_of_the_catalogue_comes_back_from_a_file(name, tmp_path):
    vehicle = catalogue(name)
    path = tmp_path / f"{name}.json"
    path.write_text(json.dumps(written_back(vehicle)))
    found = catalogue(str(path))
    assert found._replace(origins=()) == vehicle._replace(origins=())
    assert not found.assumed
    assert {origin.source for origin in found.origins} == {path.name}


def test_the_example_of_the_page_is_a_train_of_eleven_units(tmp_path):
    (tmp_path / "baggage.json").write_text(BLOCK)
    train = catalogue(tmp_path / "baggage.json")
    assert (train.name, train.title, len(train.units)) == ("baggage", "Baggage train", 11)
    assert train.lengths == (1.75, *(5 * (1.1, 1.6)))
    assert train.offsets == (0.0, 0.75, 0.0, *(4 * (0.65, 0.0)))
    assert train.bodies[0] == (0.75, *(5 * (0.15, 0.75)))
    assert train.limits == (1.4,) * 11
    assert train.speed_max == 6.5
    assert "steering_max" in train.assumed
    assert "units[1].front" in train.assumed
    assert "units[2].front" not in train.assumed
    least = read_combination("x", {"truck": {"wheelbase": 4}, "trailers": [{"length": 6}]})
    assert least.limits[1] == pytest.approx(math.pi / 2)
    assert least.title == "x"


def changed(place, value):
    """Return the train with one entry changed; None removes it."""
    train = copy.deepcopy(TRAIN)
    *path, last = place
    part = train
    for step in path:
        part = part[step]
    if value is None:
        del part[last]
    else:
        part[last] = value
    return train


@pytest.mark.parametrize(
    ("place", "value", "message"),
    [
        (("truck", "wheelbase"), 0, "train.truck.wheelbase is 0, but must be at least 0.01"),
        (("truck", "wheelbase"), None, "train.truck has no entry 'wheelbase', but must have one"),
        (("truck", "wheelbase"), "long", "train.truck.wheelbase is 'long', but must be a number"),
        (("truck", "front"), True, "train.truck.front is True, but must be a number"),
        (("truck", "weight"), 3, "train.truck has the unknown entry 'weight'; known: wheelbase,"),
        (("truck", "braking"), 0.0, "train.truck.braking is 0.0, but must be above 0.0"),
        (("trailers",), [], "train.trailers has 0 entries, but must have at least 1"),
        (("trailers",), {}, "train.trailers is {}, but must be an array"),
        (("trailers", 1, "bend_max"), 4, r"train.trailers\[1\].bend_max is 4, but must be at most"),
        (("trailers", 0, "length"), None, r"train.trailers\[0\] has no entry 'length'"),
        (("repeat",), 1.5, "train.repeat is 1.5, but must be an integer"),
        (("trailers", 1, "hitch"), 1.2, "hitch offset of unit 3 is 1.2 m, but must be at most"),
        (("truck", "rear"), math.nan, "rear is nan, but must be"),
    ],
)
def test_every_mistake_is_named(place, value, message):
    with pytest.raises(ValueError, match=message):
        read_combination("train", changed(place, value))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("{", "is not a JSON file"),
        ("3", "is 3, but"),
        ('{"repeat": 1, "repeat": 2}', "the entry 'repeat' stands twice"),
    ],
)
def test_a_file_without_a_vehicle_is_named(content, message, tmp_path):
    path = tmp_path / "mine.json"
    path.write_text(content)
    with pytest.raises(ValueError, match=rf"mine.json.*{message}"):
        catalogue(path)
    with pytest.raises(ValueError, match="there is no combination file"):
        catalogue(tmp_path / "none.json")


def test_the_schema_has_the_ranges_of_the_models():
    definitions = vehicle_schema()["$defs"]
    truck, trailer = definitions["truck"]["properties"], definitions["trailer"]["properties"]
    for kind, entry in (
        (quantities.Length, definitions["length"]),
        (quantities.Offset, definitions["hitch"]),
        (quantities.Distance, definitions["distance"]),
        (quantities.Speed, truck["speed_max"]),
        (quantities.Steering, truck["steering_max"]),
        (quantities.Articulation, trailer["bend_max"]),
    ):
        allowed = get_args(kind)[1]
        assert (entry["minimum"], entry["maximum"]) == (allowed.low, allowed.high)
    assert definitions["rate"]["maximum"] == get_args(quantities.AboveZero)[1].high
