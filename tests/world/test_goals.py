"""A goal is hit within both tolerances; the next comes when all have hit; all of it is recorded."""

import math

import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.dubins_pursuit import DubinsPursuit
from hav_env import Batch, RandomPoses, Task, explicit
from hav_env.evaluation.rollout import rollout
from hav_env.maths.dubins import path_length
from hav_env.world.arrays import (
    CLOSEST,
    DUBINS,
    EUCLIDEAN_MISS,
    HEADING_MISS,
    HIT_DISTANCE,
    HIT_HEADING,
    HIT_PATH,
    HIT_STEP,
    MISS_ARTICULATION,
    MISS_COUNT,
    MISS_DISTANCE,
    MISS_HEADING,
    PHASE,
    STEP,
)
from tests.support.budgets import COMPILED, budget
from tests.support.worlds import ALL, aim, limit, open_plane, put, stand, wrapped

TASK = Task(distance_tolerance=0.5, heading_tolerance=0.1)


def hits(distances, turns, direction=0.0, goal_heading=0.0):
    """Return which HAVs hit a goal at these distances [m] and heading differences [rad]."""
    batch = open_plane(len(distances), task=TASK)
    aim(batch.worlds, ALL, ALL, 0.0, 0.0, goal_heading)
    for w, (distance, turn) in enumerate(zip(distances, turns, strict=True)):
        place = distance * np.exp(1j * direction)
        put(batch.worlds, [3.0, 4.0], place.real, place.imag, goal_heading + turn, w=w)
    stand(batch)
    return batch.worlds.state.waiting[0].tolist()


def test_both_tolerances_are_strict():
    inside, outside = np.nextafter(0.5, 0), np.nextafter(0.5, 1)
    assert hits([0.0, inside, 0.5, outside], [0.0] * 4) == [True, True, False, False]
    inside, outside = np.nextafter(0.1, 0), np.nextafter(0.1, 1)
    for sign in (1, -1):
        turns = [sign * turn for turn in (0.0, inside, 0.1 + 1e-12, 0.3)]
        assert hits([0.0] * 4, turns) == [True, True, False, False]
    assert hits([0.49, 0.49, 0.51, 0.51], [0.09, 0.11, 0.09, 0.11]) == [True, False, False, False]


@pytest.mark.parametrize("direction", np.linspace(0, 6, 7))
@pytest.mark.parametrize("goal_heading", [-3.1, -math.pi, 0.0, 3.1, math.pi, 6.2, 40.0])
def test_tolerances_hold_all_round_and_across_half_a_turn(direction, goal_heading):
    turns = [0.0999, -0.0999, 0.1001, -0.1001, math.tau, math.tau + 0.0999, -7 * math.tau - 0.1001]
    expected = [True, True, False, False, True, True, False]
    assert hits([0.4999] * 7, turns, direction, goal_heading) == expected
    assert not any(hits([0.5001] * 7, turns, direction, goal_heading))


def test_whoever_hits_waits_until_all_have_and_then_all_go_on():
    batch = open_plane(1, 2, task=TASK, goals=3)
    world = batch.world(0)
    limit(batch.worlds)
    goals = np.array(
        [[[0.0, 0, 0], [50, 0, 0], [0, 0, 0]], [[500.0, 0, 0], [550, 0, 0], [0, 0, 0]]]
    )
    world.goals[:] = goals
    for agent in range(2):
        aim(batch.worlds, agent, 0, *goals[agent, 0])
    put(batch.worlds, [3.0, 4.0], 0.0, 0.0, agent=0)
    put(batch.worlds, [3.0, 4.0], 490.0, 0.0, agent=1)
    stand(batch)
    assert world.state.waiting.tolist() == [True, False]
    assert world.state.goal[:, PHASE].tolist() == [0, 0]
    batch.step(np.ones((2, 1)), np.zeros((2, 1)))
    assert world.state.x.tolist() == [0.0, pytest.approx(490.2)]
    put(batch.worlds, [3.0, 4.0], 500.3, 0.0, agent=1)
    stand(batch)
    assert world.state.goal[:, PHASE].tolist() == [1, 1]
    assert world.state.waiting.tolist() == [False, False]
    assert world.record.goal[:, 0, HIT_STEP].tolist() == [1, 3]
    assert world.record.goal[:, 0, HIT_DISTANCE].tolist() == [0.0, pytest.approx(0.3)]
    assert world.record.goal[:, 1, DUBINS].tolist() == pytest.approx([50.0, 49.7])
    assert np.isnan(world.record.goal[:, 2, DUBINS]).all()
    for agent, goal in enumerate(goals[:, 1]):
        put(batch.worlds, [3.0, 4.0], *goal, agent=agent)
    stand(batch)
    assert world.state.goal[:, PHASE].tolist() == [2, 2]
    assert not batch.ended[0]
    put(batch.worlds, [3.0, 4.0], 0.0, 0.0, agent=0)
    put(batch.worlds, [3.0, 4.0], 0.0, 0.0, agent=1)
    stand(batch)
    assert world.state.goal[:, PHASE].tolist() == [2, 2]  # there is no further goal
    assert world.state.waiting.all()
    assert batch.ended[0]


