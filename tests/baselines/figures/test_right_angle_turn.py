"""Vehicles round a corner: axles roll where they head, and measures are distances."""

import math

import numpy as np
import pytest
import shapely

from baselines.figures.right_angle_turn import (
    USUAL_RADIUS,
    body_points,
    drive_turn,
    inside_of,
    off_tracking,
    swept_width,
    tail_swing,
    turn_radius,
)
from hav_env.vehicles import COMBINATIONS, catalogue, steady_circles
from tests.support.budgets import budget

CHOSEN = budget(("eu-semi-trailer", "wb-100t", "b-double", "baggage-train"), ("b-double",))


@pytest.fixture(scope="module", params=CHOSEN)
def turn(request):
    vehicle = catalogue(request.param)
    return drive_turn(vehicle, turn_radius(vehicle))


def way_of_front_axle(turn, beyond=200.0):
    """Return the path of the front axle as a polyline."""
    bearing = np.linspace(0.0, turn.angle, 2001)
    arc = turn.radius * np.stack([np.sin(bearing), 1.0 - np.cos(bearing)], axis=-1)
    onward = arc[-1] + beyond * np.array([math.cos(turn.angle), math.sin(turn.angle)])
    return shapely.LineString([(-beyond, 0.0), *arc, onward])


def test_axles_roll_where_they_head_and_hitches_hold(turn):
    """The central difference of an axle's place has no part across its heading."""
    moved = turn.axles[2:] - turn.axles[:-2]
    heading = turn.headings[1:-1]
    across = moved[..., 1] * np.cos(heading) - moved[..., 0] * np.sin(heading)
    smooth = np.abs(np.diff(heading, 2, axis=0)).max(initial=0.0, axis=(0, 1))
    assert np.abs(across).max() < 2e-4  # of steps of 10 cm; 0.05 m times a jump of curvature
    assert smooth < 1e-2
    units = turn.vehicle.units
    along = np.stack([np.cos(turn.headings), np.sin(turn.headings)], axis=-1)
    front = turn.axles[:, 0] + units[0].length * along[:, 0]
    way = way_of_front_axle(turn)
    assert shapely.distance(shapely.points(front), way).max() < 1e-4
    for place in range(1, len(units)):
        hitch = turn.axles[:, place - 1] - units[place].hitch * along[:, place - 1]
        drawn = turn.axles[:, place] + units[place].length * along[:, place]
        assert drawn == pytest.approx(hitch, abs=1e-9)


@pytest.mark.parametrize("name", CHOSEN)
def test_long_arcs_end_on_the_steady_circle(name):
    vehicle = catalogue(name)
    radius = 1.2 * turn_radius(vehicle)  # near the least radius the end takes long
    turn = drive_turn(vehicle, radius, 8.0 * math.pi)
    end = math.floor(8.0 * math.pi * radius / 0.05)
    found = np.hypot(turn.axles[end, :, 0], turn.axles[end, :, 1] - radius)
    truck = math.sqrt(radius**2 - vehicle.lengths[0] ** 2)
    steady = steady_circles.steady_radii(truck, vehicle.lengths, vehicle.offsets)
    assert found == pytest.approx(steady, abs=2e-3)


def test_distances_to_the_way_are_those_of_shapely(turn):
    way = way_of_front_axle(turn)
    points = body_points(turn, slice(None, None, 23)).reshape(-1, 2)
    found = inside_of(turn, points)
    assert np.abs(found) == pytest.approx(shapely.distance(shapely.points(points), way), abs=1e-4)
    left = shapely.Polygon([*way.coords, (-200.0, turn.radius + 200.0)])
    inside = shapely.contains_xy(left, *points.T)
    clear = np.abs(found) > 1e-3
    assert (found[clear] > 0.0).tolist() == inside[clear].tolist()
    assert off_tracking(turn) <= turn.radius
    assert swept_width(turn) > off_tracking(turn) + turn.vehicle.units[-1].half_width


def test_off_tracking_is_less_than_on_the_steady_circle_and_more_than_of_a_smaller_angle(turn):
    vehicle, radius = turn.vehicle, turn.radius
    truck = math.sqrt(radius**2 - vehicle.lengths[0] ** 2)
    steady = steady_circles.steady_radii(truck, vehicle.lengths, vehicle.offsets)
    assert 0.0 < off_tracking(turn) < radius - steady.min()
    less = drive_turn(vehicle, radius, math.pi / 4)
    assert off_tracking(less) < off_tracking(turn)


def test_a_long_overhang_swings_out():
    """To second order: a tail at a yaw of y swings out by rear * y, less half * y^2 / 2."""
    swings = {}
    for rear in (0.5, 3.9):
        vehicle = catalogue("eu-semi-trailer")
        last = vehicle.units[-1]._replace(rear=rear)
        longer = vehicle._replace(units=(*vehicle.units[:-1], last))
        swings[rear] = tail_swing(drive_turn(longer, USUAL_RADIUS))
    assert 0.0 <= swings[0.5] < swings[3.9] < 0.5
    straight = drive_turn(catalogue("eu-semi-trailer"), USUAL_RADIUS, 1e-9)
    assert tail_swing(straight) == pytest.approx(0.0, abs=1e-6)


def test_every_vehicle_takes_its_turn_within_its_limits():
    for name in budget(COMBINATIONS.names(), CHOSEN):
        vehicle = catalogue(name)
        turn = drive_turn(vehicle, turn_radius(vehicle), step=0.2)
        bends = np.abs(np.diff(turn.headings, axis=1)).max(axis=0)
        assert np.all(bends <= vehicle.limits[1:]), name
