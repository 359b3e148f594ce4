"""Road networks join poses by drives that keep clear, and know all shortest paths."""

import math

import numpy as np
import pytest
import shapely
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from baselines.sites.chain_motion import advance, chain_of, corner_points
from hav_env import Batch
from hav_env.guidance import Roads
from hav_env.guidance.roads.edges import (
    RoadPose,
    chain_to_sweep,
    find_edge,
    steady_bends,
    tightest_curvature,
)
from hav_env.guidance.roads.model import NO_EDGE, RoadVehicle
from hav_env.guidance.roads.networks import join_all
from hav_env.models.checks import check_fields
from hav_env.places import build_site
from hav_env.scenarios import catalogue_fleet, site_poses
from hav_env.simulator.guiding import guide
from hav_env.vehicles import VEHICLES, catalogue
from hav_env.vehicles.steady_circles import least_radius
from hav_env.world.place.guidance import (
    LEFT,
    REST,
    ROAD_NETWORK,
    ROUTE_KNOWN,
    OnRoads,
    allocate_guidance,
    begin_route,
    follow_route,
)
from tests.guidance.sites import lines_of

STRIDE = 0.05  # [m]
NAME = "terminal-tractor"
PLACES = {
    "west": [(25.0, 30.0, 0.0), (25.0, 60.0, 0.0)],
    "east": [(190.0, 25.0, 0.0), (190.0, 70.0, 0.0)],
}
SITE = build_site(
    [(0.0, 0.0), (230.0, 0.0), (230.0, 100.0), (0.0, 100.0)],
    lines=[[(100.0, 0.0), (100.0, 47.5)], [(100.0, 52.5), (100.0, 100.0)]],
)
ROAD = ((85.0, 50.0, 0.0, 0.0), (125.0, 50.0, 0.0, 0.0))  # before the gap in the wall, behind it


def two_yards(road=ROAD):
    """Return a scenario whose HAV drives through a gap of 5 m in the wall between two yards."""
    ways = {"west": ["east"], "east": ["west"]}
    return site_poses(SITE, catalogue_fleet(NAME), PLACES, ways, ["west"], 1, 1, road)


def vehicle_of(name):
    vehicle = catalogue(name)
    offsets = np.array([*vehicle.offsets[1:], 0.0])
    shape = np.stack(vehicle.bodies, axis=-1)
    radius = least_radius(vehicle.lengths, vehicle.offsets, vehicle.limits)
    wheels = vehicle.lengths[0] / math.tan(vehicle.steering_max)
    return RoadVehicle(
        np.array(vehicle.lengths), offsets, np.array(vehicle.limits), shape, max(radius, wheels)
    )


def drive_edge(name, pose, segments):
    """Drive an edge with another integrator; return least gap, last state and joint angles."""
    chain, walls = chain_of(catalogue(name)), lines_of(SITE.segment)
    units = len(chain.lengths)
    state, gap = np.array([[pose[0], pose[1], *[pose[2]] * units]]), math.inf
    for curvature, length in segments:
        count = max(1, math.ceil(length / STRIDE))
        for _ in range(count):
            bodies = shapely.polygons(corner_points(chain, state)[0])
            gap = min(gap, shapely.distance(walls, bodies).min())
            state = advance(chain, state, np.array([curvature]), np.array([[length / count]]))
    return gap, state[0, :3], np.abs(np.diff(state[0, 2:]))


@pytest.fixture(scope="module")
def network():
    vehicle = VEHICLES.make("rectangular")
    return guide(Roads(clearance=0.5), two_yards(), vehicle, None).roads


def test_all_pairs_are_those_of_dijkstra_and_edges_lead_there():
    rng = np.random.default_rng(5)
    count = 24
    lengths = np.where(rng.random((count, count)) < 0.2, rng.uniform(1, 9, (count, count)), np.inf)
    np.fill_diagonal(lengths, np.inf)
    through = rng.random(count) < 0.6
    left, edge = lengths.copy(), np.full((count, count), NO_EDGE, np.int32)
    edge[np.isfinite(lengths)] = np.arange(np.isfinite(lengths).sum())
    end = np.argwhere(np.isfinite(lengths))[:, 1]
    join_all(left, edge, through)
    for start in range(count):
        passed = through.copy()
        passed[start] = True  # paths leave their start, and pass through no other place
        graph = np.where(passed[:, None] & np.isfinite(lengths), lengths, 0.0)
        np.testing.assert_allclose(left[start], dijkstra(csr_array(graph), indices=start))
        for goal in np.flatnonzero(np.isfinite(left[start]) & (np.arange(count) != start)):
            at, driven = start, 0.0
            while at != goal:
                after = end[edge[at, goal]]
                driven += lengths[at, after]
                at = after
            assert driven == pytest.approx(left[start, goal])


