"""Neighbours are those of a search of all pairs, whatever moved the HAVs since they were listed."""

import numpy as np
import pytest

from hav_env import Batch, RandomFleet, RandomPoses, Task
from hav_env.world.arrays import HANDFUL, PHASE, RADIUS, is_removed
from hav_env.world.lanes import block_of, exchange_worlds
from hav_env.world.neighborhood import find_nearby
from tests.support.budgets import budget
from tests.support.worlds import limit, open_plane, put, stand

SHORT = RandomFleet(max_length=5.0, short_truck_mean=3.0, long_truck_mean=5.0)


def listed(batch, w=0):
    """Return the neighbours of each HAV of a world."""
    nearby = batch.world(w).nearby
    return [nearby.index[i, :count].tolist() for i, count in enumerate(nearby.count)]


def searched(worlds, sensing_range, w=0):
    """Return the same by comparing all pairs."""
    radius, length = worlds.fleet.radius[:, 0, w], worlds.fleet.length[:, 0, w]
    reaches = np.maximum(radius, length)
    dx, dy = (np.subtract.outer(place[:, w], place[:, w]) for place in worlds.state[:2])
    limits = np.add.outer(reaches, reaches) + sensing_range
    near = dx * dx + dy * dy <= limits * limits
    np.fill_diagonal(near, False)
    return [np.flatnonzero(row).tolist() for row in near]


