"""Trainings take custom rewards and vehicles by name, as docs/training.md states."""

import json
import os
import re
import subprocess
import sys
from typing import NamedTuple

import pytest

from hav_env import Limited, OnAxle, Reward
from hav_env.mdp.reward import harm_terms, reward_terms
from hav_env.vehicles import move
from hav_env.vehicles.on_axle import move_on_axle
from tests.support.paths import ROOT
from tests.support.trainings import EVALUATED, words
from train import ppo, scores
from train.curriculum import Curriculum, reward_at
from train.runs import plain, restore

HERE = "tests.train.test_own_models"
# whose evaluations are short
SHORTLY = """
import functools, sys
from tests.support.trainings import EVALUATED
from train import ppo, scores
scores.rollout = functools.partial(scores.rollout, task=EVALUATED)
sys.exit(ppo.main(sys.argv[1:]))
"""


class Arrival(NamedTuple):
    """One for each HAV that arrives; no term stands for harm."""

    arrival: float = 1.0
    late: float = -2.0


class Lame(NamedTuple):
    """Drives like the paper's vehicle."""

    substeps: int = 1
    simultaneous: bool = False


@reward_terms.register(Arrival)
def arrival(reward, duration, world, agent, before, remaining, terms):
    for lane in range(world.lanes):
        terms[0, agent, lane] = 1.0 if world.state.waiting[agent, lane] else 0.0
        terms[1, agent, lane] = duration


move.register(Lame)(move_on_axle)


def test_a_reward_that_names_no_harm_is_not_scaled():
    assert harm_terms(Arrival()) == ()
    assert reward_at(Curriculum(share=0.1), Arrival(), 0.0) == Arrival()


def test_a_reward_may_name_what_is_harm():
    class Late(NamedTuple):
        goal: float = 1.0
        late: float = -2.0

    harm_terms.register(Late, lambda reward: ("late",))
    assert reward_at(Curriculum(share=0.1), Late(), 0.0) == Late(1.0, -0.2)


@pytest.mark.parametrize(
    ("options", "reward", "vehicle"),
    [
        ([], ppo.PPO_PRESETS["smoke"].reward, OnAxle()),
        (["--reward", "default"], Reward(), OnAxle()),
        (["--reward=default", "--reward.goal", "3"], Reward(goal=3.0), OnAxle()),
        (["--reward", f"{HERE}:Arrival", "--reward.late", "-3"], Arrival(late=-3.0), OnAxle()),
        (["--vehicle", f"{HERE}:Lame", "--vehicle.substeps", "2"], None, Lame(2)),
        (["--vehicle", "on_axle", "--vehicle.simultaneous"], None, OnAxle(simultaneous=True)),
        (
            ["--vehicle", "limited", "--vehicle.actuators.braking", "3"],
            None,
            OnAxle(actuators=Limited(braking=3.0)),
        ),
    ],
    ids=str,
)
def test_models_are_options_and_so_are_their_parameters(options, reward, vehicle):
    arguments, _ = ppo.read_arguments(["--preset", "smoke", *options])
    assert arguments.vehicle == vehicle
    assert type(arguments.vehicle) is type(vehicle)
    if reward is not None:
        assert arguments.reward == reward
        assert type(arguments.reward) is type(reward)
    again = restore(ppo.Arguments, json.loads(json.dumps(plain(arguments))))
    assert again == arguments
    assert type(again.reward) is type(arguments.reward)
    assert type(again.vehicle) is type(vehicle)
    if isinstance(vehicle, OnAxle):
        assert type(again.vehicle.actuators) is type(vehicle.actuators)


@pytest.mark.exhaustive
def test_a_training_with_models_of_ones_own_ends_and_goes_on(tmp_path, monkeypatch):
    rollout = scores.rollout
    monkeypatch.setattr(scores, "rollout", lambda *a, **k: rollout(*a, task=EVALUATED, **k))
    options = [*words(tmp_path / "own"), "--reward", f"{HERE}:Arrival"]
    assert ppo.main([*options, "--vehicle", f"{HERE}:Lame"]) == 0
    told = json.loads((tmp_path / "own/run.json").read_text())["arguments"]
    assert told["reward"] == {"class": f"{HERE}:Arrival", "arrival": 1.0, "late": -2.0}
    assert ppo.main(["--resume", str(tmp_path / "own")]) == 0


def test_the_example_of_the_documentation_trains(tmp_path):
    """Its reward is written into a module, as documented, and its command run, but shorter."""
    text = (ROOT / "docs/training.md").read_text()
    (module,) = re.findall(r"```python\n# (?:my_bend_reward\.py)\n(.*?)```", text, re.DOTALL)
    (tmp_path / "my_bend_reward.py").write_text(module)
    (command,) = re.findall(r"^hav-env train (.*--reward my_bend_reward.*)$", text, re.MULTILINE)
    said = command.split("#")[0].split()
    short = words(tmp_path / "run")[2:]
    told = {"PYTHONPATH": f"{tmp_path}:{ROOT}", "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run(
        [sys.executable, "-c", SHORTLY, *said, *short], env=os.environ | told, text=True,
        capture_output=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
