"""Training on RLlib: it ends with a policy file that acts as RLlib's network does."""

import dataclasses
import json

import numpy as np
import pytest
import torch

from baselines.policies.files import load_trained
from baselines.policies.network import normalize, propagate
from hav_env import RandomPoses, Task
from hav_env.evaluation.rollout import rollout
from tests.stacks.ray_here import ray_here
from train.rllib.arguments import RLLIB_PRESETS
from train.rllib.setup import SHARED, HAVMultiAgentEnv, mean_layers
from train.rllib.training import Run, main
from train.runs import begin_run, plain

SHORT = Task(max_steps=200)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Yield a folder, and Ray."""
    folder = tmp_path_factory.mktemp("rllib")
    with ray_here(folder, cores=2):
        yield folder


@pytest.fixture(scope="module")
def trained(folder):
    """Train the smoke preset on two HAVs."""
    arguments = dataclasses.replace(
        RLLIB_PRESETS["smoke"], scenario="paper-pair", worlds=3, output=folder / "run", seed=3
    )
    run = Run(arguments)
    begin_run(arguments.output, plain(arguments))
    run.first = run.policy()
    run.learn()
    yield run
    run.algorithm.stop()


def forward(network, observations):
    """Return the actions of a Network as the rollout computes them, (B, 2)."""
    lanes = len(observations)
    rows = np.zeros((network.sizes[0] + 2 * network.sizes[1:].max(), lanes))
    rows[: network.sizes[0]] = observations.T
    normalize(network, rows[: network.sizes[0]], lanes)
    first = propagate(network, rows, lanes)
    return rows[first : first + 2].T


def test_the_file_acts_as_the_network_of_rllib(trained):
    space = trained.process.columns
    observations = np.random.default_rng(0).uniform(-1, 1, (40, len(space))).astype(np.float32)
    module = trained.algorithm.get_module(SHARED)
    with torch.no_grad():
        told = module.forward_inference({"obs": torch.from_numpy(observations)})
    deterministic = module.get_inference_action_dist_cls().from_logits(told["action_dist_inputs"])
    expected = deterministic.to_deterministic().sample().numpy()
    kept = load_trained(trained.arguments.output / "last.policy").policy
    assert np.abs(expected).max() > 1e-3
    for network in (trained.policy(), kept):
        assert forward(network, observations) == pytest.approx(expected, abs=1e-5)


def test_of_a_network_that_puts_out_deviations_only_the_means_are_kept():
    class Module:
        encoder = torch.nn.Module()
        pi = torch.nn.Linear(8, 4)

    Module.encoder.actor_encoder = torch.nn.Sequential(torch.nn.Linear(5, 8), torch.nn.Tanh())
    _, last = mean_layers(Module)
    assert torch.equal(last.weight, Module.pi.weight[:2])
    assert torch.equal(last.bias, Module.pi.bias[:2])


def test_a_run_keeps_what_it_came_to(trained):
    folder = trained.arguments.output
    curve = json.loads((folder / "curve.json").read_text())
    best = load_trained(folder / "best.policy")
    assert len(curve) == 2
    assert curve[-1]["decisions"] >= trained.arguments.decisions
    assert best.about["algorithm"] == "PPO (Ray RLlib)"
    assert best.about["arguments"]["scenario"] == "paper-pair"
    assert "ray" in json.loads((folder / "run.json").read_text())["packages"]
    table = rollout(best.policy, RandomPoses(num_havs=2), 0, np.arange(3), SHORT)
    assert table.num_rows == 6


def test_it_learns_until_the_rate_has_fallen_to_nothing(trained):
    learned = trained.policy()
    assert np.abs(learned.weights - trained.first.weights).max() > 1e-4
    trained.algorithm.train()
    assert np.array_equal(trained.policy().weights, learned.weights)


def test_harm_weighs_more_with_time(trained):
    env = trained.algorithm.env_runner_group.local_env_runner.env.unwrapped.envs[0].unwrapped
    weights = trained.arguments.reward
    for progress, share in ((0.0, trained.arguments.curriculum.share), (1.0, 1.0)):
        trained._weigh_harm(progress)
        assert env._swarm._world.process._reward.jackknife == share * weights.jackknife


def test_no_two_worlds_have_the_same_episodes():
    class Config(dict):
        worker_index = 0

    seen = []
    for worker in range(3):
        config = Config(settings={}, worlds=2, reward_scale=1.0)
        config.worker_index = worker
        for index in range(2):  # RLlib gives world i of process r the seed r + i
            env = HAVMultiAgentEnv(config)
            seen.append(env.reset(seed=7 + worker + index)[0]["hav_0"].tobytes())
    assert len(set(seen)) == 6


def test_the_reward_is_scaled_and_an_episode_ends_for_all():
    config = {"settings": {"max_cycles": 2, "num_havs": 2}, "worlds": 1, "reward_scale": 1.0}
    plainly, scaled = (HAVMultiAgentEnv(config | {"reward_scale": by}) for by in (1.0, 0.25))
    ahead = {agent: np.array([1.0, 0.0], np.float32) for agent in plainly.agents}
    for env in (plainly, scaled):
        env.reset(seed=1)
    for step in range(2):
        told, other = plainly.step(ahead), scaled.step(ahead)
        assert told[1]["hav_1"] != 0.0
        assert other[1] == {agent: 0.25 * reward for agent, reward in told[1].items()}
        assert told[2]["__all__"] is False
        assert told[3]["__all__"] is (step == 1)
    assert plainly.agents == []


def test_processes_of_their_own_drive(folder, capsys):
    words = ["--preset", "smoke", "--runners", "1", "--decisions", "1000"]
    code = main([*words, "--output", str(folder / "other")])
    assert code == 0
    assert "best.policy" in capsys.readouterr().out
    assert (folder / "other/best.policy").is_file()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--preset", "none"], "unknown preset 'none'; known: single, pair, smoke"),
        (["--runners", "-1"], "runners is -1, but must be at least 0"),
        (["--reward-scale", "0"], "reward_scale is 0.0, but must be above 0"),
        (["--preset", "smoke", "--batch-size", "513"], "batch_size is 513, but must be at most"),
        (["--address", "here"], "address is 'here', but must be HOST:PORT or auto"),
        (["--address", "127.0.0.1:1"], "no Ray cluster answers at 127.0.0.1:1"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(words, told, tmp_path, capsys):
    assert main([*words, "--output", str(tmp_path / "run")]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert told in error
    assert len(error.splitlines()) == 1
    assert not (tmp_path / "run").exists()