def test_alone_each_goes_on_as_soon_as_it_hits():
    batch = open_plane(1, 2, task=TASK._replace(next_goal="alone"), goals=2)
    world = batch.world(0)
    limit(batch.worlds)
    goals = np.array([[[0.0, 0, 0], [50, 0, 0]], [[500.0, 0, 0], [550, 0, 0]]])
    world.goals[:] = goals
    for agent in range(2):
        aim(batch.worlds, agent, 0, *goals[agent, 0])
    put(batch.worlds, [3.0, 4.0], 0.0, 0.0, agent=0)
    put(batch.worlds, [3.0, 4.0], 490.0, 0.0, agent=1)
    stand(batch)
    assert world.state.waiting.tolist() == [False, False]
    assert world.state.goal[:, PHASE].tolist() == [1, 0]
    assert world.state.goal[:, :2].tolist() == [[50, 0], [500, 0]]
    batch.step(np.ones((2, 1)), np.zeros((2, 1)))
    assert world.state.x.tolist() == pytest.approx([0.2, 490.2])  # no HAV waits
    put(batch.worlds, [3.0, 4.0], 50.0, 0.0, agent=0)
    stand(batch)
    assert world.state.waiting.tolist() == [True, False]  # at its last goal
    assert not batch.ended[0]
    put(batch.worlds, [3.0, 4.0], 500.0, 0.0, agent=1)
    stand(batch)
    assert world.state.goal[:, PHASE].tolist() == [1, 1]
    put(batch.worlds, [3.0, 4.0], 550.0, 0.0, agent=1)
    stand(batch)
    assert world.record.goal[..., HIT_STEP].tolist() == [[1, 3], [4, 5]]
    assert world.record.goal[:, 1, DUBINS].tolist() == [50.0, 50.0]
    assert batch.ended[0]


def test_alone_and_together_are_the_same_for_a_single_hav():
    episodes, steps = np.arange(budget(8, 2)), budget(20_000, 600)
    together, alone = (
        rollout("avoid_jack", "paper-single", 3, episodes, Task(next_goal=how, max_steps=steps))
        for how in ("together", "alone")
    )
    assert together.equals(alone)


@pytest.mark.skipif(not COMPILED, reason="whole episodes of many steps")
def test_alone_the_first_goals_of_a_pair_that_never_meets_stay_the_same():
    """Far apart, each HAV acts as if alone in the world; the text lets the first wait."""
    apart = RandomPoses(num_havs=2, area_factor=400.0)
    together, alone = (
        rollout("avoid_jack", apart, 3, np.arange(12), Task(next_goal=how))
        for how in ("together", "alone")
    )
    met = np.asarray(together["potential_collision"]) | np.asarray(alone["potential_collision"])
    assert met.mean() < 0.5
    kept = ~met
    first = [table["goal_1_step"].fill_null(-1).to_numpy()[kept] for table in (together, alone)]
    np.testing.assert_array_equal(*first)
    second = np.asarray(alone["goal_2_hit"])[kept].sum()
    assert second > np.asarray(together["goal_2_hit"])[kept].sum()


@pytest.mark.parametrize("max_steps", [1, 7, 30])
def test_an_episode_ends_in_time(max_steps):
    task = Task(max_steps=max_steps)
    table = rollout(DubinsPursuit(), RandomPoses(num_havs=2), 1, np.arange(5), task)
    assert set(table["steps"].to_pylist()) == {max_steps}
    batch = Batch(RandomPoses(num_havs=2), 1, task)
    batch.reset(1)
    for step in range(max_steps):
        assert not batch.ended[0], step
        stand(batch)
    assert batch.ended[0]


AHEAD = explicit([[3.0, 4.0]], [[0.0, 0.0, 0.0]], [[[10.0, 0.0, 0.0], [20.0, 0.0, 0.0]]])


def ahead(max_steps=20_000):
    """Drive straight over two goals 10 m apart; return the row of the table."""
    policy, task = AvoidJack(close_factor=3.5), Task(max_steps=max_steps)
    return rollout(policy, AHEAD, 0, np.arange(1), task).to_pylist()[0]


def test_an_episode_ends_at_the_last_goal():
    row = ahead()
    assert (row["goal_1_step"], row["goal_2_step"], row["steps"]) == (48, 98, 98)
    assert row["goal_1_distance"] == pytest.approx(0.4)
    assert row["goal_2_distance"] == pytest.approx(0.4)
    assert row["goal_1_closest"] == row["goal_1_distance"]
    assert row["goal_1_dubins_length"] == pytest.approx(10.0)
    assert row["goal_2_dubins_length"] == pytest.approx(10.4)
    assert row["goal_1_driven_length"] == pytest.approx(9.6)
    assert row["goal_2_driven_length"] == pytest.approx(10.0)


