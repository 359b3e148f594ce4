"""The recipes in examples/ run unchanged, and end with policies that the evaluator reads."""

import importlib
import sys

import numpy as np
import pytest
import torch

from baselines.policies.files import load_trained
from hav_env import Task, find_scenario
from hav_env.evaluation.rollout import rollout
from tests.support.paths import EXAMPLES

SHORT = Task(max_steps=100)


@pytest.fixture
def recipe(monkeypatch):
    """Import a recipe by its name."""
    monkeypatch.syspath_prepend(EXAMPLES)
    return importlib.import_module


@pytest.mark.parametrize(
    ("name", "scenario", "small"),
    [
        ("ppo_cleanrl", "paper-single", {"worlds": 4, "rollout": 64}),
        ("ppo_torchrl", "paper-pair", {"rollout": 128, "batch": 64}),
    ],
)
def test_a_recipe_trains_and_its_policy_is_evaluated(name, scenario, small, recipe, tmp_path):
    module = recipe(name)
    file = tmp_path / "learned.policy"
    told = module.Arguments(output=file, steps=512, epochs=2, max_steps=200, **small)
    curve = module.train(told)
    trained = load_trained(file)
    table = rollout(trained.policy, find_scenario(scenario), 0, np.arange(2), SHORT)
    assert len(curve) == (2 if name == "ppo_cleanrl" else 4)
    assert np.isfinite(curve).all()
    assert trained.about["steps"] == 512
    assert trained.policy.frame_skip == told.frame_skip
    assert table.num_rows == 2 * find_scenario(scenario).num_havs


def test_advantages_are_sums_within_an_episode(recipe):
    """Compare with the definition: discounted surprises up to the end of the episode."""
    module = recipe("ppo_cleanrl")
    generator = torch.Generator().manual_seed(0)
    rewards, values, after = torch.rand(3, 12, 5, generator=generator)
    terminated = torch.rand(12, 5, generator=generator) < 0.2
    ended = terminated | (torch.rand(12, 5, generator=generator) < 0.2)
    found = module.advantages_of(rewards, values, after, terminated, ended, 0.9, 0.8)
    for w in range(5):
        for t in range(12):
            ends = [k for k in range(t, 12) if ended[k, w]]
            last = ends[0] if ends else 11
            expected = sum(
                (0.9 * 0.8) ** (k - t)
                * (rewards[k, w] + 0.9 * after[k, w] * (not terminated[k, w]) - values[k, w])
                for k in range(t, last + 1)
            )
            assert found[t, w] == pytest.approx(float(expected), rel=1e-5, abs=1e-6)


def test_options_are_those_of_the_command_line(recipe, monkeypatch, capsys):
    module = recipe("ppo_cleanrl")
    monkeypatch.setattr(sys, "argv", ["ppo_cleanrl.py", "--help"])
    with pytest.raises(SystemExit):
        module.tyro.cli(module.Arguments)
    assert "--steps" in capsys.readouterr().out