def test_edges_end_at_their_poses_and_keep_all_bodies_clear(network):
    assert np.isfinite(network.left[0, :2, 2:4]).all()
    direct = network.end[network.edge[0]] == np.arange(len(network.pose))
    found = np.argwhere(direct & (network.edge[0] != NO_EDGE))
    assert len(found) >= 5
    for one, other in found:
        edge = network.edge[0, one, other]
        segments = network.segment[edge, : network.parts[edge], :2]
        gap, pose, bends = drive_edge(NAME, network.pose[one], segments)
        assert gap > 0.5 - 1e-6
        assert np.abs(pose[:2] - network.pose[other, :2]).max() < 1e-6
        assert abs(math.remainder(pose[2] - network.pose[other, 2], math.tau)) < 1e-9
        assert (bends < 0.05 + 1e-4).all()
        assert network.left[0, one, other] == pytest.approx(segments[:, 1].sum())


def test_no_edge_leads_through_a_gap_that_is_too_narrow():
    vehicle = vehicle_of(NAME)
    width = 2.0 * vehicle.shape[:, 0].max()
    walls = np.array([[20.0, y, 60.0, y] for y in (0.5 * width + 0.4, -0.5 * width - 0.4)])
    chains = [chain_to_sweep(vehicle, len(walls))]
    poses = RoadPose(0.0, 0.0, 0.0, 0.0), RoadPose(80.0, 0.0, 0.0, 0.0)
    drive = find_edge(chains, walls, *poses, vehicle.radius, 0.34, 0.05)
    assert drive is not None
    assert drive.length == pytest.approx(80.0)
    wider = find_edge(chains, walls, *poses, vehicle.radius, 0.41, 0.05)
    assert wider is None or wider.length > 81.0


@pytest.mark.parametrize("name", ["eu-semi-trailer", "baggage-train"])
@pytest.mark.parametrize("curvature", [0.04, -0.07])
def test_a_chain_on_a_circle_settles_at_the_steady_articulations(name, curvature):
    vehicle, chain = vehicle_of(name), chain_of(catalogue(name))
    state = np.zeros((1, 2 + len(chain.lengths)))
    for _ in range(6_000):
        state = advance(chain, state, np.array([curvature]), np.array([[STRIDE]]))
    bends = np.diff(state[0, 2:], prepend=state[0, 2])
    np.testing.assert_allclose(
        steady_bends(chain_to_sweep(vehicle, 0), curvature), bends, atol=1e-4
    )


@pytest.mark.parametrize("name", [NAME, "eurocombi", "baggage-train"])
@pytest.mark.parametrize("limit", [math.inf, 0.6])
def test_the_tightest_circle_of_a_pose_leaves_a_reserve_to_the_wheels_and_all_joints(name, limit):
    vehicle = vehicle_of(name)
    vehicle = vehicle._replace(limit=np.minimum(vehicle.limit, limit))
    chain, most = chain_to_sweep(vehicle, 0), tightest_curvature(vehicle)

    def is_allowed(curvature):
        bends = np.abs(steady_bends(chain, curvature)[1:])
        return curvature * vehicle.radius <= 1.0 and (bends <= vehicle.limit[1:] - 0.05).all()

    assert is_allowed(most * (1.0 - 1e-9))
    assert not is_allowed(most * (1.0 + 1e-6))


@pytest.mark.parametrize("walls", [np.array([[20.0, -200.0, 20.0, 200.0]]), np.zeros((0, 4))])
@pytest.mark.parametrize("curvature", [0.5, -0.5])
def test_no_edge_joins_a_pose_that_is_too_tight_for_its_chain(walls, curvature):
    shape = np.array([[1.25, 1.0, 1.0], [1.25, 1.0, 1.0]])
    lengths, limits = np.array([4.0, 12.0]), np.full(2, 1.5)
    chains = [chain_to_sweep(RoadVehicle(lengths, np.zeros(2), limits, shape, 12.0), len(walls))]
    bent, straight = RoadPose(0.0, 0.0, 0.0, curvature), RoadPose(60.0, 0.0, 0.0, 0.0)
    assert find_edge(chains, walls, bent, straight, 12.7, 0.25, 0.05) is None
    assert find_edge(chains, walls, straight, bent, 12.7, 0.25, 0.05) is None


