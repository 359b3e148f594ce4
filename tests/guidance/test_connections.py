"""Drives through road poses lead to their goals, and keep the bodies of the whole chain clear."""

import math

import numpy as np
import pytest
import shapely

from baselines.sites.chain_motion import advance, chain_of, corner_points
from baselines.sites.follow import covering_episodes, places_in
from hav_env import Batch, Task, sensing
from hav_env.guidance import Roads
from hav_env.guidance.roads.connections import (
    Survey,
    dubins_lengths,
    find_connections,
    keeps_clear,
)
from hav_env.guidance.roads.detours import detours
from hav_env.guidance.roads.edges import Drive, RoadPose, chain_to_sweep
from hav_env.scenarios.presets import SITES
from hav_env.scenarios.sites import SITE_VEHICLES
from hav_env.simulator.guiding import road_poses_of
from hav_env.vehicles import VEHICLES, catalogue
from hav_env.world.arrays import JACKKNIFE, NEVER, OBSTACLE, PHASE, WHEN
from tests.guidance.sites import drive, lines_of
from tests.guidance.test_roads import STRIDE, vehicle_of
from tests.support.budgets import COMPILED
from tests.support.obstacles import corners_of, hulls_over_time

CLEARANCE, BEND = 0.25, 0.05
GATE, LONG = SITES["gate-2"], "eurocombi"
SPEED, STEPS = 1.5, 4_000  # [m/s]


def survey_of(scenario, name):
    poses, joins = road_poses_of(scenario)
    vehicle, walls = vehicle_of(name), scenario.site.segment
    chains = [chain_to_sweep(vehicle, len(walls))]
    nodes = [RoadPose(*map(float, pose)) for pose in poses]
    return Survey(chains, walls, nodes, joins, 1.06 * vehicle.radius, CLEARANCE, BEND)


def drive_whole(name, pose, segments, walls):
    """Drive a chain, straight at first, with another integrator.

    Returns the least gap of its bodies [m], the last pose and the articulations there [rad].
    """
    chain = chain_of(catalogue(name))
    units, states = len(chain.lengths), []
    state = np.array([[pose[0], pose[1], *[pose[2]] * units]])
    for curvature, length in segments:
        count = max(1, math.ceil(length / STRIDE))
        for _ in range(count):
            states.append(state[0])
            state = advance(chain, state, np.array([curvature]), np.array([[length / count]]))
    bodies = shapely.polygons(corner_points(chain, np.array([*states, state[0]])))
    gap = shapely.distance(bodies, lines_of(walls)).min()
    return gap, state[0, :3], np.diff(state[0, 2:])


