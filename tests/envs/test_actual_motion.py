"""Where actuators are limited, environments report the executed commands beside them."""

import gymnasium as gym
import numpy as np
import pytest

from hav_env import Limited, OnAxle, RandomFleet, RandomPoses, parallel_env
from hav_env.envs.wrappers import PhysicalActions, PhysicalParallelActions

FAST = RandomPoses(num_havs=2, fleet=RandomFleet(speed_max=5.0))


def test_physical_actions_tell_what_trucks_made_of_them():
    env = PhysicalActions(gym.make("hav_env:HAVSwarm-v0", scenario=FAST, vehicle="limited"))
    env.reset(seed=1)
    assert env.actual.tolist() == [[0.0, 0.0], [0.0, 0.0]]
    for step in range(1, 4):
        env.step(np.array([[4.0, 0.25], [0.5, -0.05]]))
        # 1 m/s^2 and 0.5 rad/s in steps of 0.2 s
        told = [[0.2 * step, min(0.1 * step, 0.25)], [min(0.2 * step, 0.5), -0.05]]
        assert env.actual == pytest.approx(np.array(told), abs=1e-6)


def test_the_parallel_ones_do_too_and_instant_trucks_do_as_they_are_told():
    for vehicle, speed in ((OnAxle(), 4.0), (OnAxle(actuators=Limited(acceleration=5.0)), 1.0)):
        env = PhysicalParallelActions(parallel_env(scenario=FAST, vehicle=vehicle))
        env.reset(seed=1)
        env.step({agent: np.array([4.0, 0.02]) for agent in env.agents})
        assert env.actual == pytest.approx(np.array([[speed, 0.02]] * 2), abs=1e-6)


@pytest.mark.parametrize(("vehicle", "lags"), [("on_axle", False), ("limited", True)])
def test_a_line_of_text_says_what_is_driven_of_what_was_commanded(vehicle, lags):
    env = gym.make("hav_env:HAVSwarm-v0", scenario=FAST, vehicle=vehicle, render_mode="ansi")
    env.reset(seed=1)
    assert "drives" not in env.render()
    env.step(np.array([[0.6, 0.0], [-1.0, 0.0]]))
    assert ("drives 0.2 of 4.0 m/s, 0 of 0 deg" in env.render()) == lags
    assert env.render().count("drives") == lags  # the other one stands as it should