def test_no_edge_between_equal_poses_is_empty():
    vehicle = vehicle_of(NAME)
    chains = [chain_to_sweep(vehicle, 0)]
    poses = RoadPose(0.0, 0.0, 0.0, 0.0), RoadPose(0.0, 0.0, math.tau, 0.0)
    drive = find_edge(chains, np.zeros((0, 4)), *poses, vehicle.radius, 0.25, 0.2)
    assert drive is None or drive.length > math.tau * vehicle.radius


def test_road_poses_that_no_network_can_have_are_refused_by_name():
    tight = two_yards((*ROAD, (60.0, 50.0, 0.0, -0.5)))
    told = r"road pose \[60, 50, 0\] has curvature -0.5 1/m, but must have one from -0.11"
    with pytest.raises(ValueError, match=told):
        guide(Roads(), tight, VEHICLES.make("rectangular"), None)
    with pytest.raises(ValueError, match=r"road\[1\] is .*must be a pose \[x, y, heading, curv"):
        two_yards((ROAD[0], (85.0, 50.0, 0.0)))
    with pytest.raises(TypeError, match=r"road\[0\]\[3\] is 'left'"):
        two_yards(((85.0, 50.0, 0.0, "left"),))
    place = (190.0, 25.0, math.tau, 0.05)
    with pytest.raises(ValueError, match=r"road pose 2 at .* it has place 2"):
        check_fields("scenario", two_yards((*ROAD, place)))
    with pytest.raises(ValueError, match=r"road pose 2 at .* it has road pose 1"):
        check_fields("scenario", two_yards((*ROAD, ROAD[1])))
    check_fields("scenario", two_yards())


def put(worlds, w, pose):
    state = worlds.state
    state.x[0, w], state.y[0, w], state.heading[0, 0, w] = pose
    follow_route(worlds.guidance, worlds, 0)


def worlds_on(network):
    batch = Batch(two_yards(), 2, vehicle=VEHICLES.make("realistic"), threads=1)
    batch.reset(0)
    empty = OnRoads(network, np.zeros((0, 0, 0)), np.zeros((0, 0, 0)))
    return batch.worlds._replace(guidance=allocate_guidance(empty, (1, 2), np.zeros))


@pytest.mark.parametrize("own", [0, 1])
def test_of_networks_with_almost_equal_radii_a_hav_takes_its_own(network, own):
    radii = np.repeat(network.radius, 2)
    radii[1 - own] += 2e-6  # [m]
    left, edge = np.repeat(network.left, 2, axis=0), np.repeat(network.edge, 2, axis=0)
    worlds = worlds_on(network._replace(radius=radii, left=left, edge=edge))
    begin_route(worlds.guidance, worlds, 0, 0)
    assert worlds.guidance.under_way[0, ROAD_NETWORK, 0] == own


def test_a_route_shrinks_along_its_edges_and_begins_anew_beside_them(network):
    worlds = worlds_on(network)
    state, route = worlds.state, worlds.guidance.route[0]
    for w in range(2):
        begin_route(worlds.guidance, worlds, 0, w)
    pose = x, y, heading = state.x[0, 0], state.y[0, 0], state.heading[0, 0, 0]
    here = np.abs(network.pose[:, :2] - pose[:2]).sum(axis=1).argmin()
    goal = np.abs(network.pose[:, :2] - worlds.goals[0, 0, :2, 0]).sum(axis=1).argmin()
    before = route[LEFT, 0]
    assert before == pytest.approx(network.left[0, here, goal])
    while here != goal:
        edge = network.edge[0, here, goal]
        for curvature, length in network.segment[edge, : network.parts[edge], :2]:
            way = length / math.ceil(length)
            for _ in range(math.ceil(length)):
                middle = heading + 0.5 * way * curvature
                chord = way * np.sinc(0.5 * way * curvature / math.pi)
                x, y = x + chord * math.cos(middle), y + chord * math.sin(middle)
                heading += way * curvature
                put(worlds, 0, (x, y, heading))
                assert route[ROUTE_KNOWN, 0] == 1.0
                assert before - route[LEFT, 0] == pytest.approx(way, abs=1e-6)
                before = route[LEFT, 0]
        here = network.end[edge]
    assert before == pytest.approx(0.0, abs=1e-6)
    put(worlds, 1, (45.0, 45.0, 0.5))  # at no pose
    assert route[ROUTE_KNOWN, 1] == 1.0
    assert route[LEFT, 1] > route[REST, 1] > 0.0
