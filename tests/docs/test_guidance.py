"""The examples of docs/guidance.md run and print what the page says."""

import re

import numpy as np
import pytest

from hav_env import make_policy
from tests.support.budgets import COMPARED, COMPILED
from tests.support.paths import ROOT

TEXT = (ROOT / "docs/guidance.md").read_text()
EXAMPLE, FOLLOWER, COUNT = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)


@pytest.mark.skipif(not COMPILED, reason=COMPARED)
def test_the_example_runs(capsys):
    exec(EXAMPLE, {})
    length, turn = capsys.readouterr().out.splitlines()
    assert float(length) == pytest.approx(60.4, abs=0.05)
    side, stays = map(float, re.findall(r"(-?\d+\.\d+)\)?", turn.replace("np.float64", "")))
    assert (side, np.round(stays, 1)) == (0.0, 4.7)


def test_all_connections_of_the_docks_have_a_path(capsys):
    exec(COUNT, {})
    assert capsys.readouterr().out == "[96 96] 96\n"


def test_the_follower_is_a_policy(tmp_path, monkeypatch):
    (tmp_path / "follower.py").write_text(FOLLOWER)
    monkeypatch.syspath_prepend(tmp_path)
    assert make_policy("follower:Follower").speed == 1.5
