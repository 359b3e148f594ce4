"""The examples of docs/vehicles.md run, and its page names every vehicle."""

import re
import subprocess
import sys

import pytest

from hav_env.vehicles import COMBINATIONS
from tests.support.paths import ROOT

TEXT = (ROOT / "docs/vehicles.md").read_text()


@pytest.mark.exhaustive
def test_the_examples_run():
    blocks = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)
    assert len(blocks) == 2
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", "\n".join(blocks)],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "EuroCombi" in done.stdout
    assert "25.25" in done.stdout


def test_every_vehicle_is_on_the_page():
    assert set(re.findall(r"^\| `([\w-]+)` \|", TEXT, re.MULTILINE)) == set(COMBINATIONS.names())
