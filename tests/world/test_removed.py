"""A flag shows that a HAV has left a world, not its position."""

import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from baselines.replay.trajectory import record_trajectory
from hav_env import Batch, Observation, RandomPoses, Task, explicit, parallel_env
from hav_env.rendering import describe, scene_of
from hav_env.simulator.transition import ended, remove_arrived
from hav_env.world.arrays import (
    ACTUAL,
    JACKKNIFE,
    NEVER,
    PHASE,
    POTENTIAL,
    REMOVED,
    STEP,
    WHEN,
    is_removed,
)
from tests.support.budgets import budget

FAR = [(0.0, 0.0), (1.55e7, 4.25e6), (-2.0037508e7, 2.0037508e7), (9e7, -9e7)]
LEAVES = Task(on_goal="remove", max_steps=2_000)
STRAIGHT = {"lengths": [[4.0, 8.0], [3.0, 5.0], [4.0, 6.0]]}


def at(x, y, near=3.0):
    """Return three HAVs in lanes of their own; the first is at its goal after a few steps."""
    start = [[x, y + 40.0 * k, 0.0] for k in range(3)]
    goals = [[[x + far, y + 40.0 * k, 0.0]] for k, far in enumerate((near, 60.0, 80.0))]
    return explicit(**STRAIGHT, start=start, goals=goals)


def driven(scenario, steps, task=LEAVES):
    """Return a batch in which all drive straight on for so many steps."""
    batch = Batch(scenario, task=task)
    batch.reset(0)
    for _ in range(steps):
        batch.step(np.ones((3, 1)), np.zeros((3, 1)))
    return batch


@pytest.mark.parametrize("place", FAR)
def test_nobody_is_removed_who_only_is_far_away(place):
    env = parallel_env(scenario=at(*place), render_mode="ansi")
    env.reset(seed=0)
    for _ in range(3):
        env.step(dict.fromkeys(env.agents, np.zeros(2)))
        assert "removed" not in env.render()
    assert not driven(at(*place), 30, Task()).worlds.record.total[:, REMOVED].any()


@pytest.mark.parametrize("place", FAR)
def test_who_left_is_removed_and_nobody_else(place):
    batch = driven(at(*place), 30)
    assert batch.worlds.record.total[:, REMOVED, 0].tolist() == [1.0, 0.0, 0.0]
    seen = scene_of(batch.worlds, 0, 0.2)
    assert seen.removed.tolist() == [True, False, False]
    assert describe(seen).count("removed") == 1
    batch.reset(0)
    assert not batch.worlds.record.total[:, REMOVED].any()


@pytest.mark.parametrize("place", FAR)
@pytest.mark.parametrize("sensing_range", [0.0, 30.0, 1e6])
def test_who_left_is_sensed_and_touched_by_nobody(place, sensing_range):
    """The third drives through the place that the first has left."""
    x, y = place
    scenario = explicit(
        **STRAIGHT,
        start=[[x, y, 0.0], [x, y + 40.0, 0.0], [x - 30.0, y, 0.0]],
        goals=[[[x + 3.0, y, 0.0]], [[x + 60.0, y + 40.0, 0.0]], [[x + 90.0, y, 0.0]]],
    )
    task = LEAVES._replace(sensing_range=sensing_range)
    batch = driven(scenario, 20, task)
    for _ in range(budget(250, 200)):
        batch.step(np.ones((3, 1)), np.zeros((3, 1)))
        nearby = batch.world(0).nearby
        if batch.worlds.record.total[0, REMOVED, 0]:
            assert nearby.count[0] == 0
            for hav in (1, 2):
                assert 0 not in nearby.index[hav, : nearby.count[hav]]
    assert batch.worlds.state.x[2, 0] > x
    assert (batch.worlds.record.first[:, (POTENTIAL, ACTUAL), 0, 0] == NEVER).all()


@pytest.mark.parametrize("num_havs", [5, 20])
def test_all_may_leave_and_none_of_them_senses_another(num_havs):
    start = [[0.0, 40.0 * k, 0.0] for k in range(num_havs)]
    goals = [[[3.0 + k, 40.0 * k, 0.0]] for k in range(num_havs)]
    batch = Batch(
        explicit([[4.0, 8.0]] * num_havs, start, goals),
        task=LEAVES._replace(sensing_range=1e6),
    )
    batch.reset(0)
    for _ in range(150):
        batch.step(np.ones((num_havs, 1)), np.zeros((num_havs, 1)))
    assert batch.worlds.record.total[:, REMOVED].all()
    assert not batch.worlds.nearby.count.any()


