"""HAVs collide with obstacles when Shapely finds it, in the same step and at the same segment."""

import functools
import math

import numpy as np
import pyarrow.compute as pc
import pytest
import shapely

from hav_env import Batch, Field, OffAxle, OnAxle, Rectangles, Task, build_site, explicit, rollout
from hav_env.vehicles import VEHICLES
from hav_env.world.arrays import NEVER, OBSTACLE, WHEN, WHERE
from hav_env.world.event_table import EVENTS
from tests.support.budgets import COMPARED, COMPILED, budget
from tests.support.obstacles import gaps_to_walls, touching_walls

TRUCK = OffAxle(bodies=Rectangles(width=1.0))
WALL = build_site(lines=[[[10.0, -5.0], [10.0, 5.0]]])


def driven(batch, steps, rng):
    """Drive HAVs about at random, and yield the worlds after each step."""
    shape = batch.worlds.state.x.shape
    speed = steering = np.zeros(shape)
    for step in range(steps):
        if step % 10 == 0:
            speed, steering = rng.uniform(0, 6, shape), rng.uniform(-0.6, 0.6, shape)
        batch.step(speed, steering)
        yield batch.worlds


@pytest.mark.parametrize(
    "vehicle",
    [
        VEHICLES.make("realistic"),
        pytest.param(OffAxle(substeps=2), marks=pytest.mark.exhaustive),
    ],
)
def test_first_collisions_are_those_of_a_brute_force(vehicle):
    batch = Batch(Field(num_havs=2), budget(16, 1), vehicle=vehicle)
    batch.reset(7)
    expected = np.full((2, batch.num_worlds), NEVER)
    assert not touching_walls(batch.worlds).any()
    for step, worlds in enumerate(driven(batch, budget(120, 60), np.random.default_rng(3)), 1):
        touching = touching_walls(worlds)
        new = touching.any(axis=1) & (expected == NEVER)
        expected[new] = step
        first = worlds.record.first[:, OBSTACLE]
        assert np.array_equal(first[:, WHEN], expected), step
        assert np.take_along_axis(touching, first[:, None, WHERE], axis=1)[:, 0][new].all()
    assert budget(0.2, 0.0) <= (expected != NEVER).mean() < 1.0


def test_gaps_found_are_never_above_distances_and_segments_are_seldom_due():
    batch = Batch(Field(num_havs=1), budget(40, 2), vehicle=OffAxle(bodies=Rectangles()))
    batch.reset(11)
    before, changed, steps = batch.worlds.place.due.copy(), 0.0, budget(100, 20)
    for worlds in driven(batch, steps, np.random.default_rng(5)):
        place, safe = worlds.place, worlds.record.first[0, OBSTACLE, WHEN] == NEVER
        left = place.due[:, 0].T - place.driven[0, 0]  # (S, W)
        assert (left <= gaps_to_walls(worlds)[0] + 1e-9)[:, safe].all()
        changed += (place.due != before).mean() / steps
        before = place.due.copy()
    assert 0.0 < changed < 0.1


def one_truck(vehicle=TRUCK, **task):
    """Return a batch of one truck with a trailer of 5 m, 4 m before a wall."""
    scenario = explicit([[4.0, 5.0]], [[0.0, 0.0, 0.0]], [[[90.0, 0.0, 0.0]]], site=WALL)
    batch = Batch(scenario, 1, Task(**task), vehicle)
    batch.reset(0)
    return batch


def steps_until_hit(batch) -> int:
    """Drive straight on at 1 m/s until the wall is hit; return in which step."""
    for _ in range(60):
        batch.step(np.ones((1, 1)), np.zeros((1, 1)))
        if batch.worlds.record.first[0, OBSTACLE, WHEN, 0] != NEVER:
            break
    return int(batch.worlds.record.first[0, OBSTACLE, WHEN, 0])


@pytest.mark.parametrize("vehicle", [TRUCK, pytest.param(OnAxle(), marks=pytest.mark.exhaustive)])
def test_a_truck_hits_a_wall_when_its_front_is_there(vehicle):
    assert (
        steps_until_hit(one_truck(vehicle)) == 30
    )  # 6 m at 0.2 m a step; the front axle is 4 m ahead


def test_what_happens_between_recorded_steps_is_found_in_the_next_one():
    assert steps_until_hit(one_truck(record_every=7)) == 35


