"""Crossing, yard and column match their docstrings, and no chains touch at the start."""

import collections
import itertools
import math

import numpy as np
import pytest
import shapely
from scipy import stats

from hav_env import Column, Crossing, RandomFleet, Yard
from hav_env.world.arrays import ACTUAL, DUBINS, FOOTPRINT, STABLE
from tests.support.budgets import budget
from tests.support.worlds import chain, sample, wrapped

LONG_TRUCKS = RandomFleet(max_trailers=1, long_truck_mean=12.0, short_truck_mean=12.0)
FORMATIONS = [Crossing, Yard, Column]


@pytest.mark.parametrize("kind", FORMATIONS)
@pytest.mark.parametrize("fleet", [RandomFleet(), LONG_TRUCKS], ids=["paper", "long trucks"])
@pytest.mark.parametrize(
    ("num_havs", "compiled", "pure"), [(1, 20, 3), (2, 500, 50), (5, 200, 20), (20, 30, 3)]
)
def test_no_chains_touch_at_the_start_nor_at_goals(kind, fleet, num_havs, compiled, pure):
    scenario = kind(num_havs=num_havs, num_goals=2, fleet=fleet, gap=0.001)
    worlds = sample(scenario, budget(compiled, pure), seed=3)
    count, length = worlds.fleet.num_trailers, worlds.fleet.length
    starts = np.stack([worlds.state.x, worlds.state.y, worlds.state.heading[:, 0]], axis=1)
    phases = [starts, worlds.goals[:, 0], worlds.goals[:, 1]]
    for places, w in itertools.product(phases, range(count.shape[1])):
        chains = [
            shapely.LineString(
                chain(length[i, : n + 1, w], *places[i, :2, w], np.repeat(places[i, 2, w], n + 1))
            )
            for i, n in enumerate(count[:, w])
        ]
        for one, other in itertools.combinations(chains, 2):
            assert not shapely.intersects(one, other)
    assert (worlds.record.first[:, ACTUAL] == -1).all()


@pytest.mark.parametrize("num_havs", [1, 2, 5, 20])
def test_a_crossing_is_the_least_circle_with_goals_opposite(num_havs):
    scenario = Crossing(num_havs=num_havs, num_goals=3, gap=3.0)
    worlds = sample(scenario, budget(200, 10))
    place = worlds.state.x + 1j * worlds.state.y
    heading = np.exp(1j * worlds.state.heading[:, 0])
    radius, trucks = abs(place), worlds.fleet.length[:, 0]
    assert np.ptp(radius, axis=0) == pytest.approx(0.0, abs=1e-9)
    assert -place / radius == pytest.approx(heading)  # to the centre
    spacing = wrapped(np.diff(np.angle(place), axis=0))
    assert spacing == pytest.approx(wrapped(math.tau / num_havs)) or num_havs == 2
    goal = worlds.goals[:, :, 0] + 1j * worlds.goals[:, :, 1]
    turned = np.exp(1j * worlds.goals[:, :, 2])
    for phase, side in enumerate((-1, 1, -1)):
        assert goal[:, phase] == pytest.approx(side * place)
        assert turned[:, phase] == pytest.approx(-side * heading)
    room = radius[0] - trucks.max(axis=0) - 3.0  # the remaining space of the tightest constraint
    footprint = worlds.fleet.radius[:, FOOTPRINT]
    for i, h in itertools.combinations(range(num_havs), 2):
        room = np.minimum(room, abs(place[i] - place[h]) - footprint[i] - footprint[h] - 3.0)
    assert room == pytest.approx(0.0, abs=1e-9)


def test_rows_of_a_yard_are_bays_of_one_width_side_by_side():
    scenario = Yard(num_havs=5, num_goals=3, aisle=70.0, gap=4.0)
    worlds = sample(scenario, budget(200, 20))
    half = worlds.fleet.radius[:, FOOTPRINT] + 2.0
    rows = [(worlds.state.x, worlds.state.y, worlds.state.heading[:, 0])]
    rows += [tuple(np.moveaxis(worlds.goals[:, phase], 1, 0)) for phase in range(3)]
    for number, (x, y, heading) in enumerate(rows):
        assert (y == 70.0 * number).all()
        assert (heading == math.pi / 2).all()
        order = np.argsort(x, axis=0)
        left, right = (np.take_along_axis(x + s * half, order, axis=0) for s in (-1, 1))
        assert left[1:] == pytest.approx(right[:-1], abs=1e-9)
        assert left[0] == pytest.approx(-right[-1], abs=1e-9)
    assert (np.diff(worlds.state.x, axis=0) > 0.0).all()


def test_all_ways_to_deal_out_bays_are_as_likely_and_rows_are_dealt_one_by_one():
    many = budget(20_000, 400)
    goals = sample(Yard(num_havs=3, num_goals=2), many).goals
    orders = np.argsort(goals[:, :, 0], axis=0)  # (bay, phase, W)
    dealt = collections.Counter(map(bytes, orders.astype(np.uint8).reshape(6, many).T.copy()))
    assert len(dealt) == 36
    assert stats.chisquare(list(dealt.values())).pvalue > 1e-3


def test_no_hav_of_a_yard_needs_a_loop():
    worlds = sample(Yard(num_havs=6), budget(500, 20))
    shift = abs(worlds.goals[:, 0, 0] - worlds.state.x)
    assert (worlds.record.goal[:, 0, DUBINS] <= Yard().aisle + shift + 1e-6).all()
    assert worlds.fleet.radius[:, STABLE].max() < 0.5 * Yard().aisle


def test_a_column_stands_in_line_and_moves_on():
    scenario = Column(num_havs=4, num_goals=3, distance=50.0, gap=7.0)
    worlds = sample(scenario, budget(200, 20))
    x, footprint = worlds.state.x, worlds.fleet.radius[:, FOOTPRINT]
    assert (x[0] == 0.0).all()
    assert not worlds.state.y.any()
    assert not worlds.state.heading.any()
    front = x + np.maximum(footprint, worlds.fleet.length[:, 0])
    assert (x - footprint)[:-1] - front[1:] == pytest.approx(7.0)
    for phase in range(3):
        assert worlds.goals[:, phase, 0] == pytest.approx(x + 50.0 * (phase + 1))
        assert not worlds.goals[:, phase, 1:].any()
