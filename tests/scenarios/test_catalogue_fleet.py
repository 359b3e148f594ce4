"""Fleets of the catalogue have its vehicles, with frequencies by the weights."""

import numpy as np
import pytest

from hav_env import Batch, OffAxle, RandomPoses, Rectangles, catalogue, catalogue_fleet
from hav_env.models.checks import check_fields
from hav_env.scenarios import CatalogueFleet
from hav_env.vehicles import COMBINATIONS
from hav_env.vehicles.steady_circles import least_radius
from hav_env.world.arrays import ARTICULATION, FOOTPRINT, SPEED, STABLE, STEERING
from tests.support.budgets import budget

NAMES = COMBINATIONS.names()
COUNT = budget(1_500, 60)  # worlds


@pytest.fixture(scope="module")
def worlds():
    fleet = catalogue_fleet(NAMES)
    batch = Batch(RandomPoses(num_havs=2, fleet=fleet), COUNT, vehicle=OffAxle(bodies=Rectangles()))
    batch.reset(5)
    return batch.worlds


def kind_of(fleet, agent, w):
    """Return the only vehicle of the catalogue that has all numbers of a HAV."""
    last = fleet.num_trailers[agent, w]
    own = slice(0, last + 1)
    found = [
        name
        for name in NAMES
        if (vehicle := catalogue(name)).lengths == tuple(fleet.length[agent, own, w])
        and (*vehicle.offsets[1:], 0.0) == tuple(fleet.joints.offset[agent, own, w])
        and vehicle.limits == tuple(fleet.joints.limit[agent, own, w])
        and np.array_equal(np.stack(vehicle.bodies, -1), fleet.bodies.shape[agent, own, :, w])
        and fleet.limit[agent, SPEED, w] == vehicle.speed_max
        and fleet.limit[agent, STEERING, w] == vehicle.steering_max
    ]
    (name,) = found
    return name


def test_every_hav_is_a_vehicle_of_the_catalogue_and_all_are_as_frequent(worlds):
    drawn = [kind_of(worlds.fleet, agent, w) for w in range(COUNT) for agent in (0, 1)]
    names, counts = np.unique(drawn, return_counts=True)
    assert set(names) == set(NAMES)
    expected = len(drawn) / len(NAMES)
    chi2 = ((counts - expected) ** 2 / expected).sum()
    assert chi2 < 36.1  # 1 in 1,000 for 14 degrees of freedom


def test_what_follows_from_their_numbers_is_that_of_the_closed_forms(worlds):
    fleet = worlds.fleet
    for w in range(min(COUNT, 60)):
        vehicle = catalogue(kind_of(fleet, 0, w))
        rear = least_radius(vehicle.lengths, vehicle.offsets, vehicle.limits)
        front = np.hypot(vehicle.lengths[0], rear)
        assert fleet.radius[0, STABLE, w] == pytest.approx(front, rel=1e-12)
        lengths, offsets = vehicle.lengths[1:], (*vehicle.offsets[2:], 0.0)
        spans = np.abs(np.add(lengths, offsets))
        footprint = abs(vehicle.offsets[1]) + spans.sum()
        assert fleet.radius[0, FOOTPRINT, w] == pytest.approx(footprint, rel=1e-12)
        assert fleet.limit[0, ARTICULATION, w] == min(vehicle.limits[1:])


def test_weights_say_how_often_a_vehicle_is_drawn():
    fleet = catalogue_fleet(["wb-67", "tugger-train", "farm-train"], [6, 3, 1])
    batch = Batch(RandomPoses(fleet=fleet), COUNT, vehicle=OffAxle(bodies=Rectangles()))
    batch.reset(6)
    trailers = [len(catalogue(name).units) - 1 for name in ("wb-67", "tugger-train")]
    assert trailers == [1, 4]
    share = (batch.worlds.fleet.num_trailers[0] == 1).mean()
    assert abs(share - 0.6) < 4 * np.sqrt(0.24 / COUNT)
    farm = (batch.worlds.fleet.length[0, 0] == catalogue("farm-train").lengths[0]).mean()
    assert abs(farm - 0.1) < 4 * np.sqrt(0.09 / COUNT)


def test_one_vehicle_and_one_speed_for_all():
    fleet = catalogue_fleet(catalogue("b-double"), speed_max=1.0)
    assert fleet.speed.tolist() == [1.0]
    assert (fleet.speed_max, fleet.max_trailers) == (1.0, 2)
    check_fields("fleet", fleet)


@pytest.mark.parametrize(
    ("vehicles", "weights", "error", "message"),
    [
        ([], None, ValueError, "vehicles is empty"),
        ("wb-68", None, ValueError, "unknown combination 'wb-68'"),
        ([5], None, TypeError, "5"),
        (["wb-67"], [1, 2], ValueError, "weights has 2 numbers, but must have 1"),
        (["wb-67", "a-triple"], [1, 0], ValueError, "weights holds 0"),
        (["wb-67", "a-triple"], [1, np.nan], ValueError, "weights holds nan"),
        (["wb-67", "a-triple"], [1, "2"], ValueError, "weights holds '2'"),
    ],
)
def test_mistakes_are_named(vehicles, weights, error, message):
    with pytest.raises(error, match=message):
        catalogue_fleet(vehicles, weights)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("offset", np.full((1, 2), 99.0)),
        ("offset", np.zeros((1, 3))),
        ("limit", np.full((1, 2), 4.0)),
        ("speed", np.array([-1.0])),
        ("num_trailers", np.array([2])),
        ("length", np.array([[3.0, -1.0]])),
    ],
)
def test_a_fleet_that_was_not_built_so_is_checked(field, value):
    fleet = catalogue_fleet("wb-67")._replace(**{field: value})
    assert isinstance(fleet, CatalogueFleet)
    with pytest.raises(ValueError, match=field):
        Batch(RandomPoses(fleet=fleet), vehicle=OffAxle())