def test_a_collision_ends_an_episode_only_if_the_task_says_so():
    batch = one_truck(on_obstacle="end")
    steps_until_hit(batch)
    assert batch.ended.all()
    batch = one_truck()
    steps_until_hit(batch)
    assert not batch.ended.any()


def test_a_world_begins_anew_without_what_it_hit_before():
    batch = one_truck()
    assert steps_until_hit(batch) == 30
    batch.reset(1)
    assert batch.worlds.record.first[0, OBSTACLE, WHEN, 0] == NEVER
    assert steps_until_hit(batch) == 30


def test_waiting_and_turning_on_the_spot_of_no_speed_keep_the_gap():
    batch = one_truck()
    for _ in range(5):
        batch.step(np.zeros((1, 1)), np.full((1, 1), 0.5))
    assert batch.worlds.place.driven[0, 0, 0] == 0.0


@pytest.mark.exhaustive
def test_tables_have_obstacles_only_where_there_are_some():
    event = next(event for event in EVENTS if event.obstacles)
    scenario = explicit([[4.0, 5.0]], [[0.0, 0.0, 0.0]], [[[90.0, 0.0, 0.0]]], site=WALL)
    table = rollout("dubins_pursuit", scenario, 1, [0], Task(max_steps=60))
    assert table[event.name].to_pylist() == [True]
    assert table[f"{event.stem}_step"].to_pylist() == [30]
    assert table[f"{event.stem}_segment"].to_pylist() == [0]
    plane = rollout(
        "avoid_jack",
        scenario._replace(
            site=scenario.site._replace(
                segment=np.zeros((0, 4)), outline=np.zeros(0, int), kind=np.zeros(0, int)
            )
        ),
        1,
        [0],
        Task(max_steps=60),
    )
    assert event.name not in plane.column_names


@pytest.mark.skipif(not COMPILED, reason=COMPARED)
@pytest.mark.exhaustive
def test_episodes_are_the_same_in_any_lane_and_on_any_thread():
    run = functools.partial(
        rollout, "dubins_pursuit", "field-4", 5, task=Task(max_steps=400), vehicle="realistic"
    )
    together = run(range(150), threads=1)
    assert together == run(range(150), threads=2)
    for episode in (0, 77, 149):
        alone = run([episode], threads=1)
        assert alone == together.filter(pc.field("episode") == episode)
    assert 0.1 < np.mean(together["obstacle_collision"].to_pylist()) < 1.0


def touching_between(before, after):
    """Return (S,) which segments a chain (K, 2) meets, or nearly meets, as its axles move straight.

    The second value is false where the chain stays away by more than it moves between two moments.
    """
    moments = np.linspace(0.0, 1.0, 401)[:, None, None]
    lines = shapely.linestrings(before + moments * (after - before))
    gaps = shapely.distance(lines[:, None], WALLS).min(axis=0)
    return gaps == 0.0, gaps <= np.abs(after - before).max() / 200


WALLS = shapely.linestrings(
    [[[6.0, -2.0], [6.0, 2.5]], [[-4.0, 8.0], [3.0, 7.0]], [[-9.0, -9.0], [-7.0, -4.0]]]
)


@pytest.mark.parametrize("num_havs", [1, 2])
def test_obstacles_passed_between_steps_are_found_if_the_task_looks_there(num_havs):
    """The chains are thin and short, and move by up to 4 m in a step."""
    worlds, steps = budget(120, 3), 12
    site = build_site(lines=[shapely.get_coordinates(wall).tolist() for wall in WALLS])
    scenario = explicit(
        [[1.0, 1.5, 0.8]] * num_havs,
        [[0.0, 40.0 * hav, 0.0] for hav in range(num_havs)],
        [[[900.0, 40.0 * hav, 0.0]] for hav in range(num_havs)],
        speed_max=20.0,
        site=site,
    )
    rng = np.random.default_rng(12)
    commands = rng.uniform(2.0, 20.0, (steps, worlds)), rng.uniform(-0.7, 0.7, (steps, worlds))
    found = {}
    for looks in (False, True):
        batch = Batch(scenario, worlds, Task(continuous_collisions=looks))
        batch.reset(0)
        surely, perhaps = (np.full(worlds, NEVER) for _ in range(2))
        before = axles_of(batch.worlds)
        for step in range(steps):
            batch.step(*(np.tile(part[step], (num_havs, 1)) for part in commands))
            after = axles_of(batch.worlds)
            for w in range(worlds):
                met, near = touching_between(before[w], after[w])
                surely[w] = step + 1 if met.any() and surely[w] == NEVER else surely[w]
                perhaps[w] = step + 1 if near.any() and perhaps[w] == NEVER else perhaps[w]
            before = after
        found[looks] = batch.worlds.record.first[0, OBSTACLE, WHEN]
    same = found[True] == surely
    assert (same | (found[True] == perhaps)).all()
    assert same.mean() > 0.9
    hit = found[False] != NEVER
    assert (found[True][hit] != NEVER).all()
    assert budget(np.mean(found[True] != found[False]) > 0.1, True)


