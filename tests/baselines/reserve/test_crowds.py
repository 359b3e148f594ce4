"""In any crowd, Reserve considers the nearest HAVs, and knows the radius that they cover."""

import numpy as np
import pytest

from baselines.policies.reserve import Reserve
from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory.random_numbers import NOISE, PLACES, PLANS, random_key
from hav_env import RandomFleet, RandomPoses, Task, explicit
from hav_env.evaluation.rollout import rollout
from tests.support.audit import drive
from tests.support.budgets import budget

SMALL = RandomFleet(
    min_trailers=1, max_trailers=1, max_length=4.0, short_truck_mean=3.0, long_truck_mean=3.5
)


def grid(side, gap):
    """Return a scenario: HAVs of 8 m in rows and columns, whose goals are such a grid elsewhere."""
    numbers = range(side * side)
    start = [[gap * (k % side), gap * (k // side), 0.0] for k in numbers]
    goals = [[[x + 300.0, y, 0.0]] for x, y, _ in start]
    return explicit([[4.0, 4.0]] * len(start), start, goals)


def arrived(scenario, seed, episodes=1, **rules):
    task = Task(max_steps=budget(20_000, 3), **rules)
    table = rollout(Reserve(), scenario, seed, np.arange(episodes), task).to_pydict()
    assert not any(table["jackknifed"])
    assert not any(table["actual_collision"])
    return np.mean(table["goal_1_hit"])


@pytest.mark.exhaustive
@pytest.mark.parametrize("sensing_range", [30.0, 200.0, 500.0])
def test_more_sensing_is_never_worse(sensing_range):
    """With 200 m 44 % of fifty arrived within 4,000 steps, and with 500 m no HAV set off."""
    scenario = RandomPoses(num_havs=budget(50, 3), num_goals=1)
    assert arrived(scenario, 7950000, sensing_range=sensing_range) >= budget(0.99, 0.0)


@pytest.mark.exhaustive
@pytest.mark.parametrize(
    ("scenario", "share"),
    [(grid(budget(6, 2), 12.0), 0.99), (grid(budget(10, 3), 12.0), 0.9)],
)
def test_crowds_disperse(scenario, share):
    assert arrived(scenario, 7950000) >= budget(share, 0.0)


@pytest.mark.exhaustive
def test_short_havs_close_together_disperse():
    """HAVs that stay at their only goal may bar the way to others: 99 % of 2,000 arrived."""
    scenario = RandomPoses(num_havs=budget(50, 5), num_goals=1, fleet=SMALL)
    assert arrived(scenario, 7950000, episodes=budget(8, 1)) >= budget(0.97, 0.0)


def test_in_a_dense_grid_everybody_sets_off_and_nobody_collides():
    side = budget(10, 3)
    audit = drive(grid(side, 9.0), 1, [0], budget(2500, 4))
    audit.approve()
    worlds, gap = audit.worlds, np.arange(side) * 9.0
    moved = np.abs(worlds.state.x[:, 0] - np.tile(gap, side)) > 1.0
    assert budget(moved.mean(), 1.0) > 0.95


def test_streams_of_random_numbers_do_not_overlap():
    """They did with more than 106 neighbours, whose noise ran into the draws of the next step."""
    rows, seen = np.zeros(m.ROWS), set()
    for number in range(40):
        for step in range(4):
            rows[m.OWN_NUMBER], rows[m.OWN_RANDOM_KEY + 2] = number, step
            for purpose, draws in ((PLANS, 11), (PLACES, 192), (NOISE, 3 * 1_000)):
                _, _, stream, first = random_key(rows, purpose, draws)
                assert stream > 0  # the scenario's
                mine = {(stream, first), (stream, first + draws - 1)}
                assert not seen & mine
                seen |= mine
