"""Scenarios, vehicles and rewards go by name in every environment."""

import numpy as np
import pytest

from hav_env import OnAxle, RandomPoses, Reward, parallel_env
from hav_env.compiled import canonical
from hav_env.mdp.decision_process import DecisionProcess


@pytest.mark.parametrize("vehicle", ["on_axle", "hav_env.vehicles:OnAxle", OnAxle()], ids=str)
@pytest.mark.parametrize("reward", ["default", "hav_env.mdp.reward:Reward", Reward()], ids=str)
def test_a_name_is_the_model(vehicle, reward):
    scenario = "hav_env.scenarios:RandomPoses"
    process = DecisionProcess(1, scenario=scenario, vehicle=vehicle, reward=reward)
    assert process.batch.vehicle == canonical(OnAxle())
    assert process.batch.scenario == RandomPoses()
    process.set_reward(Reward(goal=3.0))


def test_a_named_reward_is_given():
    given = [
        parallel_env(num_havs=2, reward=reward, vehicle="on_axle")
        for reward in ("default", Reward())
    ]
    for env in given:
        env.reset(seed=1)
    told = [env.step(dict.fromkeys(env.agents, np.ones(2))) for env in given]
    assert told[0][1] == told[1][1]
