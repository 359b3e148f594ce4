"""No point of a HAV moves farther in a step than its bound, and gaps are those of Shapely."""

import numpy as np
import pytest
import shapely

from hav_env import Batch, OffAxle, OnAxle, RandomFleet, RandomPoses, Rectangles, catalogue_fleet
from hav_env.compiled import entry
from hav_env.safety.displacement import bound_moves, most_displacement
from hav_env.safety.gaps import boxes_apart, gap_of_bodies
from hav_env.safety.trial_moves import LONGEST_MOVE, count_rows
from hav_env.world.lanes import block_of
from tests.support.budgets import budget
from tests.support.obstacles import body_shapes

VEHICLE_MODELS = [
    OnAxle(),
    pytest.param(OffAxle(bodies=Rectangles()), marks=pytest.mark.exhaustive),
]


@entry
def _bound_all(first, last, worlds, dt, bounds):
    for w in range(first, last):
        bounds[w] = most_displacement(worlds, 0, w, dt)


@entry
def _compare_moves(first, last, worlds, dt, rows):
    block = block_of(worlds, first, last - first, worlds.units)
    bound_moves(worlds.fleet.joints, block, 0, dt, rows)


@entry
def _compare_boxes(first, last, worlds, gap, apart):
    for w in range(first, last):
        block = block_of(worlds, w, 1, worlds.units)
        apart[w] = boxes_apart(worlds.fleet.bodies, block, 0, 1, 0, gap)


@entry
def _gaps(first, last, worlds, most, gaps):
    for w in range(first, last):
        block = block_of(worlds, w, 1, worlds.units)
        gaps[w] = gap_of_bodies(worlds.fleet.bodies, block, 0, 1, 0, most)


def corners(worlds):
    """Return the corners of all bodies of the first HAV, (W, ...) complex [m]."""
    shapes = body_shapes(worlds)[0]  # (U, W)
    found = []
    for w in range(shapes.shape[1]):
        points = [shapely.get_coordinates(shape) for shape in shapes[:, w] if not shape.is_empty]
        found.append(np.concatenate(points) @ [1.0, 1.0j])
    return found


def moved(vehicle, fleet, num_worlds, steps, seed):
    """Return the movement of points in a step, as a share of the bound: over all HAVs and steps."""
    scenario = RandomPoses(num_havs=1, fleet=fleet)
    batch = Batch(scenario, num_worlds, vehicle=vehicle)
    batch.reset(seed)
    rng, bounds, shares = np.random.default_rng(seed), np.zeros(num_worlds), []
    _bound_all(num_worlds, batch.worlds, 0.2, bounds, threads=1)
    before = corners(batch.worlds)
    for step in range(steps):
        if step % 5 == 0:
            steering = rng.choice([-2.0, 2.0], (1, num_worlds))
        batch.step(np.full((1, num_worlds), 1e3), steering)
        after = corners(batch.worlds)
        shares += [np.abs(b - a).max() / d for a, b, d in zip(before, after, bounds, strict=True)]
        before = after
    return np.array(shares)


@pytest.mark.parametrize("vehicle", VEHICLE_MODELS)
def test_no_point_moves_farther_in_a_step_than_the_bound(vehicle):
    shares = moved(vehicle, RandomFleet(), budget(40, 4), budget(120, 30), 11)
    assert shares.max() <= 1.0
    assert shares.max() > 0.5  # the bound is informative


@pytest.mark.exhaustive
def test_no_point_of_a_catalogue_vehicle_moves_farther_than_the_bound():
    fleet = catalogue_fleet(("baggage-train", "wb-67", "b-double"))
    vehicle = OffAxle(bodies=Rectangles())
    shares = moved(vehicle, fleet, budget(30, 3), budget(100, 20), 13)
    assert shares.max() <= 1.0


def test_gaps_of_lines_are_those_of_shapely():
    worlds = nearby_pairs(OnAxle(), 17)
    gaps, most = np.zeros(worlds.lanes), 4.0
    _gaps(worlds.lanes, worlds, most, gaps, threads=1)
    expected = np.minimum(distances(worlds), most)
    assert np.abs(gaps - expected).max() < 1e-9
    assert 0.05 < (gaps == 0.0).mean() < 0.9


def test_gaps_of_rectangles_are_zero_where_they_meet_and_never_above_the_distance():
    worlds = nearby_pairs(OffAxle(bodies=Rectangles()), 19)
    gaps, most = np.zeros(worlds.lanes), 4.0
    _gaps(worlds.lanes, worlds, most, gaps, threads=1)
    expected = distances(worlds)
    assert (gaps <= np.minimum(expected, most) + 1e-9).all()
    assert np.array_equal(gaps > 1e-9, expected > 1e-9)
    near = (expected < most) & (expected > 0.0)
    assert (gaps[near] > 0.7 * expected[near]).all()


def test_havs_whose_boxes_are_apart_have_no_smaller_gap():
    worlds, gap = nearby_pairs(OnAxle(), 23), 1.5
    apart, gaps = np.zeros(worlds.lanes, np.bool_), np.zeros(worlds.lanes)
    _compare_boxes(worlds.lanes, worlds, gap, apart, threads=1)
    _gaps(worlds.lanes, worlds, gap, gaps, threads=1)
    assert (distances(worlds)[apart] > gap).all()
    assert (gaps[apart] == gap).all()
    assert 0.05 < apart.mean() < 0.9


def test_rough_bounds_on_moves_are_not_shorter_than_the_bounds():
    batch = Batch(RandomPoses(num_havs=1, fleet=RandomFleet()), budget(500, 20))
    batch.reset(25)
    worlds, exact = batch.worlds, np.zeros(batch.num_worlds)
    rows = np.zeros((count_rows(worlds.units), worlds.lanes))
    _bound_all(worlds.lanes, worlds, 0.2, exact, threads=1)
    _compare_moves(worlds.lanes, worlds, 0.2, rows, threads=1)
    assert (rows[LONGEST_MOVE] >= exact).all()
    assert (rows[LONGEST_MOVE] < 1.5 * exact).all()


def nearby_pairs(vehicle, seed):
    """Return worlds of two bent HAVs that are near each other."""
    batch = Batch(RandomPoses(num_havs=2, area_factor=4.0), budget(2_000, 60), vehicle=vehicle)
    batch.reset(seed)
    state, rng = batch.worlds.state, np.random.default_rng(seed)
    state.heading[:] += np.cumsum(rng.uniform(-0.5, 0.5, state.heading.shape), axis=1)
    state.cosine[:], state.sine[:] = np.cos(state.heading), np.sin(state.heading)
    near = rng.uniform(0.0, 20.0, batch.num_worlds) * np.exp(
        2j * np.pi * rng.random(batch.num_worlds)
    )
    state.x[1], state.y[1] = state.x[0] + near.real, state.y[0] + near.imag
    return batch.worlds


def distances(worlds):
    """Return the distance (W,) [m] between the bodies of both HAVs."""
    one, other = body_shapes(worlds)
    return np.array(
        [
            shapely.distance(shapely.union_all(one[:, w]), shapely.union_all(other[:, w]))
            for w in range(worlds.lanes)
        ]
    )
