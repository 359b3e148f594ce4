"""A new column needs one edited file, and earlier policies drive as before."""

import os
import shutil
import subprocess
import sys

import pytest

from tests.support.paths import ROOT

DRIVES = """
import numpy as np
from hav_env.mdp.decision_process import DecisionProcess
from hav_env import Batch, find_scenario
from hav_env.policies.driver import PolicyDriver
for name, scenario in (("ppo_single", "paper-single"), ("ppo_pair", "paper-pair")):
    batch = Batch(find_scenario(scenario), 2)
    batch.reset(3)
    driver = PolicyDriver(name, batch)
    for _ in range(12):
        command = driver.decide()
        batch.step(*command)
        print(np.asarray(command).tobytes().hex())
process = DecisionProcess(1, sensing_range=1e5)
outcome = process.outcome()
process.begin(*np.zeros((2, 1), int), np.ones(1, bool), outcome)
seen = dict(zip(process.columns, outcome.observation[0, 0].tolist(), strict=True))
print("new:", [value for name, value in seen.items() if name.endswith("half")])
print({name: value for name, value in seen.items() if not name.endswith("half")})
"""
ADDITIONS = {
    "own.py": {
        '    *place_columns("approach_"),\n': '    Column("half"),\n',
        "        columns[_OWN_AT.waits, lane] = 1.0 if waits(world, agent, lane) else 0.0\n": (
            "        columns[_OWN_AT.half, lane] = 0.5\n"
        ),
    },
    "neighbors.py": {
        '    *place_columns("chain_"),\n': '    Column("half"),\n',
        "            columns[column + _NEIGHBOR_AT.present, lane] = 1.0\n": (
            "            columns[column + _NEIGHBOR_AT.half, lane] = 0.5\n"
        ),
    },
}


def driven(folder):
    """Return the output of the package in a folder."""
    told = os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": str(folder)}
    done = subprocess.run(
        [sys.executable, "-c", DRIVES], env=told, cwd=folder, capture_output=True, text=True,
        check=True,
    )  # fmt: skip
    return done.stdout.splitlines()


@pytest.mark.parametrize("file", ADDITIONS)
def test_a_column_is_added_in_one_file(file, tmp_path):
    for package in ("hav_env", "baselines"):
        shutil.copytree(ROOT / package, tmp_path / package)
    path = tmp_path / "hav_env/observation" / file
    text = path.read_text()
    for line, addition in ADDITIONS[file].items():
        assert text.count(line) == 1
        text = text.replace(line, line + addition)
    before = driven(tmp_path)
    path.write_text(text)
    *same, new, last = driven(tmp_path)
    assert [*same, "new: []", last] == before
    assert new == "new: [0.5]"
