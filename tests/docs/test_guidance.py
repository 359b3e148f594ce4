"""The example of docs/guidance.md runs and prints what the page says."""

import re

import numpy as np
import pytest

from tests.support.budgets import COMPARED, COMPILED
from tests.support.paths import ROOT

TEXT = (ROOT / "docs/guidance.md").read_text()


@pytest.mark.skipif(not COMPILED, reason=COMPARED)
def test_the_example_runs(capsys, monkeypatch, tmp_path):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "home"))
    (example,) = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)
    exec(example, {})
    length, turn = capsys.readouterr().out.splitlines()
    assert float(length) == pytest.approx(60.4, abs=0.05)
    side, stays = map(float, re.findall(r"(-?\d+\.\d+)\)?", turn.replace("np.float64", "")))
    assert (side, np.round(stays, 1)) == (0.0, 4.7)
