"""Vehicles with hitches, bodies and actuators: an episode is the same wherever it runs."""

import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from hav_env import (
    Batch,
    Limited,
    Lines,
    OffAxle,
    OnAxle,
    RandomPoses,
    Rectangles,
    Task,
    catalogue_fleet,
    explicit,
    parallel_env,
)
from hav_env.envs.gymnasium_vector import HAVSwarmVectorEnv
from hav_env.evaluation.rollout import rollout
from hav_env.vehicles import COMBINATIONS
from hav_env.world.arrays import ACTUAL, WHEN
from tests.support.budgets import COMPILED, budget
from tests.support.worlds import bits

VEHICLES = {
    "realistic": OffAxle(bodies=Rectangles(), actuators=Limited()),
    "rectangles": OnAxle(bodies=Rectangles(3.0, 1.0, 1.5)),
}
CAREFUL = AvoidJack(beta=1.0)  # below the limits of all joints
FLEET = catalogue_fleet(COMBINATIONS.names())
# goals that are easy to hit, in little space: many events in few steps
TASK = Task(dt=0.5, distance_tolerance=15.0, heading_tolerance=2.8, max_steps=budget(150, 12))
MANY = 140  # worlds, more than a block


def scenario_for(vehicle, num_havs=3):
    if isinstance(vehicle, OffAxle):
        return RandomPoses(num_havs=num_havs, fleet=FLEET, area_factor=2.0)
    return RandomPoses(num_havs=num_havs, area_factor=2.0)


def driven(vehicle, episodes, threads=1):
    batch = Batch(scenario_for(vehicle), len(episodes), TASK, vehicle, threads)
    batch.reset(8, np.array(episodes))
    rng = np.random.default_rng(3)
    for _ in range(budget(40, 6)):
        speed, steering = rng.uniform([[[0.0]], [[-0.5]]], [[[9.0]], [[0.5]]], (2, 3, MANY))
        batch.step(speed[:, episodes], steering[:, episodes])
    return batch.worlds


@pytest.fixture(
    params=[
        pytest.param(VEHICLES["realistic"], id="realistic"),
        pytest.param(VEHICLES["rectangles"], id="rectangles", marks=pytest.mark.exhaustive),
    ]
)
def vehicle(request):
    return request.param


@pytest.mark.exhaustive
@pytest.mark.parametrize("threads", [1, 3])
def test_a_world_among_others_is_the_world_alone(vehicle, threads):
    many = driven(vehicle, np.arange(budget(MANY, 5)), threads)
    for w in budget((0, 1, 17, 63, 64, 127, 128, MANY - 1), (0, 4)):
        assert bits(many, w) == bits(driven(vehicle, [w])), w


@pytest.mark.exhaustive
def test_an_episode_in_a_rollout_is_the_episode_alone_and_things_happen(vehicle):
    scenario, episodes = scenario_for(vehicle), np.arange(budget(60, 3))
    table = rollout(CAREFUL, scenario, 5, episodes, TASK, vehicle, threads=2)
    for episode in episodes[:: budget(11, 2)]:
        alone = rollout(CAREFUL, scenario, 5, [episode], TASK, vehicle, threads=1)
        assert alone.to_pydict() == table.slice(3 * episode, 3).to_pydict()
    if len(episodes) > 10:
        hits = table["goal_1_hit"].to_numpy(zero_copy_only=False)
        assert 0.05 < hits.mean() < 1.0
        assert any(table["actual_collision"].to_pylist())


@pytest.mark.exhaustive
def test_environments_begin_and_step_the_same_worlds(vehicle):
    """A vector of worlds, which begin on a stage, and a single world with the same actions."""
    scenario, count = scenario_for(vehicle), budget(20, 3)
    vector = HAVSwarmVectorEnv(count, scenario=scenario, vehicle=vehicle, task=TASK)
    alone = parallel_env(scenario=scenario, vehicle=vehicle, task=TASK)
    seen, _ = vector.reset(seed=list(range(count)))
    rng = np.random.default_rng(5)
    actions = rng.uniform(-1, 1, (10, *vector.action_space.shape)).astype(np.float32)
    told = [vector.step(action) for action in actions]
    for w in range(0, count, 6):
        first, _ = alone.reset(seed=w)
        size = len(first["hav_0"])
        shape = len(alone.possible_agents), size
        assert np.array_equal(np.array([*first.values()]), seen[w].reshape(shape))
        for action, outcome in zip(actions, told, strict=True):
            if not alone.agents:
                break
            chosen = action[w].reshape(len(alone.possible_agents), 2)
            own, rewards, *_ = alone.step(dict(zip(alone.possible_agents, chosen, strict=True)))
            assert np.array_equal(np.array([*own.values()]), outcome[0][w].reshape(shape))
            assert np.mean([*rewards.values()]) == pytest.approx(outcome[1][w], abs=1e-9)


@pytest.mark.exhaustive
def test_where_a_world_lies_does_not_matter(vehicle):
    """Turned and shifted, HAVs have the same articulations and collide in the same steps."""
    rng, turn, shift = np.random.default_rng(2), 0.7, np.array([30.0, -80.0])
    lengths = [[4.0, 6.0, 3.0]] * 3
    start = np.c_[np.arange(3) * 19.0, np.zeros(3), np.pi / 2 + np.array([-0.35, 0.0, 0.35])]
    goals = start + np.array([5.0, 200.0, 0.2])

    def moved(poses):
        rotation = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        return np.c_[poses[:, :2] @ rotation + shift, poses[:, 2] + turn]

    batches = [
        Batch(explicit(lengths, one, two[:, None], footprint_truck_share=0.0), 1, Task(), vehicle)
        for one, two in ((start, goals), (moved(start), moved(goals)))
    ]
    for batch in batches:
        batch.reset(1)
    for _ in range(budget(600, 20)):
        command = rng.uniform([[[0.0]], [[-0.1]]], [[[1.0]], [[0.1]]], (2, 3, 1))
        for batch in batches:
            batch.step(*command)
    one, other = (batch.worlds for batch in batches)
    bends = [np.diff(worlds.state.heading, axis=1) for worlds in (one, other)]
    np.testing.assert_allclose(*bends, atol=1e-9)
    np.testing.assert_allclose(one.state.speed, other.state.speed, atol=1e-9)
    assert np.array_equal(one.record.first, other.record.first)
    assert not COMPILED or (one.record.first[:, ACTUAL, WHEN] > 0).any()


@pytest.mark.exhaustive
def test_bodies_decide_who_collides():
    """Side by side, 3 m apart: lines pass each other, bodies 3.1 m wide do not."""
    scenario = explicit([[4.0, 6.0]] * 2, [[0, 0, 0], [0, 14, 0]], [[[1e3, 0, 0]], [[1e3, 14, 0]]])
    for width, expected in ((None, -1), (2.9, -1), (3.1, 1)):
        bodies = Lines() if width is None else Rectangles(width)
        batch = Batch(scenario, 1, Task(), OnAxle(bodies=bodies))
        batch.reset(0)
        batch.worlds.state.y[1] = 3.0
        batch.step(np.zeros((2, 1)), np.zeros((2, 1)))
        assert batch.worlds.record.first[0, ACTUAL, WHEN, 0] == expected
