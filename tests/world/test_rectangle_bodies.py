"""Bodies that are rectangles touch when Shapely finds it; without a width they equal the lines."""

import numpy as np
import pytest
import shapely

from hav_env import OffAxle, Rectangles
from hav_env.world.arrays import derive_radii
from hav_env.world.bodies import (
    bodies_meet,
    box_at,
    boxes_overlap,
    enclose,
    find_box,
    front_end,
    nearest_on_bodies,
    reach_of,
)
from hav_env.world.other_havs import CHAIN_ROWS, NEAREST_X, NEAREST_Y, find_nearest_points
from hav_env.world.units.parts import Lines
from tests.support.budgets import budget
from tests.support.worlds import hitch, open_plane, put

HAVS = 0, 1


def rectangles(lengths, offsets, shapes, x, y, headings):
    """Return the bodies of a HAV as Shapely has them, straight from the definitions."""
    place, bodies, before = np.array([x, y]), [], np.zeros(2)
    for j, (length, heading) in enumerate(zip(lengths, headings, strict=True)):
        along = np.array([np.cos(heading), np.sin(heading)])
        if j > 0:
            place = place - offsets[j - 1] * before - length * along
        half, front, rear = shapes[j]
        across = half * np.array([-along[1], along[0]])
        ahead, behind = place + (length + front) * along, place - rear * along
        corners = [ahead + across, ahead - across, behind - across, behind + across]
        bodies.append(shapely.Polygon(corners))
        before = along
    return shapely.union_all(bodies)


@pytest.fixture(scope="module")
def pairs():
    """Return worlds of two random HAVs with drawbars, fifth wheels and overhangs, and bodies."""
    rng, count = np.random.default_rng(31), budget(2_000, 150)
    batch = open_plane(count, 2, 5, vehicle=OffAxle(bodies=Rectangles()))
    worlds, found = batch.worlds, []
    for w in range(count):
        for agent in HAVS:
            n = rng.integers(1, 6)
            lengths = rng.uniform(1.5, 9.0, n + 1)
            offsets = rng.uniform(-0.8, 0.8, n) * np.minimum(lengths[1:], 2.0)
            shapes = np.c_[rng.uniform(0.1, 1.6, n + 1), rng.uniform(0, 2, (n + 1, 2))]
            headings = rng.uniform(-np.pi, np.pi) + np.r_[0, rng.uniform(-0.8, 0.8, n)].cumsum()
            x, y = rng.uniform(-14, 14, 2)
            put(worlds, lengths, x, y, headings, w=w, agent=agent)
            hitch(worlds, offsets, w=w, agent=agent)
            worlds.fleet.bodies.shape[agent, : n + 1, :, w] = shapes
            derive_radii(worlds.fleet, agent, w, 0.0)
            found.append(rectangles(lengths, offsets, shapes, x, y, headings))
    return worlds, np.array(found).reshape(count, 2)


def test_they_collide_exactly_when_shapely_says_so(pairs):
    worlds, shapes = pairs
    bodies = worlds.fleet.bodies
    expected = shapely.intersects(shapes[:, 0], shapes[:, 1])
    assert 0.1 < expected.mean() < 0.9
    enclose(worlds, 1)
    meet = [bodies_meet(bodies, worlds, 0, 1, w) for w in range(len(shapes))]
    assert meet == expected.tolist()
    near = [
        boxes_overlap(*(find_box(bodies, worlds, agent, w) for agent in HAVS))
        for w in range(len(shapes))
    ]
    assert not (expected & ~np.array(near)).any()
    enclose(worlds, 0)
    for w in range(len(shapes)):
        for left, right, low, high in (find_box(bodies, worlds, 0, w), box_at(worlds, 0, w)):
            np.testing.assert_allclose((left, low, right, high), shapes[w, 0].bounds, atol=1e-9)


def test_nearest_points_gaps_and_reaches_are_shapelys(pairs):
    worlds, shapes = pairs
    bodies, chain = worlds.fleet.bodies, np.zeros((CHAIN_ROWS, len(shapes)))
    find_nearest_points(worlds, 0, 1, chain)
    for w in range(len(shapes)):
        truck = shapely.Point(worlds.state.x[0, w], worlds.state.y[0, w])
        distance = shapely.distance(truck, shapes[w, 1])
        assert np.hypot(chain[NEAREST_X, w], chain[NEAREST_Y, w]) == pytest.approx(distance)
        nearest = nearest_on_bodies(bodies, worlds, 1, w, truck.x, truck.y)
        assert truck.distance(shapely.Point(nearest)) == pytest.approx(distance, abs=1e-9)
        reached = shapely.hausdorff_distance(truck, shapes[w, 0])
        assert reached <= reach_of(bodies, worlds.fleet, 0, w) + 1e-9
        front = shapely.Point(front_end(bodies, worlds, 0, w))
        assert shapely.distance(front, shapes[w, 0]) < 1e-9


def test_the_reach_is_that_of_the_straight_hav():
    """It is given away only where a hitch lies ahead of an axle, and half the width at the end."""
    batch = open_plane(1, 1, 3, vehicle=OffAxle(bodies=Rectangles(2.0, 1.0, 0.5)))
    put(batch.worlds, [4.0, 2.0, 6.0, 5.0])
    hitch(batch.worlds, [1.0, 0.0, 1.5])
    derive_radii(batch.worlds.fleet, 0, 0, 0.0)
    reach = reach_of(batch.worlds.fleet.bodies, batch.worlds.fleet, 0, 0)
    assert reach == pytest.approx(1.0 + 2.0 + 6.0 + 1.5 + np.hypot(5.5, 1.0))


def test_without_width_and_overhangs_they_are_the_lines():
    rng, count = np.random.default_rng(8), budget(20_000, 2_000)
    batch = open_plane(count, 2, 3, vehicle=OffAxle(bodies=Rectangles(0.0)))
    worlds = batch.worlds
    for w in range(count):
        for agent in HAVS:
            lengths = rng.uniform(2, 9, rng.integers(2, 5))
            headings = rng.uniform(-np.pi, np.pi) + rng.uniform(-0.9, 0.9, len(lengths)).cumsum()
            put(worlds, lengths, *rng.uniform(-8, 8, 2), headings, w=w, agent=agent)
    lines = worlds._replace(fleet=worlds.fleet._replace(bodies=Lines()))
    kinds = (worlds.fleet.bodies, worlds), (Lines(), lines)
    found = []
    for bodies, them in kinds:
        enclose(them, 1)
        found.append([bodies_meet(bodies, them, 0, 1, w) for w in range(count)])
    assert 0.1 < np.mean(found[0]) < 0.9
    differ = np.flatnonzero(np.array(found[0]) != np.array(found[1]))
    assert len(differ) <= count / 10_000  # those that just touch, by rounding
    places = rng.uniform(-20, 20, (count, 2))
    for w in range(0, count, 20):
        nearest = [nearest_on_bodies(bodies, them, 0, w, *places[w]) for bodies, them in kinds]
        gaps = [np.hypot(*(np.array(point) - places[w])) for point in nearest]
        assert gaps[0] == pytest.approx(gaps[1], abs=1e-9)
    boxes = [[find_box(bodies, them, 0, w) for w in range(100)] for bodies, them in kinds]
    np.testing.assert_allclose(*boxes, atol=1e-9)
    enclose(lines, 0)
    np.testing.assert_allclose([box_at(lines, 0, w) for w in range(100)], boxes[1], atol=1e-9)
