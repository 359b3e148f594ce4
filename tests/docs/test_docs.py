"""docs/environments.md names the contents of observations and infos, and its examples run."""

import inspect
import math
import re
import subprocess
import sys

import pytest

import hav_env
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.mdp.reward import Reward
from hav_env.observation.layout import NEIGHBOR, OWN
from hav_env.scenarios.presets import SCENARIOS
from hav_env.world.place.guidance import Dubins
from tests.support.paths import ROOT

TEXT = (ROOT / "docs/environments.md").read_text()
NAMED = set(re.findall(r"`(\w[\w-]*)`", TEXT))
BLOCKS = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)


def test_every_column_term_number_and_scenario_is_named():
    process = DecisionProcess(1)
    numbers = [name for name in process.info if not name.startswith("return_")]
    for names in (OWN, NEIGHBOR, Reward._fields, numbers, SCENARIOS):
        assert set(names) <= NAMED


def test_default_weights_are_those_in_the_table():
    for term, weight in Reward()._asdict().items():
        (found,) = re.findall(rf"^\| `{term}` \|.*\| (\S+) \|$", TEXT, re.MULTILINE)
        assert float(found) == pytest.approx(weight)


@pytest.mark.parametrize("block", BLOCKS)
def test_the_examples_run(block):
    # in a separate process: a reward registered here would cause a new compilation of everything
    subprocess.run([sys.executable, "-W", "error", "-c", block], check=True)


def test_help_of_the_environment_names_every_argument_and_default():
    told = dict(re.findall(r"^ +(\w+): \(default (.+?)\) ", hav_env.parallel_env.__doc__, re.M))
    process = inspect.signature(DecisionProcess).parameters.values()
    made = {p.name: p.default for p in process if p.kind is p.KEYWORD_ONLY}
    own = inspect.signature(hav_env.parallel_env).parameters.values()
    made |= {p.name: p.default for p in own if p.default is not p.empty}
    made |= hav_env.Task()._asdict()
    assert set(told) == set(made)
    models = "Task", "OnAxle", "Observation", "Reward"
    known = {name: getattr(hav_env, name) for name in models}
    known |= {"Dubins": Dubins, "inf": math.inf}
    assert {name: eval(text, known) for name, text in told.items()} == made