@pytest.mark.parametrize("every", [1, 7, 40])
@pytest.mark.parametrize("place", FAR)
def test_a_trajectory_keeps_where_somebody_was_last(place, every):
    trajectory = record_trajectory(AvoidJack(), at(*place), 0, 0, LEAVES, every=every)
    left = trajectory.removed[:, 0]
    assert 0 < left.sum() < len(left)
    assert not left[0]
    hit = trajectory.goals[0, 0, :2]
    last = np.stack([trajectory.x[left, 0], trajectory.y[left, 0]], axis=1)
    assert (np.linalg.norm(last - hit, axis=1) < LEAVES.distance_tolerance).all()


def test_all_that_is_kept_of_an_episode_far_away_is_that_of_one_at_the_origin():
    near = record_trajectory(AvoidJack(), at(0.0, 0.0), 0, 0, LEAVES)
    for place in FAR[1:3]:
        far = record_trajectory(AvoidJack(), at(*place), 0, 0, LEAVES)
        assert np.array_equal(far.step, near.step)
        assert np.array_equal(far.removed, near.removed)
        assert far.x - place[0] == pytest.approx(near.x, abs=1e-5)
        assert far.y - place[1] == pytest.approx(near.y, abs=1e-5)


@pytest.mark.parametrize("place", FAR[:2])
def test_what_is_seen_far_away_is_what_is_seen_at_the_origin(place):
    """The conversion to float32 loses nothing, neither for learners nor for a central critic."""
    seen = []
    for x, y in ((0.0, 0.0), place):
        env = parallel_env(scenario=at(x, y), observation=Observation(2, True, True))
        told, _ = env.reset(seed=0)
        rows = [*told.values(), env.state()]
        for turn in np.linspace(-0.5, 0.5, 20):
            told, *_ = env.step(dict.fromkeys(env.agents, np.array([1.0, turn])))
            rows += [*told.values(), env.state()]
        seen.append(np.concatenate(rows))
    assert seen[1] == pytest.approx(seen[0], abs=1e-5)


def test_the_state_of_a_world_far_away_tells_havs_apart():
    env = parallel_env(scenario=at(1.55e7, 4.25e6))
    env.reset(seed=0)
    state = dict(zip(env._state.names, env.state(), strict=True))
    assert [state[f"hav_{k}_y"] for k in range(3)] == pytest.approx([0.0, 0.4, 0.8])
    assert state["hav_2_goal_x"] == pytest.approx(0.8)


def test_the_state_says_nothing_of_who_left():
    env = parallel_env(scenario=at(0.0, 0.0), on_goal="remove")
    env.reset(seed=0)
    for _ in range(30):
        env.step({agent: np.array([1.0, 0.0]) for agent in env.agents})
    state = dict(zip(env._state.names, env.state(), strict=True))
    gone = [value for name, value in state.items() if name.startswith("hav_0_")]
    assert not any(gone)
    assert state["hav_1_present"] == 1.0


def test_one_rule_tells_of_one_world_and_of_many():
    rules = Task(on_goal="remove", on_collision="end", on_jackknife="end", max_steps=50)
    batch = Batch(RandomPoses(2), 6, rules)
    batch.reset(3)
    batch.worlds.state.waiting[:, 1] = True
    batch.worlds.state.goal[:, PHASE, 1] = batch.scenario.num_goals - 1
    batch.worlds.state.waiting[:, 2] = True  # at a goal that is not the last
    batch.worlds.record.first[1, ACTUAL, WHEN, 3] = 7
    batch.worlds.record.first[0, JACKKNIFE, WHEN, 4] = 0  # before the first step
    batch.worlds.state.clock[STEP, 5] = 50
    over = [bool(ended(batch.task, batch.worlds, lane)) for lane in range(6)]
    assert over == batch.ended.tolist() == [False, True, False, True, False, True]
    remove_arrived(batch.task, batch.worlds)
    gone = is_removed(batch.worlds, slice(None), slice(None))
    assert gone.tolist() == [[w == 1 for w in range(6)]] * 2
    assert all(
        is_removed(batch.worlds, agent, lane) == gone[agent, lane]
        for agent in range(2)
        for lane in range(6)
    )
