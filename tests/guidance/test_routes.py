"""Routes lead to the goal, keep clear, and shrink by the driven distance."""

import math
import re

import numpy as np
import pytest
import shapely

from hav_env import Batch, find_scenario
from hav_env.guidance import Dubins, Lattice, Witness
from hav_env.maths.dubins import path_length
from hav_env.observation import SCRATCH_ROWS, Scratch, plan_route
from hav_env.observation.route import PATH_COLUMNS, observe_route
from hav_env.observation.scratch import LENGTH, TO_APPROACH, TO_GOAL, TURN, WHEELBASE
from hav_env.scenarios.sites.field import Field
from hav_env.vehicles import OffAxle, Rectangles
from hav_env.world.arrays import DUBINS, STEERING
from hav_env.world.place.guidance import (
    FROM_HEADING,
    FROM_X,
    FROM_Y,
    LEFT,
    NO_TABLE,
    ROUTE_CURVATURE,
    ROUTE_KNOWN,
    ROUTE_TURN,
    STAYS,
    OnLattices,
    OnRoads,
    OnWitnesses,
    follow_route,
)
from hav_env.world.sensing import drivable_radius, route_ahead
from hav_env.world.units.parts import arrays_in
from tests.guidance.sites import drive, trace, turned
from tests.guidance.yards import SITE, yard

LATTICE = Lattice(cell=2.0, headings=24, clearance=1.5, widening=1.2)
VEHICLE = OffAxle(bodies=Rectangles())
STRIDE = 0.5  # [m]
ROUNDED = 2.0 * 2.0 / 254.0  # [m], of poses of nodes, in two coordinates


def batch_of(scenario, guidance, num_worlds=2):
    batch = Batch(scenario, num_worlds, vehicle=VEHICLE, guidance=guidance, threads=1)
    batch.reset(0)
    return batch


def put(batch, w, pose):
    state = batch.worlds.state
    state.x[0, w], state.y[0, w], state.heading[0, 0, w] = pose


def goal_of(batch, w):
    return batch.worlds.goals[0, 0, :, w]


def drive_route(batch, w, most):
    """Drive exactly along a route; return the length, the least gap and the last pose."""
    worlds, route = batch.worlds, batch.worlds.guidance.route[0, :, w]
    lines = shapely.multilinestrings(list(SITE.segment.reshape(-1, 2, 2)))
    pose = tuple(map(float, route[[FROM_X, FROM_Y, FROM_HEADING]]))
    put(batch, w, pose)
    follow_route(worlds.guidance, worlds, 0)
    driven, gap = 0.0, math.inf
    radius = drivable_radius(worlds, 0, w) * LATTICE.widening
    while route[LEFT] > 0.01:
        assert driven <= most
        side, length = route[ROUTE_TURN], min(route[STAYS], STRIDE)
        before = route[LEFT]
        assert route[ROUTE_CURVATURE] == pytest.approx(side / radius, abs=0.02)
        gap = min(gap, lines.distance(trace(pose, side, radius, length)))
        pose = tuple(map(float, drive(pose, side, radius, length)))
        driven += length
        put(batch, w, pose)
        follow_route(worlds.guidance, worlds, 0)
        assert route[ROUTE_KNOWN] == 1.0
        assert before - route[LEFT] == pytest.approx(length, abs=ROUNDED)
    return driven, gap, pose


@pytest.mark.exhaustive
def test_a_route_on_a_lattice_leads_to_the_goal_clear_of_walls_and_is_as_long_as_told():
    batch = batch_of(yard(), LATTICE, 4)
    for w in range(4):
        left = batch.worlds.guidance.route[0, LEFT, w]
        assert left > 60.0  # round the wall; the straight line is shorter
        driven, gap, pose = drive_route(batch, w, 1.2 * left)
        assert driven == pytest.approx(left, abs=2.0 * LATTICE.cell)  # the start is off the node
        assert gap > LATTICE.clearance - 0.05
        x, y, heading = goal_of(batch, w)
        assert math.hypot(pose[0] - x, pose[1] - y) < 0.1
        assert turned(pose[2], heading) < 0.02


