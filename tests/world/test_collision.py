"""Circles and chains touch when Shapely finds it, and the lists of neighbours miss no HAV."""

import itertools

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from hav_env import Batch, RandomFleet, RandomPoses, Task
from hav_env.maths.geometry import segments_intersect
from hav_env.world.arrays import ACTUAL, FOOTPRINT, POTENTIAL, WHEN, WHERE
from hav_env.world.bodies import bodies_meet, enclose
from hav_env.world.units.parts import Lines
from tests.support.budgets import budget
from tests.support.worlds import chain, open_plane, put, stand


def shape(points):
    """Return a line, or the point that it has shrunk to."""
    distinct = np.unique(points, axis=0)
    return shapely.LineString(points) if len(distinct) > 1 else shapely.Point(distinct[0])


def touch(one, other) -> bool:
    return bool(shapely.intersects(shape(one), shape(other)))


grid = st.tuples(*[st.integers(-2, 2)] * 2)  # small: most cases touch, overlap or line up


@given(grid, grid, grid, grid)
def test_segments_on_a_grid_intersect_exactly_when_shapely_says_so(a, b, c, d):
    expected = touch([a, b], [c, d])
    for (p, q), (r, s) in itertools.product([(a, b), (b, a)], [(c, d), (d, c)]):
        assert segments_intersect(*map(float, (*p, *q, *r, *s))) == expected
        assert segments_intersect(*map(float, (*r, *s, *p, *q))) == expected


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e6])
def test_random_segments_intersect_exactly_when_shapely_says_so(size):
    ends = np.random.default_rng(3).uniform(-size, size, (budget(20_000, 2_000), 4, 2))
    lines = shapely.linestrings(ends[:, :2]), shapely.linestrings(ends[:, 2:])
    expected = shapely.intersects(*lines)
    found = [segments_intersect(*row) for row in ends.reshape(-1, 8)]
    assert 0.1 < np.mean(expected) < 0.9
    assert found == expected.tolist()


def recorded(batch, event) -> np.ndarray:
    """Return (W,) whether HAVs 0 and 1 have touched by now; both records must agree."""
    first = batch.worlds.record.first[:, event]
    assert (first[0, WHEN] == first[1, WHEN]).all()
    assert (first[0, WHERE] == np.where(first[0, WHEN] < 0, -1, 1)).all()
    assert (first[1, WHERE] == np.where(first[1, WHEN] < 0, -1, 0)).all()
    return first[0, WHEN] >= 0


def pairs(count, most_trailers, lengths_of, room, bend, seed):
    """Return a batch of random pairs of HAVs, and their chains."""
    rng = np.random.default_rng(seed)
    batch, chains = open_plane(count, 2, most_trailers), []
    for w in range(count):
        for agent in range(2):
            lengths = lengths_of(rng, rng.integers(1, most_trailers + 1))
            headings = rng.uniform(0, 2 * np.pi) + np.r_[0, rng.uniform(-bend, bend, len(lengths))]
            x, y = rng.uniform(-room, room, 2)
            put(batch.worlds, lengths, x, y, headings[:-1].cumsum(), w=w, agent=agent)
            chains.append(chain(lengths, x, y, headings[:-1].cumsum()))
    stand(batch)
    return batch, chains


def any_lengths(rng, trailers):
    return rng.uniform(2, 12, trailers + 1)


def long_truck(rng, trailers):
    return np.r_[12.0, rng.uniform(0.1, 1.0, trailers)]


@pytest.mark.parametrize(
    ("lengths_of", "most_trailers", "room", "bend"),
    [
        (any_lengths, 10, 25, 0.5),
        (any_lengths, 3, 15, 3.0),
        (any_lengths, 1, 8, 1.5),
        (long_truck, 3, 7, 1.0),
        (long_truck, 1, 10, 3.0),
    ],
)
def test_random_havs_collide_exactly_when_shapely_says_so(lengths_of, most_trailers, room, bend):
    count = budget(2_000, 200)
    batch, chains = pairs(count, most_trailers, lengths_of, room, bend, seed=most_trailers)
    expected = [touch(*chains[2 * w : 2 * w + 2]) for w in range(count)]
    assert 0.1 < np.mean(expected) < 0.9
    assert recorded(batch, ACTUAL).tolist() == expected


