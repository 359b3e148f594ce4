"""A world is the same to the bit in any lane, with any worlds in the lanes beside it."""

import functools

import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from hav_env import Batch, Limited, OnAxle, RandomFleet, RandomPoses, Task, find_scenario
from hav_env.evaluation.episode_table import tabulate
from hav_env.evaluation.rollout import rollout
from hav_env.policies.interface import allocate_memory, decide
from hav_env.world.arrays import JACKKNIFE, MOVED, PATH, PHASE, WHEN
from tests.support.budgets import budget
from tests.support.policies import OneByOne, Weaving
from tests.support.worlds import bits, limit, open_plane, put

# Goals that are easy to hit, and joints that are easy to bend too far: many events in few steps.
TASK = Task(dt=2.0, distance_tolerance=25.0, heading_tolerance=2.8, max_steps=budget(40, 12))
SHORT = RandomFleet(max_length=5.0, short_truck_mean=3.0, long_truck_mean=5.0, articulation_max=0.6)
CAREFUL = AvoidJack(beta=0.3)
STEPS = budget(30, 12)
MOST = 300  # worlds


def eventful(num_havs):
    return RandomPoses(num_havs=num_havs, fleet=SHORT)


@functools.cache
def actions(num_havs):
    """Return speed and steering (STEPS, 2, N, MOST) of every world, some beyond the limits."""
    low, high = np.array([-0.2, -1.0]), np.array([1.5, 1.0])
    shape = STEPS, num_havs, MOST, 2
    return np.moveaxis(np.random.default_rng(8).uniform(low, high, shape), -1, 1)


def driven(num_havs, episodes, threads=1, vehicle=OnAxle()):
    """Return a batch of these episodes after STEPS of their actions."""
    batch = Batch(eventful(num_havs), len(episodes), TASK, vehicle, threads)
    batch.reset(8, np.array(episodes))
    for speed, steering in actions(num_havs)[..., episodes]:
        batch.step(speed, steering)
    return batch


@functools.cache
def driven_alone(num_havs, episode, vehicle=OnAxle()):
    return bits(driven(num_havs, [episode], vehicle=vehicle).worlds)


@pytest.mark.parametrize("num_worlds", budget((1, 5, 127, 128, 129, MOST), (1, 5, 20)))
@pytest.mark.parametrize("num_havs", [1, 3, 20])
@pytest.mark.parametrize("threads", [1, 3])
def test_a_world_in_a_batch_is_the_world_alone(num_worlds, num_havs, threads):
    batch = driven(num_havs, range(num_worlds), threads)
    for w in range(num_worlds):
        assert bits(batch.worlds, w) == driven_alone(num_havs, w), w


@pytest.mark.parametrize("num_worlds", budget((5, 129), (5,)))
@pytest.mark.parametrize("num_havs", [1, 3])
def test_a_world_of_havs_that_brake_is_the_world_alone(num_worlds, num_havs):
    # the brakes are so weak that HAVs still roll when the others stand
    vehicle = OnAxle(actuators=Limited(acceleration=0.2, braking=0.05))
    batch = driven(num_havs, range(num_worlds), vehicle=vehicle)
    rolls = batch.worlds.state.waiting & (batch.worlds.state.speed > 0.0)
    assert num_worlds < 100 or num_havs == 1 or 0.01 < rolls.mean() < 0.9
    for w in range(num_worlds):
        assert bits(batch.worlds, w) == driven_alone(num_havs, w, vehicle), w


def test_much_happens_in_these_worlds():
    batch = driven(3, range(budget(MOST, 40)))
    state, record = batch.worlds.state, batch.worlds.record
    jackknifed = record.first[:, JACKKNIFE, WHEN] >= 0
    for happened in (state.waiting, jackknifed, state.goal[0, PHASE] > 0):
        assert happened.any()
        assert not happened.all()
    assert len(np.unique(batch.worlds.fleet.num_trailers)) > 5


def test_a_hav_does_not_depend_on_how_long_those_beside_it_are():
    trailers = np.tile(np.arange(10, 0, -1), budget(13, 2))
    rng, num_worlds = np.random.default_rng(9), len(trailers)
    lengths = [rng.uniform(2.0, 12.0, n + 1) for n in trailers]
    speed, steering = rng.uniform(-1, 1, (2, STEPS, 1, num_worlds))
    speed += 1.0

    def driven_in(lanes, room):
        batch = open_plane(len(lanes), 1, room)
        limit(batch.worlds, articulation=0.1)
        for lane, w in enumerate(lanes):
            headings = 0.05 * np.arange(trailers[w] + 1)
            put(batch.worlds, lengths[w], 3.0, 4.0, headings, w=lane)
        for step in range(STEPS):
            batch.step(speed[step][:, lanes], steering[step][:, lanes])
        return batch.worlds

    def seen(worlds, lane, n):
        state, record = worlds.state, worlds.record
        units = [array[0, : n + 1, lane] for array in (state.heading, state.cosine, state.sine)]
        whole = state.x, state.y, state.goal[0], record.first[0], record.total[0]
        return [array.tobytes() for array in (*units, *(array[..., lane] for array in whole))]

    together = driven_in(range(num_worlds), 10)
    for w, n in enumerate(trailers):
        assert seen(together, w, n) == seen(driven_in([w], n), 0, n), w