@pytest.mark.exhaustive
def test_the_record_of_a_goal_holds_the_dubins_length_with_and_without_a_route():
    batch, unguided = batch_of(yard(), LATTICE), batch_of(yard(), Dubins())
    recorded = batch.worlds.record.goal[0, 0, DUBINS]
    np.testing.assert_array_equal(recorded, unguided.worlds.record.goal[0, 0, DUBINS])
    assert (recorded < batch.worlds.guidance.route[0, LEFT]).all()  # that leads round the wall


@pytest.mark.exhaustive
def test_columns_and_progress_read_the_route():
    batch = batch_of(yard(), LATTICE)
    worlds, scratch = batch.worlds, Scratch(np.zeros((SCRATCH_ROWS, 2), np.float32), np.zeros(0))
    remaining = np.zeros((1, 2))
    plan_route(worlds, 0, scratch, remaining)
    for w in range(2):
        known, side, _, _, left = route_ahead(worlds, 0, w)
        assert known
        assert remaining[0, w] == pytest.approx(left, rel=1e-6)
        assert scratch.rows[TO_GOAL + TURN, w] == scratch.rows[TO_APPROACH + TURN, w] == side
        before = scratch.rows[TO_GOAL + LENGTH, w] - scratch.rows[TO_APPROACH + LENGTH, w]
        assert before == pytest.approx(scratch.rows[WHEELBASE, w], rel=1e-4)


def path_columns(worlds):
    """Return the columns of both paths (2, 4, 2), of HAV 0 in two worlds."""
    scratch = Scratch(np.zeros((SCRATCH_ROWS, 2), np.float32), np.zeros(0))
    columns = np.zeros((2 * len(PATH_COLUMNS), 2), np.float32)
    plan_route(worlds, 0, scratch, np.zeros((1, 2)))
    observe_route(worlds, scratch, columns, 0)
    return columns.reshape(2, len(PATH_COLUMNS), 2)


@pytest.mark.parametrize("curvature", [0.05, -0.05, 0.0, -9.0])  # [1/m]
@pytest.mark.parametrize("on", [OnLattices, OnRoads, OnWitnesses])
def test_the_steering_keeps_to_a_known_route_and_else_to_the_dubins_path(on, curvature):
    worlds = batch_of(yard(), Dubins()).worlds
    guidance = on(*(np.zeros(0) for _ in on._fields))._replace(route=np.zeros((1, 13, 2)))
    guidance.route[0, ROUTE_CURVATURE] = curvature
    guidance.route[0, ROUTE_KNOWN, 0] = 1.0
    seen, alone = path_columns(worlds._replace(guidance=guidance)), path_columns(worlds)
    wheelbase, steering_max = worlds.fleet.length[0, 0, 0], worlds.fleet.limit[0, STEERING, 0]
    expected = np.clip(math.atan(wheelbase * curvature) / steering_max, -1.0, 1.0)
    np.testing.assert_allclose(seen[:, -1, 0], expected, atol=1e-5)
    np.testing.assert_array_equal(seen[:, :, 1], alone[:, :, 1])


@pytest.mark.exhaustive
def test_where_no_lattice_leads_there_is_no_route():
    batch = batch_of(yard(), LATTICE)
    batch.worlds.guidance.table[:] = NO_TABLE
    batch.worlds.guidance.route[:] = 0.0
    follow_route(batch.worlds.guidance, batch.worlds, 0)
    assert not route_ahead(batch.worlds, 0, 0)[0]


@pytest.mark.exhaustive
def test_a_truck_that_leaves_its_route_gets_another_one_from_where_it_stands():
    batch = batch_of(yard(), LATTICE)
    worlds = batch.worlds
    put(batch, 0, (20.0, 40.0, math.pi / 2))
    follow_route(worlds.guidance, worlds, 0)
    route = worlds.guidance.route[0, :, 0]
    assert route[ROUTE_KNOWN] == 1.0
    assert math.hypot(route[FROM_X] - 20.0, route[FROM_Y] - 40.0) < 3.0 * LATTICE.cell