def test_havs_on_a_grid_collide_exactly_when_shapely_says_so():
    """Units of whole metres along the axes of the plane: chains touch, overlap and share ends."""
    count, rng = budget(5_000, 500), np.random.default_rng(5)
    batch, expected = open_plane(count, 2, 3), []
    state = batch.worlds.state
    directions = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])
    for w in range(count):
        chains = []
        for agent in range(2):
            lengths = rng.integers(1, 4, rng.integers(2, 5)).astype(float)
            place, turns = rng.integers(-4, 5, 2).astype(float), rng.integers(0, 4, len(lengths))
            put(batch.worlds, lengths, *place, turns * np.pi / 2, w=w, agent=agent)
            steps = lengths[:, None] * directions[turns]
            state.cosine[agent, : len(turns), w] = directions[turns, 0]  # without rounding
            state.sine[agent, : len(turns), w] = directions[turns, 1]
            behind = place - steps[1:].cumsum(axis=0)
            chains.append(np.concatenate([[place + steps[0], place], behind]))
        expected.append(touch(*chains))
    assert 0.1 < np.mean(expected) < 0.9
    enclose(batch.worlds, 1)
    assert [bodies_meet(Lines(), batch.worlds, 0, 1, w) for w in range(count)] == expected


def test_circles_that_touch_are_in_potential_collision():
    gaps = [0.0, 10.0, 17.0, np.nextafter(17.0, 0), np.nextafter(17.0, 99), 17.1, 1e3]
    batch = open_plane(len(gaps), 2, 3, task=Task(sensing_range=0.0))
    for w, gap in enumerate(gaps):
        put(batch.worlds, [3.0, 4.0, 6.0], -gap, 0.0, 1.0, w=w, agent=0)
        put(batch.worlds, [20.0, 7.0], 0.0, 0.0, 2.0, w=w, agent=1)  # the truck does not count
    stand(batch)
    assert recorded(batch, POTENTIAL).tolist() == [gap <= 17.0 for gap in gaps]


@pytest.mark.parametrize(("num_havs", "seed"), [(4, 2), (9, 2), (25, 3)])
def test_the_first_collision_and_the_partner_in_it_are_recorded(num_havs, seed):
    task = Task(sensing_range=0.0, dt=1.0)
    scenario = RandomPoses(num_havs, fleet=RandomFleet(max_trailers=3, speed_max=2.0))
    batch, rng = Batch(scenario, 1, task), np.random.default_rng(seed)
    batch.reset(seed)
    world = batch.world(0)
    radius = world.fleet.radius[:, FOOTPRINT]
    expected = {POTENTIAL: {}, ACTUAL: {}}  # HAV: step, the other HAVs in collision then
    steering = rng.uniform(-0.3, 0.3, (num_havs, 1))
    for step in range(1, budget(400, 250)):
        batch.step(np.full((num_havs, 1), 2.0), steering)
        state, fleet = world.state, world.fleet
        chains = [
            chain(fleet.length[i, : n + 1], state.x[i], state.y[i], state.heading[i, : n + 1])
            for i, n in enumerate(fleet.num_trailers)
        ]
        gap = np.hypot(state.x - state.x[:, None], state.y - state.y[:, None])
        lines = np.array([shapely.LineString(points) for points in chains])
        hits = {
            POTENTIAL: gap <= radius + radius[:, None],
            ACTUAL: shapely.intersects(lines[:, None], lines[None, :]),
        }
        for event, matrix in hits.items():
            for i in range(num_havs):
                others = set(np.flatnonzero(matrix[i])) - {i}
                if others:
                    expected[event].setdefault(i, (step, others))
    for event, by_hav in expected.items():
        assert by_hav  # the drive was long enough
        for i in range(num_havs):
            when, where = world.record.first[i, event]
            step, others = by_hav.get(i, (-1, {-1}))
            assert (when, where in others) == (step, True)
