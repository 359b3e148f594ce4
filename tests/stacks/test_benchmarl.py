"""BenchMARL trains on the task, and the trained network becomes a policy file."""

import importlib

import numpy as np
import pytest
import torch

from baselines.policies.files import load_trained
from hav_env import Task, find_scenario
from hav_env.envs.benchmarl import HAVTask
from hav_env.evaluation.rollout import rollout
from tests.support.networks import actions_of
from tests.support.paths import EXAMPLES


@pytest.fixture
def recipe(monkeypatch):
    """Import the recipe."""
    monkeypatch.syspath_prepend(EXAMPLES)
    return importlib.import_module("ppo_benchmarl")


@pytest.mark.parametrize("algorithm", ["ippo", "mappo"])
def test_the_recipe_trains_and_its_policy_is_evaluated(algorithm, recipe, tmp_path):
    file = tmp_path / "learned.policy"
    told = recipe.Arguments(
        output=file, algorithm=algorithm, frames=512, worlds=4, rollout=32, batch=64, epochs=2,
        max_steps=200,
    )  # fmt: skip
    curve = recipe.train(told)
    trained = load_trained(file)
    table = rollout(
        trained.policy, find_scenario("paper-pair"), 0, np.arange(2), Task(max_steps=100)
    )
    assert len(curve) == 4
    assert np.isfinite(curve).all()
    assert trained.about["frames"] == 512
    assert trained.about["algorithm"].startswith(algorithm.upper())
    assert trained.policy.frame_skip == 5
    assert table.num_rows == 4


def test_the_policy_file_acts_as_the_means_of_the_actor(recipe, tmp_path, monkeypatch):
    from tensordict.nn import set_interaction_type
    from torchrl.envs.utils import ExplorationType

    actors = []
    whole = recipe.mean_layers
    monkeypatch.setattr(recipe, "mean_layers", lambda actor: actors.append(actor) or whole(actor))
    file = tmp_path / "learned.policy"
    recipe.train(
        recipe.Arguments(output=file, frames=256, worlds=2, rollout=64, batch=64, epochs=3)
    )
    env = HAVTask.PAPER_PAIR.get_task({"max_steps": 50}).get_env_fun(5, True, 3, "cpu")()
    with torch.no_grad(), set_interaction_type(ExplorationType.DETERMINISTIC):
        data = env.rollout(6, actors[0])
    rows = data["agents", "observation"].flatten(0, 2).numpy()
    told = data["agents", "action"].flatten(0, 2).clamp(-1.0, 1.0).numpy()
    assert np.ptp(told) > 0.0
    assert actions_of(load_trained(file).policy, rows) == pytest.approx(told, abs=1e-5)


@pytest.mark.parametrize("state", [False, True])
def test_a_task_is_a_scenario(state):
    task = HAVTask.CROSSING_8.get_task({"frame_skip": 3, "max_steps": 100, "state": state})
    env = task.get_env_fun(2, True, 0, "cpu")()
    assert env.process.num_havs == 8
    assert task.max_steps(env) == 34
    assert task.observation_spec(env)["agents", "observation"].shape == (8, len(env.columns))
    assert task.action_spec(env)["agents", "action"].shape == (8, 2)
    told = task.state_spec(env)
    assert told is None if not state else told["state"].shape == env.reset()["state"].shape[1:]
    own = HAVTask.CROSSING_8.get_task({"scenario": "paper-single"})
    assert own.get_env_fun(1, True, 0, "cpu")().process.num_havs == 1


def test_every_member_names_a_scenario():
    for member in HAVTask:
        task = member.get_task()
        assert task.get_env_fun(1, True, 0, "cpu")().process.num_havs >= 1
