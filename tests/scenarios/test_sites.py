"""Every connection of every site can be driven, by every vehicle, without touching anything.

A driver follows the drives that are stored in tests/scenarios/drives, one HAV alone in the
simulator. Shapely tests whether a body touches a segment, at steps and in between: it compares the
convex hulls of bodies over some steps.
"""

import functools

import numpy as np
import pytest
import shapely

from baselines.sites.drives import DRIVE_MARGIN, read_paths
from baselines.sites.follow import covering_episodes, follow
from hav_env import Batch
from hav_env.places import build_site, is_inside
from hav_env.scenarios.presets import SITES, find_scenario, scenario_of
from hav_env.scenarios.sites import SITE_VEHICLES
from hav_env.vehicles import VEHICLES as MODELS
from hav_env.vehicles import catalogue
from hav_env.world.arrays import JACKKNIFE, NEVER, OBSTACLE, WHEN
from tests.support.budgets import COMPILED
from tests.support.obstacles import corners_of, hulls_over_time
from tests.support.paths import ROOT

DRIVES = ROOT / "tests/scenarios/drives"
VEHICLE = MODELS.make("realistic")
sites = pytest.mark.parametrize("name", SITES)


@functools.cache
def alone(name):
    return SITES[name]._replace(num_havs=1)


@pytest.mark.skipif(not COMPILED, reason="hundreds of thousands of steps")
@pytest.mark.exhaustive
@sites
def test_every_vehicle_drives_every_connection_and_touches_nothing(name):
    scenario = alone(name)
    episodes, covered = covering_episodes(scenario, seed=1, most=3_000)
    wanted = {
        (kind, int(start), int(goal))
        for kind in range(len(SITE_VEHICLES[name]))
        for start, goal in np.argwhere(scenario.follows)
    }
    assert covered == wanted
    run = follow(scenario, SITE_VEHICLES[name], read_paths(name, DRIVES), 1, episodes)
    assert run.hit.all()
    assert run.off < DRIVE_MARGIN
    first = run.batch.worlds.record.first[0, :, WHEN]
    assert (first[JACKKNIFE] == NEVER).all()
    assert (first[OBSTACLE] == NEVER).all()
    tree = shapely.STRtree(shapely.linestrings(scenario.site.segment.reshape(-1, 2, 2)))
    for kind, vehicle_name in enumerate(SITE_VEHICLES[name]):
        own = run.kinds == kind
        vehicle = catalogue(vehicle_name)
        place = np.moveaxis(run.poses[:, own], -1, 0)
        corners = corners_of(vehicle, *place, run.headings[:, own])
        touching = tree.query(hulls_over_time(corners), predicate="intersects")
        assert touching.shape[1] == 0


@sites
def test_names_lead_to_sites(name):
    assert find_scenario(name) is SITES[name]
    assert scenario_of(name, 1) == alone(name)
    assert scenario_of(name).num_havs == int(name.rpartition("-")[2])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"num_havs": 7}, "num_havs is 7, but must be at most 6, the number of places"),
        ({"place": np.zeros((2, 2))}, r"place has shape \(2, 2\), but must have \(P, 3\)"),
        ({"first": np.ones(3, int)}, r"first has shape \(3,\), but must have \(14,\)"),
        ({"follows": np.zeros((14, 14), int)}, "no place after place 0, but every place must"),
        ({"first": np.full(14, 0.5)}, "first must hold 0 and 1 alone"),
    ],
)
def test_what_does_not_fit_together_is_an_error(changes, message):
    with pytest.raises(ValueError, match=message):
        scenario_of(SITES["docks-6"]._replace(**changes))


@sites
def test_vehicles_have_room_at_all_places_at_once(name):
    scenario = SITES[name]
    tree = shapely.STRtree(shapely.linestrings(scenario.site.segment.reshape(-1, 2, 2)))
    for vehicle_name in SITE_VEHICLES[name]:
        vehicle = catalogue(vehicle_name)
        x, y, heading = scenario.place.T
        headings = heading[:, None].repeat(len(vehicle.units), axis=1)
        corners = corners_of(vehicle, x, y, headings)
        bodies = shapely.unary_union(shapely.polygons(corners), axis=1)
        apart = shapely.intersects(bodies[:, None], bodies) == np.eye(len(bodies), dtype=bool)
        assert apart.all()
        assert tree.query(bodies, predicate="intersects").shape[1] == 0
        for corner in corners.reshape(-1, 2):
            assert is_inside(scenario.site, *corner)


def test_bodies_in_the_way_are_refused_at_every_place():
    """Beside the rear axle of a truck, a trailer or the vehicle at the next place may be."""
    docks = SITES["docks-6"]
    lane = int(np.flatnonzero(docks.first)[0])
    x, y, heading = docks.place[lane]
    behind = y + 12.0  # the trailers, for vehicles head to the south there
    wall = build_site(lines=[[(x - 1.0, behind), (x + 1.0, behind)]])
    narrow = docks._replace(site=wall)
    told = rf"scenario place {lane} is at .* but vehicle 0 of the fleet must not touch a line"
    with pytest.raises(ValueError, match=told):
        scenario_of(narrow)
    scenario_of(narrow._replace(site=build_site(lines=[[(x + 1.4, behind), (x + 2.0, behind)]])))
    place = docks.place.copy()
    place[lane + 1] = x + 2.4, y, heading
    with pytest.raises(ValueError, match=f"vehicle 0 at place {lane} and vehicle 0 at place"):
        scenario_of(docks._replace(place=place))
    place[lane + 1] = x + 2.6, y, heading
    scenario_of(docks._replace(place=place))


@sites
def test_draws_keep_to_the_tables(name):
    scenario = SITES[name]
    worlds = Batch(scenario, 300, vehicle=VEHICLE)
    worlds.reset(3)
    state, goals = worlds.worlds.state, worlds.worlds.goals
    start = np.stack([state.x, state.y, state.heading[:, 0]], axis=1)
    poses = np.concatenate([start[:, None], goals], axis=1)  # (N, 1 + G, 3, W)
    away = np.abs(poses[:, :, :, None] - scenario.place.T[:, :, None]).max(axis=2)
    assert (away.min(axis=2) < 1e-9).all()
    places = away.argmin(axis=2)  # (N, 1 + G, W)
    assert scenario.first[places[:, 0]].all()
    assert scenario.follows[places[:, :-1], places[:, 1:]].all()
    ordered = np.sort(places, axis=0)
    assert (np.diff(ordered, axis=0) > 0).all()
    possible = scenario.first == 1
    for phase in range(places.shape[1]):
        assert set(places[:, phase].ravel()) == set(np.flatnonzero(possible))
        possible = scenario.follows[possible].any(axis=0)