def test_detours_lead_from_pose_to_pose_the_shortest_first():
    chains = [chain_to_sweep(vehicle_of("baggage-train"), 0)]
    one, other = RoadPose(1.0, 2.0, 0.5, 0.0), RoadPose(30.0, -8.0, -2.5, 0.0)
    table, lengths = detours(chains, one, other, 5.0)
    assert len(table) > 300
    assert (np.diff(lengths) >= 0.0).all()
    np.testing.assert_allclose(table[:, :, 1].sum(axis=1), lengths, atol=1e-5)
    for row in table[:: max(1, len(table) // 100)]:
        pose = one[:3]
        for curvature, length in row:
            side = float(np.sign(curvature))
            pose = drive(pose, side, 1.0 / abs(curvature) if side else 1.0, length)
        assert np.abs(np.subtract(pose[:2], other[:2])).max() < 1e-4
        assert abs(math.remainder(pose[2] - other.heading, math.tau)) < 1e-5


@pytest.fixture(scope="module")
def gate():
    """Return the survey of a gate, and what it finds for a vehicle that no edges lead through."""
    survey = survey_of(GATE, LONG)
    apart = dubins_lengths(survey.nodes, survey.radius)
    return survey, find_connections(survey, apart, 0, [2])


def test_a_connection_keeps_all_bodies_clear_and_ends_straight_at_its_goal(gate):
    survey, found = gate
    segments = found[2].drive.segments
    gap, pose, bends = drive_whole(LONG, GATE.place[0], segments, survey.walls)
    assert gap > CLEARANCE - 1e-3
    assert np.abs(pose[:2] - GATE.place[2, :2]).max() < 1e-4
    assert abs(math.remainder(pose[2] - GATE.place[2, 2], math.tau)) < 1e-5
    assert np.abs(bends).max() < BEND + 1e-3
    assert found[2].drive.length == pytest.approx(sum(length for _, length in segments), abs=1e-4)


def test_a_connection_passes_its_road_poses(gate):
    survey, found = gate
    assert found[2].passed
    for pose, before in found[2].passed:
        here = GATE.place[0]
        for curvature, length in found[2].drive.segments[:before]:
            side = float(np.sign(curvature))
            here = drive(here, side, 1.0 / abs(curvature) if side else 1.0, length)
        assert np.abs(np.subtract(here[:2], survey.nodes[pose][:2])).max() < 1e-4


def test_a_whole_drive_is_refused_if_it_touches_or_ends_bent(gate):
    survey, found = gate
    whole = found[2].drive
    assert keeps_clear(survey, 0, whole)
    wall = np.array([[8.0, 0.5, 9.0, 0.5]])  # behind the gate
    chains = [chain_to_sweep(vehicle_of(LONG), len(survey.walls) + 1)]
    blocked = survey._replace(walls=np.vstack([survey.walls, wall]), chains=chains)
    assert not keeps_clear(blocked, 0, whole)
    turn = Drive((*whole.segments, (0.1, 3.0)), whole.length + 3.0)
    assert not keeps_clear(survey, 0, turn)


def test_a_goal_behind_a_closed_gate_has_no_connection(gate):
    survey, _ = gate
    shut = np.vstack([survey.walls, [[0.0, -3.0, 0.0, 3.0]]])
    chains = [chain_to_sweep(vehicle_of(LONG), len(shut))]
    blocked = survey._replace(walls=shut, chains=chains, joins=survey.joins & ~_roads(survey))
    apart = dubins_lengths(survey.nodes, survey.radius)
    assert find_connections(blocked, apart, 0, [2]) == {}


def _roads(survey):
    """Return which edges end at a road pose."""
    return np.broadcast_to(survey.joins[-1], survey.joins.shape)


@pytest.mark.skipif(not COMPILED, reason="hundreds of thousands of steps")
@pytest.mark.exhaustive
@pytest.mark.parametrize("name", SITES)
def test_real_vehicles_on_the_routes_hit_all_goals_and_no_wall(name):
    """Each vehicle drives each connection in the simulator; Shapely looks at the bodies."""
    scenario = SITES[name]._replace(num_havs=1)
    episodes, covered = covering_episodes(scenario, seed=1, most=3_000)
    assert len(covered) == scenario.follows.sum() * len(SITE_VEHICLES[name])
    model, task = VEHICLES.make("realistic"), Task(max_steps=STEPS)
    batch = Batch(scenario, len(episodes), task, model, guidance=Roads())
    batch.reset(1, episodes)
    worlds, state = batch.worlds, batch.worlds.state
    kinds, _ = places_in(scenario, batch)
    lanes, length = range(len(episodes)), worlds.fleet.length[0, 0]
    poses, headings = [], []
    for _ in range(STEPS):
        poses.append(np.stack([state.x[0], state.y[0]]))
        headings.append(state.heading[0].T.copy())
        routes = [sensing.route_ahead(worlds, 0, lane) for lane in lanes]
        assert all(known for known, *_ in routes)
        curvature = np.array([route[3] for route in routes])
        batch.step(np.full((1, len(episodes)), SPEED), np.arctan(length * curvature)[None])
        if batch.ended.all() and not (state.speed[0] > 0.0).any():
            break
    assert batch.ended.all()
    assert (state.waiting[0] & (state.goal[0, PHASE] == scenario.num_goals - 1)).all()
    first = worlds.record.first[0, :, WHEN]
    assert (first[JACKKNIFE] == NEVER).all()
    assert (first[OBSTACLE] == NEVER).all()
    tree = shapely.STRtree(shapely.linestrings(scenario.site.segment.reshape(-1, 2, 2)))
    place, heading = np.array(poses), np.array(headings)
    for kind, vehicle_name in enumerate(SITE_VEHICLES[name]):
        own = kinds == kind
        corners = corners_of(
            catalogue(vehicle_name), place[:, 0, own], place[:, 1, own], heading[:, own]
        )
        touching = tree.query(hulls_over_time(corners), predicate="intersects")
        assert touching.shape[1] == 0