def axles_of(worlds):
    """Return the axles (W, K, 2) of the first HAV, front to end."""
    along = np.exp(1j * worlds.state.heading[0].T)  # (W, U)
    length, rear = worlds.fleet.length[0].T, worlds.state.x[0] + 1j * worlds.state.y[0]
    front = rear + length[:, 0] * along[:, 0]
    axles = front[:, None] - np.cumsum(length * along, axis=1)
    axles = np.concatenate([front[:, None], axles], axis=1)
    return np.stack([axles.real, axles.imag], axis=-1)


@pytest.mark.parametrize(
    ("vehicle", "hits"),
    [
        (OffAxle(bodies=Rectangles(width=1.9)), False),
        (OffAxle(bodies=Rectangles(width=2.1)), True),
        pytest.param(OnAxle(), False, marks=pytest.mark.exhaustive),
    ],
)
def test_a_thin_truck_passes_where_a_wide_one_does_not(vehicle, hits):
    gate = build_site(lines=[[[10.0, 1.0], [10.0, 9.0]], [[10.0, -9.0], [10.0, -1.0]]])
    scenario = explicit([[4.0, 5.0]], [[0.0, 0.0, 0.0]], [[[90.0, 0.0, 0.0]]], site=gate)
    batch = Batch(scenario, 1, vehicle=vehicle)
    batch.reset(0)
    for _ in range(120):
        batch.step(np.ones((1, 1)), np.zeros((1, 1)))
    assert (batch.worlds.record.first[0, OBSTACLE, WHEN, 0] != NEVER) == hits
    assert math.isclose(batch.worlds.state.x[0, 0], 24.0)


@pytest.mark.parametrize("num_worlds", [1, 20])
def test_what_happens_before_a_hav_waits_is_found_whatever_the_other_worlds_do(num_worlds):
    """HAV 0 touches a wall and waits at its goal before the step that records; HAV 1 drives on."""
    scenario = explicit(
        [[4.0, 5.0]] * 2,
        [[0.0, 0.0, 0.0], [0.0, 50.0, 0.0]],
        [[[10.0, 0.0, 0.0]], [[900.0, 50.0, 0.0]]],
        site=build_site(lines=[[[8.0, 0.0], [8.0, 3.0]]]),
    )
    batch = Batch(scenario, num_worlds, Task(record_every=60), TRUCK)
    batch.reset(0)
    ones = np.ones((2, num_worlds))
    for _ in range(60):
        batch.step(ones, 0.0 * ones)
    assert batch.worlds.state.waiting[0].all()
    assert (batch.worlds.record.first[0, OBSTACLE, WHEN] == 60).all()


def test_a_hav_that_begins_at_a_wall_hits_it_in_the_first_step():
    kerb = build_site(lines=[[[-3.0, 0.5], [-3.0, 2.5]]])
    scenario = explicit([[4.0, 5.0]], [[0.0, 0.0, 0.0]], [[[90.0, 0.0, 0.0]]], site=kerb)
    batch = Batch(scenario, 1, Task(on_obstacle="end"), OffAxle(bodies=Rectangles()))
    batch.reset(0)
    assert batch.worlds.record.first[0, OBSTACLE, WHEN, 0] == NEVER
    batch.step(np.ones((1, 1)), np.zeros((1, 1)))
    assert batch.worlds.record.first[0, OBSTACLE, WHEN, 0] == 1
    assert batch.ended.all()
