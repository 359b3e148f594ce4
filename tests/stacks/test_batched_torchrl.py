"""The batched environment of TorchRL: specs, the episodes of all environments, partial resets."""

import numpy as np
import pytest
import torch
from tensordict import TensorDict
from torchrl.envs.utils import check_env_specs

from hav_env import Observation, explicit, parallel_env
from hav_env.envs.gymnasium_vector import HAVSwarmVectorEnv
from hav_env.envs.torchrl import TorchRLEnv

WORLDS = 3
SHORT = {"max_steps": 6, "on_jackknife": "end", "on_collision": "end"}
LEAVING = {
    "scenario": explicit(
        [[3.0, 4.0]] * 2, [[0, 0, 0], [0, 30, 0]], [[[2.0, 0, 0]], [[3.0, 30, 0]]]
    ),
    "distance_tolerance": 1.5,
    "heading_tolerance": 4.0,
    "on_goal": "remove",
    "max_steps": 20,
}


@pytest.mark.parametrize("state", [False, True])
@pytest.mark.parametrize(
    "settings",
    [{}, {"num_havs": 3}, {"frame_skip": 2}, SHORT, LEAVING],
    ids=str,
)
def test_specs_hold(settings, state):
    env = TorchRLEnv(WORLDS, state, 0, **settings)
    check_env_specs(env)
    data = env.rollout(8, break_when_any_done=False)
    havs = WORLDS, 8, env.process.num_havs
    assert data.batch_size == (WORLDS, 8)
    assert data["agents"].batch_size == havs
    assert data["agents", "observation"].shape == (*havs, len(env.columns))
    assert data["agents", "action"].shape == (*havs, 2)
    assert data["next", "agents", "reward"].shape == (*havs, 1)
    assert data["next", "done"].shape == (WORLDS, 8, 1)
    keys = [("agents", "observation"), "state"] if state else [("agents", "observation")]
    assert (data.get("state", None) is not None) is state
    for key in keys:
        for number in range(8):
            assert env.observation_spec[key].is_in(data["next"][key][:, number])


@pytest.mark.parametrize("settings", [SHORT, {"max_steps": 7, "frame_skip": 2}, LEAVING], ids=str)
def test_the_episodes_are_those_of_the_vector_environment_to_the_bit(settings):
    """Worlds begin anew as soon as their episodes end."""
    env, other = TorchRLEnv(WORLDS, **settings), HAVSwarmVectorEnv(
        WORLDS, "Disabled", **settings
    )  # fmt: skip
    env.set_seed(11)
    ours, (seen, _) = env.reset(), other.reset(seed=11)
    rng = np.random.default_rng(0)
    ended = 0
    for _ in range(25):
        assert ours["agents", "observation"].numpy().tobytes() == seen.tobytes()
        actions = rng.uniform(-1.5, 1.5, (WORLDS, env.process.num_havs, 2)).astype(np.float32)
        ours["agents", "action"] = torch.from_numpy(actions)
        step, ours = env.step_and_maybe_reset(ours)
        seen, rewards, terminated, truncated, _ = other.step(actions)
        assert step["next", "agents", "observation"].numpy().tobytes() == seen.tobytes()
        reward = step["next", "agents", "reward"].numpy().astype(float).mean((1, 2))
        assert reward == pytest.approx(rewards, rel=1e-5, abs=1e-6)
        assert step["next", "terminated"].flatten().tolist() == terminated.tolist()
        assert step["next", "truncated"].flatten().tolist() == truncated.tolist()
        over = terminated | truncated
        assert step["next", "done"].flatten().tolist() == over.tolist()
        ended += over.sum()
        if over.any():
            seen, _ = other.reset(options={"reset_mask": over})
    assert ended >= WORLDS


def test_the_first_reset_begins_all_worlds():
    env = TorchRLEnv(WORLDS, seed=0)
    chosen = torch.tensor([[True], [False], [True]])
    with pytest.raises(ValueError, match="_reset is false for world 1, but must be true"):
        env.reset(TensorDict({"_reset": chosen}, batch_size=[WORLDS]))


def test_what_was_handed_out_stays_as_it_is():
    env = TorchRLEnv(WORLDS, True, 0, max_steps=3)
    data = env.reset()
    kept = []
    for _ in range(8):
        data["agents", "action"] = torch.zeros(WORLDS, 2, 2)
        step, data = env.step_and_maybe_reset(data)
        for one in (step["next"], data):
            for key in ("state", ("agents", "observation"), "done"):
                kept.append((one[key], one[key].clone()))
    assert all(torch.equal(one, copy) for one, copy in kept)


def test_a_reset_of_some_worlds_leaves_the_others():
    env = TorchRLEnv(WORLDS, True, 5)
    before = env.reset()
    before["agents", "action"] = torch.ones(WORLDS, 2, 2)
    moved = env.step(before)["next"]
    mask = torch.tensor([[False], [True], [False]])
    after = env.reset(moved.clone().set("_reset", mask))
    for key in ("state", ("agents", "observation")):
        same = (after[key] == moved[key]).flatten(1).all(1)
        assert same.tolist() == [True, False, True]
    again = TorchRLEnv(1, True, 6).reset()
    assert not torch.equal(after["state"][1], again["state"][0])  # the next episode of its seed
    assert torch.equal(before["state"][1], again["state"][0])  # world w has seed 5 + w


def test_the_state_is_that_of_the_swarm():
    env, swarm = TorchRLEnv(1, True, 4, num_havs=3), parallel_env(num_havs=3)
    swarm.reset(seed=4)
    data = env.reset()
    actions = np.full((1, 3, 2), 0.5, np.float32)
    for _ in range(5):
        assert data["state"][0].numpy().tobytes() == swarm.state().tobytes()
        data["agents", "action"] = torch.from_numpy(actions)
        data = env.step(data)["next"]
        swarm.step(dict(zip(swarm.agents, actions[0], strict=True)))


def test_columns_are_in_the_order_of_the_observation():
    env = TorchRLEnv(2, observation=Observation(neighbors=1, fronts=True))
    assert len(env.columns) == env.observation_spec["agents", "observation"].shape[-1]
    assert list(env.group_map) == ["agents"]
    assert env.group_map["agents"] == ["hav_0", "hav_1"]


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: TorchRLEnv(0), "num_worlds is 0"),
        (lambda: TorchRLEnv(2, state=1), "state is 1"),
        (lambda: TorchRLEnv(2, seed=-1), "seed"),
        (lambda: TorchRLEnv(2, seed=2**32 - 1), "must be at most 4294967294"),
        (lambda: TorchRLEnv(2, scenario="moon"), "unknown scenario 'moon'"),
        (lambda: TorchRLEnv(2, speed=3), "speed"),
    ],
)
def test_what_is_wrong_is_named(make, told):
    with pytest.raises((TypeError, ValueError), match=told):
        make()


def test_an_action_that_is_no_number_is_named():
    env = TorchRLEnv(2)
    data = env.reset()
    data["agents", "action"] = torch.full((2, 2, 2), torch.nan)
    with pytest.raises(ValueError, match="action"):
        env.step(data)
