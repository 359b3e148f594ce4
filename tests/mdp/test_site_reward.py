"""The reward among obstacles is the default one plus the costs of collisions with them."""

import numpy as np
import pytest

from hav_env import Reward, SiteReward, build_site, explicit
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.mdp.rewards import REWARDS

WALL = build_site(lines=[[[10.0, -5.0], [10.0, 5.0]]])


def test_all_but_the_last_terms_are_those_of_the_default_reward():
    default, site = Reward(), SiteReward()
    assert site._asdict().items() > default._asdict().items()
    assert site._fields[: len(default)] == default._fields
    assert isinstance(REWARDS.make("site"), SiteReward)


@pytest.mark.exhaustive
def test_the_first_collision_costs_once_and_nearness_grows():
    scenario = explicit([[4.0, 5.0]], [[0.0, 0.0, 0.0]], [[[90.0, 0.0, 0.0]]], site=WALL)
    reward = SiteReward(*[0.0] * 9, obstacle_collision=-10.0, obstacle_proximity=-1.0)
    process = DecisionProcess(1, scenario=scenario, reward=reward)
    outcome = process.outcome()
    process.begin(np.zeros(1, int), np.zeros(1, int), np.ones(1, np.bool_), outcome)
    rewards = []
    for _ in range(40):
        rewards.append(float(process.step(np.array([[[1.0, 0.0]]])).reward[0, 0]))
    gaps = np.maximum(6.0 - 0.2 * np.arange(1, 41), -4.0)  # of the front axle, until it is past
    near = -0.2 * (1.0 - np.minimum(np.abs(gaps), 5.0) / 5.0) ** 2
    near[29] -= 10.0
    assert np.allclose(rewards, near, atol=1e-6)
    names = process.info
    assert names[-1] == "obstacle_collision"
    assert names.index("return_obstacle_collision") < len(names) - 1