def scattered(layout, num_havs, rng):
    if layout == "random":
        return rng.uniform(0, 400, (num_havs, 2))
    if layout == "clustered":
        centres = rng.uniform(-500, 500, (num_havs // 10 + 1, 2))
        return centres[rng.integers(len(centres), size=num_havs)] + rng.normal(0, 30, (num_havs, 2))
    if layout == "far":
        return rng.choice([-1, 1], (num_havs, 2)) * 10 ** rng.uniform(0, 7, (num_havs, 2))
    if layout == "pile":
        return np.full((num_havs, 2), -7.0)
    return rng.integers(-3, 4, (num_havs, 2)) * 40.0  # on the borders of cells


@pytest.mark.parametrize("layout", ["random", "clustered", "far", "pile", "grid"])
@pytest.mark.parametrize("num_havs", [2, HANDFUL, HANDFUL + 1, 16, 17, 60, 200])
def test_the_list_of_neighbours_is_that_of_a_search_of_all_pairs(num_havs, layout):
    rng = np.random.default_rng(num_havs)
    for sensing_range in (0.0, 30.0):
        batch = open_plane(1, num_havs, 2, task=Task(sensing_range=sensing_range))
        limit(batch.worlds)
        places = scattered(layout, num_havs, rng)
        for agent, (x, y) in enumerate(places):
            lengths = [5.0, 2.0, 3.0] if layout == "grid" else rng.uniform(2, 12, 3)
            put(batch.worlds, lengths, x, y, agent=agent)
        stand(batch)
        assert listed(batch) == searched(batch.worlds, sensing_range)


def disturb(batch, rng):
    """Change a batch by hand as users and rollouts may do between two steps."""
    worlds, (num_havs, num_worlds) = batch.worlds, batch.worlds.state.x.shape
    hav, w = rng.integers(num_havs), rng.integers(num_worlds)
    deed = rng.integers(16)
    if deed == 0:  # anywhere
        worlds.state.x[hav, w], worlds.state.y[hav, w] = rng.uniform(-100, 100, 2)
    elif deed == 1:  # beside another one
        other = rng.integers(num_havs)
        worlds.state.x[hav, w] = worlds.state.x[other, w] + rng.normal(0, 30)
        worlds.state.y[hav, w] = worlds.state.y[other, w]
    elif deed == 2:  # all a little, together or not
        worlds.state.x[:, w] += rng.normal(0, 3, rng.choice([1, num_havs]))
    elif deed == 3:  # a longer one, or a shorter one
        put(worlds, rng.uniform(1, 20, 3), *rng.uniform(-100, 100, 2), w=w, agent=hav)
    elif deed == 4:
        worlds.fleet.radius[hav, 0, w] *= rng.uniform(0.8, 1.3)
    elif deed == 5:  # a HAV that has hit its last goal leaves the world in the next step
        worlds.state.waiting[hav, w], worlds.state.goal[hav, PHASE, w] = True, 0
    elif deed == 6:
        exchange_worlds(worlds, w, worlds, rng.integers(num_worlds))
    elif deed == 7:
        batch.reset(int(rng.integers(1000)))


@pytest.mark.parametrize("fastest", [1.0, 30.0])
@pytest.mark.parametrize("num_havs", [2, 9, 17, 40])
def test_neighbors_are_found_whatever_moves_the_havs(num_havs, fastest):
    """Some drive as fast as they can, others are put elsewhere, leave, or change worlds."""
    rng, num_worlds = np.random.default_rng(num_havs), budget(18, 6)
    rules = Task(sensing_range=20.0, on_goal="remove")
    scenario = RandomPoses(num_havs, num_goals=1, fleet=SHORT._replace(speed_max=fastest))
    batch = Batch(scenario, num_worlds, rules)
    batch.reset(5)
    kept = seen = left = 0
    for _ in range(budget(400, 20)):
        disturb(batch, rng)
        speed = rng.choice([0.0, fastest], (num_havs, num_worlds), p=[0.1, 0.9])
        before = batch.worlds.nearby.circle.copy()
        batch.step(speed, rng.uniform(-0.3, 0.3, speed.shape))
        kept += (batch.worlds.nearby.circle == before).all((0, 1)).sum()
        left += is_removed(batch.worlds, slice(None), slice(None)).sum()
        for w in range(num_worlds):
            found = listed(batch, w)
            assert found == searched(batch.worlds, 20.0, w)
            seen += sum(map(len, found))
    assert seen > 0
    assert left > 0 or budget(400, 20) < 400
    if fastest == 1.0:  # lists have been of use
        assert kept > num_worlds


@pytest.mark.parametrize("num_havs", [HANDFUL + 1, 20])
@pytest.mark.parametrize("x", [0.0, -1e7])
def test_a_list_is_kept_right_to_its_margin(num_havs, x):
    """Two HAVs come towards each other as far as the list allows, where it matters most."""
    task = Task(sensing_range=10.0)
    for beyond in (-1e-6, -1e-8, 0.0, 1e-8, 1e-6):  # farther apart than the range of the list [m]
        for moved in (0.5, 1.0 - 1e-6, 1.0, 1.0 + 1e-6, 1.5):  # of the margin
            batch = open_plane(1, num_havs, 2, task=task)
            limit(batch.worlds)
            for agent in range(num_havs):
                put(batch.worlds, [3.0, 4.0, 5.0], 0.0, 1e3 * agent, agent=agent)
            stand(batch)
            margin = batch.worlds.nearby.circle[0, RADIUS, 0] - 9.0 - 5.0
            assert margin > 0.0
            range_, state = 9.0 + 9.0 + 10.0, batch.worlds.state
            state.y[1], state.x[:2, 0] = 0.0, (x, x + range_ + 2.0 * margin + beyond)
            stand(batch)
            assert listed(batch) == searched(batch.worlds, 10.0)
            state.x[:2, 0] += (moved * margin, -moved * margin)
            stand(batch)
            assert listed(batch) == searched(batch.worlds, 10.0)
            assert (listed(batch)[0] == [1]) == (2.0 * margin * (1.0 - moved) + beyond <= 0.0) or (
                abs(2.0 * margin * (1.0 - moved) + beyond) < 1e-7
            )


@pytest.mark.parametrize("num_havs", [3, 30])
def test_a_list_holds_for_the_range_that_it_was_made_for_and_for_less(num_havs):
    rng = np.random.default_rng(6)
    batch = open_plane(1, num_havs, 2)
    for agent in range(num_havs):
        put(batch.worlds, rng.uniform(2, 12, 3), *rng.uniform(0, 200, 2), agent=agent)
    block = block_of(batch.worlds, 0, 1, 3)
    for sensing_range in (30.0, 10.0, 31.0, 45.0, 0.0, 500.0, 20.0):
        find_nearby(Task(sensing_range=sensing_range), block)
        assert listed(batch) == searched(batch.worlds, sensing_range)


def test_no_place_is_no_place_to_keep_a_list_for():
    batch = open_plane(1, 2, 2)
    for agent in range(2):
        put(batch.worlds, [3.0, 4.0], 30.0 * agent, agent=agent)
    stand(batch)
    assert listed(batch) == [[1], [0]]
    batch.worlds.state.x[1] = np.nan
    stand(batch)
    assert listed(batch) == [[], []]
    batch.worlds.state.x[1] = 30.0
    stand(batch)
    assert listed(batch) == [[1], [0]]