def test_a_goal_given_in_the_last_step_has_no_infinite_approach():
    row = ahead(max_steps=48)
    assert row["goal_1_hit"]
    assert not row["goal_2_hit"]
    closest = row["goal_2_closest"]
    assert closest is None or math.isfinite(closest)


def test_the_record_of_an_approach_follows_from_distances_and_headings():
    """Random approaches, checked step by step; the oracle knows only the definitions."""
    num_worlds, steps, rng = budget(800, 100), 12, np.random.default_rng(6)
    batch = open_plane(num_worlds, task=TASK)
    aim(batch.worlds, ALL, ALL, 3.0, -4.0, 3.0)
    batch.worlds.record.goal[:, :, CLOSEST] = math.inf
    history = [[] for _ in range(num_worlds)]
    for step in range(1, steps + 1):
        for w in range(num_worlds):
            if batch.worlds.state.waiting[0, w]:
                continue
            distance, turn = rng.uniform(0.0, 1.3), rng.uniform(-0.26, 0.26)
            place = 3.0 - 4.0j + distance * np.exp(1j * rng.uniform(0, 7))
            headings = np.r_[3.0 + turn, 3.0 + turn + rng.uniform(-2, 2, 2)]
            put(batch.worlds, [3.0, 4.0, 5.0], place.real, place.imag, headings, w=w)
            history[w].append((step, distance, abs(turn), wrapped(np.diff(headings))))
        stand(batch)
    happened = [0, 0, 0]
    for w, looks in enumerate(history):
        goal, misses = batch.worlds.record.goal[0, 0, :, w], batch.worlds.record.miss[0, 0, :, :, w]
        at = [k for k, (_, d, t, _) in enumerate(looks) if d < 0.5 and t < 0.1]
        assert goal[CLOSEST] == pytest.approx(min(d for _, d, _, _ in looks))
        if at:
            happened[0] += 1
            assert at == [len(looks) - 1]  # then it waits
            step, distance, turn, _ = looks[-1]
            found = goal[[HIT_STEP, HIT_DISTANCE, HIT_HEADING, HIT_PATH]]
            assert found == pytest.approx([step, distance, turn, 0.0])
        else:
            assert goal[HIT_STEP] == -1
            assert np.isnan(goal[[HIT_DISTANCE, HIT_HEADING, HIT_PATH]]).all()
        heading = [(t, d, t, a) for _, d, t, a in looks if d < 0.5 and 0.1 <= t < 0.2]
        euclidean = [(d, d, t, a) for _, d, t, a in looks if t < 0.1 and 0.5 <= d < 1.0]
        for kind, seen in ((HEADING_MISS, heading), (EUCLIDEAN_MISS, euclidean)):
            assert misses[kind, MISS_COUNT] == len(seen)
            if seen:
                happened[kind + 1] += 1
                _, distance, turn, bends = min(seen, key=lambda look: look[0])
                found = misses[kind]
                assert found[[MISS_DISTANCE, MISS_HEADING]] == pytest.approx([distance, turn])
                assert found[MISS_ARTICULATION:][:2] == pytest.approx(bends)
            else:
                assert np.isnan(misses[kind, MISS_DISTANCE:]).all()
    assert min(happened) > 10


def test_the_dubins_length_is_measured_from_where_a_goal_was_assigned():
    batch = Batch(RandomPoses(num_havs=3), 10)
    batch.reset(2)
    for w in range(10):
        world = batch.world(w)
        for agent in range(3):
            x, y, heading = world.goals[agent, 0]
            away = complex(x - world.state.x[agent], y - world.state.y[agent])
            away *= np.exp(-1j * world.state.heading[agent, 0])
            lengths = world.fleet.length[agent, : world.fleet.num_trailers[agent] + 1]
            turn = heading - world.state.heading[agent, 0]
            expected = path_length(away.real, away.imag, turn, np.linalg.norm(lengths))
            assert world.record.goal[agent, 0, DUBINS] == pytest.approx(expected)
        assert world.state.clock[STEP] == 0


@pytest.mark.parametrize("field", ["dt", "distance_tolerance", "heading_tolerance"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_a_bad_rule_is_named(field, value):
    with pytest.raises(ValueError, match=f"{field} is {value}"):
        Batch(RandomPoses(), task=Task()._replace(**{field: value}))


@pytest.mark.parametrize(
    ("field", "value"),
    [("max_steps", 0), ("sensing_range", -1.0), ("sensing_range", math.nan)],
)
def test_a_bad_bound_is_named(field, value):
    with pytest.raises(ValueError, match=f"{field} is {value}"):
        Batch(RandomPoses(), task=Task()._replace(**{field: value}))
