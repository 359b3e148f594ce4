"""TorchRL steps the swarm through its own wrapper."""

import pytest
import torch
from torchrl.envs.libs.pettingzoo import PettingZooWrapper
from torchrl.envs.utils import check_env_specs

from hav_env import Task, explicit, parallel_env

LEAVING = {
    "scenario": explicit(
        [[3.0, 4.0]] * 2, [[0, 0, 0], [0, 30, 0]], [[[2.0, 0, 0]], [[3.0, 30, 0]]]
    ),
    "task": Task(distance_tolerance=1.5, heading_tolerance=4.0),
    "on_goal": "remove",
}


@pytest.mark.parametrize("settings", [{}, {"num_havs": 3}, {"frame_skip": 2}, LEAVING], ids=str)
@pytest.mark.parametrize("return_state", [False, True])
def test_rollouts_have_the_shapes_of_the_swarm(return_state, settings):
    swarm = parallel_env(max_cycles=8, **settings)
    num_havs, columns = len(swarm.possible_agents), len(swarm._world.process.columns)
    env = PettingZooWrapper(swarm, return_state=return_state, use_mask="on_goal" in settings)
    env.set_seed(0)
    check_env_specs(env)
    assert list(env.group_map) == ["hav"]
    data = env.rollout(20)
    assert data["hav", "observation"].shape[1:] == (num_havs, columns)
    assert data["next", "hav", "reward"].shape[1:] == (num_havs, 1)
    assert len(data) <= 8
    assert bool(data["next", "done"][-1])
    if return_state:
        assert data["state"].shape[1:] == swarm.state_space.shape


def test_time_outs_are_told_from_ends():
    env = PettingZooWrapper(parallel_env(max_cycles=5))
    data = env.rollout(9)
    assert len(data) == 5
    assert data["next", "truncated"].flatten().tolist() == [False] * 4 + [True]
    assert not data["next", "terminated"].any()


def test_episodes_follow_each_other():
    env = PettingZooWrapper(parallel_env(max_cycles=5))
    env.set_seed(3)
    data = env.rollout(15, break_when_any_done=False)
    first = data["hav", "observation"][[0, 5, 10]]
    assert len(data) == 15
    assert not torch.equal(first[0], first[1])
    assert not torch.equal(first[1], first[2])