def test_units_that_are_not_there_keep_their_heading_and_influence_nothing():
    num_havs, num_worlds = 3, budget(130, 12)
    batches = [Batch(eventful(num_havs), num_worlds, TASK) for _ in range(2)]
    for batch in batches:
        batch.reset(10)
    fleet = batches[0].worlds.fleet
    absent = np.arange(fleet.length.shape[1])[:, None] > fleet.num_trailers[:, None]  # (N, U, W)
    rng, state = np.random.default_rng(10), batches[1].worlds.state
    for array, size in ((state.heading, 9.0), (state.cosine, 2.0), (state.sine, 2.0)):
        array[absent] = rng.uniform(-size, size, absent.sum())
    before = state.heading[absent].tobytes()
    seen = []
    for batch in batches:
        memory = allocate_memory(CAREFUL, num_havs, num_worlds)
        decided = []
        for _ in range(STEPS):
            action = decide(CAREFUL, memory, batch)
            decided.append(np.stack(action).tobytes())
            batch.step(*action)
        state = batch.worlds.state
        units = [array[~absent].tobytes() for array in (state.heading, state.cosine, state.sine)]
        poses = np.stack([state.x, state.y, state.heading[:, 0]], axis=1)
        table = rows(tabulate(batch.worlds, poses, CAREFUL), num_havs)
        seen.append([decided, units, memory.tobytes(), table])
    assert seen[0] == seen[1]
    assert state.heading[absent].tobytes() == before


def test_who_waits_does_not_move_while_others_do():
    num_havs, num_worlds = 3, budget(130, 20)
    batch = Batch(eventful(num_havs), num_worlds, TASK, threads=1)
    batch.reset(11)
    state, total = batch.worlds.state, batch.worlds.record.total
    rng, waited = np.random.default_rng(11), 0

    def standing(who):
        units = state.heading, state.cosine, state.sine
        havs = state.x, state.y, total[:, PATH], total[:, MOVED], *np.moveaxis(units, 2, 0)
        return [array[..., who].tobytes() for array in havs]

    for _ in range(2 * STEPS):
        waits, x, moved = state.waiting.copy(), state.x.copy(), total[:, MOVED].copy()
        before = standing(waits)
        batch.step(rng.uniform(0.2, 2.0, x.shape), rng.uniform(-1, 1, x.shape))
        assert standing(waits) == before
        assert (state.speed[waits] == 0.0).all()
        assert (state.x != x)[~waits].all()
        assert (total[:, MOVED] == moved + 1.0)[~waits].all()
        waited += waits.sum()
    assert 2 * STEPS < waited < 2 * STEPS * x.size / 2


def rows(table, num_havs):
    """Return all numbers of each episode with all their digits, nulls and not-a-numbers."""
    havs = table.to_pylist()
    return [repr(havs[first : first + num_havs]) for first in range(0, len(havs), num_havs)]


@functools.cache
def rolled_alone(policy, num_havs, episode):
    table = rollout(policy, eventful(num_havs), 12, np.array([episode]), TASK, threads=1)
    return rows(table, num_havs)[0]


@pytest.mark.parametrize("policy", [CAREFUL, Weaving(gain=0.2)], ids=["avoid_jack", "weaving"])
@pytest.mark.parametrize(
    ("num_havs", "num_episodes"),
    # worlds of three HAVs run in fewer lanes than there are episodes: lanes are filled again
    budget([(n, w) for n in (1, 3) for w in (1, 7, 130, 200)], [(1, 20), (3, 30)]),
)
def test_an_episode_in_a_rollout_is_the_episode_alone(policy, num_havs, num_episodes):
    order = np.random.default_rng(13).permutation(num_episodes)
    for threads in budget((1, 3), (1,)):
        table = rollout(policy, eventful(num_havs), 12, order, TASK, threads=threads)
        for episode, row in zip(order.tolist(), rows(table, num_havs), strict=True):
            assert row == rolled_alone(policy, num_havs, episode), episode
    if num_episodes > 100:  # some end before the others: lanes move
        steps = table["steps"].to_pylist()
        assert min(steps) < max(steps) == TASK.max_steps


@pytest.mark.parametrize("name", ["paper-single", "paper-pair", "crossing-8"])
def test_a_policy_decides_the_same_for_one_hav_and_for_many_lanes(name):
    scenario = find_scenario(name)
    episodes, task = np.arange(budget(100, 3)), Task(max_steps=budget(3_000, 30))
    in_lanes, one_by_one = (
        rows(rollout(policy, scenario, 14, episodes, task), scenario.num_havs)
        for policy in (AvoidJack(), OneByOne())
    )
    assert in_lanes == one_by_one


LAYOUTS = {
    "rows": lambda array: array.copy(),
    "columns": np.asfortranarray,
    "every_other": lambda array: np.repeat(array, 2, axis=1)[:, ::2],
    "single_precision": lambda array: array.astype(np.float32),
    "whole_numbers": lambda array: array.astype(int),
}


@pytest.mark.parametrize("layout", LAYOUTS.values(), ids=LAYOUTS)
def test_a_step_leaves_the_arrays_of_its_caller_as_they_are(layout):
    num_worlds = budget(130, 20)
    batch = Batch(eventful(3), num_worlds, TASK)
    batch.reset(15)
    batch.worlds.state.waiting[0] = True
    given = [
        layout(array) for array in np.random.default_rng(15).uniform(-9, 9, (2, 3, num_worlds))
    ]
    kept = [array.copy() for array in given]
    batch.step(*given)
    for array, copy in zip(given, kept, strict=True):
        assert array.tobytes() == copy.tobytes()
    assert not batch.worlds.state.speed[0].any()
    assert np.array_equal(batch.worlds.state.speed[1:], kept[0][1:].clip(0.0, 1.0))
