"""The catalogue: names, sources, and lengths that are published as a whole."""

import math
import sys

import pytest

from hav_env.models.checks import check_fields
from hav_env.vehicles import COMBINATIONS, Combination, catalogue, steady_circles
from hav_env.vehicles.combinations.sources import Trailer, Truck, assumed, cited, combine

NAMES = COMBINATIONS.names()
FOOT = 0.3048  # [m]
PUBLISHED = {  # overall lengths [m] of documents that do not state their parts
    "eu-semi-trailer": 16.50,  # Directive 96/53/EC
    "eu-truck-trailer": 18.75,
    "eurocombi": 25.25,
    "wb-67": 73.5 * FOOT,  # AASHTO 2018
    "wb-67d": 72.3 * FOOT,
    "wb-100t": 104.8 * FOOT,
    "wb-109d": 114.0 * FOOT,
    "b-double": 26.0,  # NHVR
}
LIMITS = ("speed_max", "steering_max", "steering_rate", "acceleration", "braking", "lateral")


@pytest.mark.parametrize("name", PUBLISHED)
def test_the_parts_add_up_to_the_published_length(name):
    assert catalogue(name).overall_length == pytest.approx(PUBLISHED[name], abs=0.06)


def test_a_road_train_keeps_to_its_limits_of_length():
    train = catalogue("a-triple")
    assert 50.0 < train.overall_length <= 53.5
    for trailer in (train.units[1], train.units[3], train.units[5]):
        assert trailer.length + trailer.rear <= 12.3 + 1e-9
    double = catalogue("b-double")
    first, second = double.units[1:]
    assert first.length + second.hitch + second.length + second.rear == pytest.approx(20.6)


@pytest.mark.parametrize("name", NAMES)
def test_each_number_has_one_origin_and_is_in_its_range(name):
    vehicle = catalogue(name)
    assert vehicle.name == name
    assert 2 <= len(vehicle.units) <= 11
    truck = ("length", "half_width", "front", "rear")
    expected = [f"units[0].{field}" for field in truck]
    for place in range(1, len(vehicle.units)):
        expected += [f"units[{place}].{field}" for field in vehicle.units[place]._fields]
    fields = [origin.field for origin in vehicle.origins]
    assert sorted(fields) == sorted([*expected, *LIMITS])
    assert all(origin.source or origin.note for origin in vehicle.origins)
    assert vehicle.assumed == {origin.field for origin in vehicle.origins if origin.assumed}
    check_fields("vehicle", vehicle)
    for unit in vehicle.units:
        check_fields("unit", unit)


@pytest.mark.parametrize("name", NAMES)
def test_every_vehicle_can_turn(name):
    vehicle = catalogue(name)
    wheels = vehicle.lengths[0] / math.tan(vehicle.steering_max)
    needed = steady_circles.least_radius(vehicle.lengths, vehicle.offsets, vehicle.limits)
    radius = max(wheels, needed) * (1.0 + 1e-9)
    bends = steady_circles.steady_articulations(radius, vehicle.lengths, vehicle.offsets)
    assert all(bends <= [limit + 1e-6 for limit in vehicle.limits[1:]])
    steady_circles.check_damped(vehicle.lengths, vehicle.offsets)


def test_bodies_follow_each_other_without_reaching_into_the_next_trailer():
    """Straight, no body is longer than to where the body after the next begins."""
    for name in NAMES:
        vehicle = catalogue(name)
        axle, spans = 0.0, []
        for place, unit in enumerate(vehicle.units):
            end = axle - unit.hitch if place else unit.length
            axle = end - unit.length
            assert vehicle.straight_ends[place] == pytest.approx((end, axle)), name
            spans.append((end + unit.front, axle - unit.rear))
        for ahead, behind in zip(spans, spans[2:], strict=False):
            assert ahead[1] >= behind[0] - 1e-9, name
        assert vehicle.overall_length == pytest.approx(spans[0][0] - spans[-1][1]), name


def test_the_sources_that_can_be_installed_say_so():
    """CommonRoad's vehicle 4, as the notes of its package state it: 5.1 and 16.5 m in all."""
    vehicle = catalogue("eu-semi-trailer")
    truck, trailer = vehicle.units
    assert truck.front + truck.length + truck.rear == pytest.approx(5.1)
    assert trailer.front + trailer.length + trailer.rear == pytest.approx(13.6)
    assert not vehicle.assumed & {f"units[0].{field}" for field in truck._fields}


def test_an_unknown_name_lists_all_names():
    message = r"unknown combination 'wb-68' \(did you mean 'wb-67'\?\); known: "
    with pytest.raises(ValueError, match=message) as caught:
        catalogue("wb-68")
    assert all(name in str(caught.value) for name in NAMES)
    with pytest.raises(TypeError, match="combination is 67, but must be a name"):
        catalogue(67)


def vehicle_of_two(hitch=0.0, length=5.0):
    drawn = cited("a drawing")
    half, end = drawn(1.0, "half of 2 m"), assumed(0.5, "usual")
    return combine(
        "mine",
        "My own",
        Truck(drawn(3.0), half, end, end),
        (Trailer(drawn(length), drawn(hitch), half, end, end, assumed(1.5, "usual")),),
        **{field: assumed(0.5, "usual") for field in LIMITS},
    )


def test_a_vehicle_of_your_own_goes_by_module_and_name(monkeypatch):
    own = type(sys)("own_vehicles")
    own.MINE = vehicle_of_two()
    monkeypatch.setitem(sys.modules, "own_vehicles", own)
    found = catalogue("own_vehicles:MINE")
    assert isinstance(found, Combination)
    assert found.origins[1] == ("units[0].half_width", "a drawing", "half of 2 m")
    assert found.origins[2] == ("units[0].front", "", "usual")
    assert "units[0].front" in found.assumed
    assert found.overall_length == pytest.approx(9.0)
    own.MINE = 3
    with pytest.raises(ValueError, match="is not a combination"):
        catalogue("own_vehicles:MINE")


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ({"hitch": 5.5}, "hitch offset of unit 1 is 5.5 m, but must be at most its length"),
        ({"length": 0.0}, r"mine units\[1\] length is 0.0, but must be"),
    ],
)
def test_a_number_out_of_range_is_refused_by_name(numbers, message):
    with pytest.raises(ValueError, match=message):
        vehicle_of_two(**numbers)
