"""docs/environments.md names what the environments show, and its examples run."""

import re
import subprocess
import sys

import pytest

from hav_env.mdp.decision_process import DecisionProcess
from hav_env.mdp.reward import Reward
from hav_env.observation.layout import NEIGHBOR, OWN
from hav_env.scenarios.presets import SCENARIOS
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
    # in a process of its own: a reward that is registered here would have all compiled anew
    subprocess.run([sys.executable, "-W", "error", "-c", block], check=True)