@pytest.mark.exhaustive
def test_beside_its_route_a_truck_is_steered_back_to_it():
    batch = batch_of(yard(), LATTICE)
    worlds, route = batch.worlds, batch.worlds.guidance.route[0, :, 0]
    x, y, heading = route[[FROM_X, FROM_Y, FROM_HEADING]]
    on_route = []
    for aside in (-0.5, 0.0, 0.5):  # [m] to the left
        put(batch, 0, (x - aside * math.sin(heading), y + aside * math.cos(heading), heading))
        follow_route(worlds.guidance, worlds, 0)
        on_route.append(route[ROUTE_CURVATURE])
    assert on_route[0] > on_route[1] > on_route[2]


@pytest.mark.exhaustive
def test_witnesses_are_the_dubins_paths_from_goal_to_goal_of_a_field():
    scenario = Field(num_segments=4, side=60.0)
    batch = batch_of(scenario, Witness())
    worlds = batch.worlds
    for w in range(2):
        x, y = worlds.state.x[0, w], worlds.state.y[0, w]
        heading = worlds.state.heading[0, 0, w]
        gx, gy, goal_heading = goal_of(batch, w)
        away = (gx - x + 1j * (gy - y)) * np.exp(-1j * heading)
        radius = scenario.widening * drivable_radius(worlds, 0, w)
        expected = path_length(away.real, away.imag, goal_heading - heading, radius)
        assert worlds.guidance.route[0, LEFT, w] == pytest.approx(expected, rel=1e-9)


def test_lattices_are_shared_and_worlds_pay_for_their_routes_alone():
    batch = Batch(yard(), 3, vehicle=VEHICLE, guidance=LATTICE)
    guidance = batch.worlds.guidance
    plain = Batch(yard(), 3, vehicle=VEHICLE)
    assert batch.bytes_per_world - plain.bytes_per_world == 8 * 13 + 2
    assert sum(part.nbytes for part in arrays_in(guidance.lattices)) > 8 * 40 * 40 * 24
    view = batch.world(1)
    assert view.guidance.lattices is guidance.lattices
    assert view.guidance.route.shape == (1, 13)


def test_by_default_there_is_no_guidance():
    batch = Batch(find_scenario("paper-pair"), 2)
    assert batch.guidance == batch.worlds.guidance == Dubins()


@pytest.mark.parametrize(
    ("scenario", "guidance", "error", "told"),
    [
        ("paper-pair", "lattice", ValueError, "scenario is a RandomPoses, but Lattice needs"),
        ("field-1", "lattice", ValueError, "scenario is a Field, but Lattice needs a scenario"),
        ("docks-6", "witness", ValueError, "scenario is a SitePoses, but Witness needs a field"),
        ("docks-6", 3, TypeError, "guidance is 3, but must be one of dubins, witness, lattice"),
        ("docks-6", "paths", ValueError, "unknown guidance 'paths'"),
        ("docks-6", Lattice(headings=4), ValueError, "guidance headings is 4, but must be"),
        ("docks-6", Lattice(cell=9.0), ValueError, "lattice cell is 9.0, but must be at most 1.4"),
    ],
)
def test_what_cannot_guide_is_refused_in_one_line(scenario, guidance, error, told):
    with pytest.raises(error, match=re.escape(told)) as caught:
        Batch(find_scenario(scenario), 2, vehicle=VEHICLE, guidance=guidance)
    assert "\n" not in str(caught.value)


def test_lattices_that_do_not_fit_into_memory_are_refused(monkeypatch):
    monkeypatch.setattr("hav_env.models.memory.available_memory", lambda: 2**21)
    with pytest.raises(ValueError, match=r"number of .*lattice.* is .*, which takes"):
        Batch(yard(), 1, vehicle=VEHICLE, guidance=LATTICE._replace(cell=0.5))
