"""The examples of docs/sites.md run, and its picture is the command's."""

import json
import re

import numpy as np
import pytest
from PIL import Image

from hav_env.__main__ import main
from hav_env.places import load_site
from hav_env.places.loading import _KNOWN_ENDINGS, _MOST_BYTES
from tests.support.paths import ROOT

TEXT = (ROOT / "docs/sites.md").read_text()


@pytest.mark.exhaustive
def test_the_examples_run(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    for block in re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL):
        exec(compile(block, "sites.md", "exec"), {})
    assert "(0.0, 0.0, 120.0, 80.0)" in capsys.readouterr().out


def test_the_command_draws_the_picture(tmp_path, monkeypatch):
    (command,) = re.findall(r"^hav-env (site .*)$", TEXT, re.MULTILINE)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    assert main(command.split()) == 0
    with Image.open("yard.png") as drawn, Image.open(ROOT / "docs/images/site-yard.png") as shown:
        assert drawn.size == shown.size
        apart = np.abs(np.asarray(drawn, int) - np.asarray(shown, int))
    assert apart.mean() < 1.0  # releases of pygame draw edges and letters a little differently


def test_the_json_is_a_site_and_all_endings_are_named(tmp_path):
    (written,) = re.findall(r"```json\n(.*?)```", TEXT, re.DOTALL)
    (tmp_path / "yard.json").write_text(written)
    assert load_site(tmp_path / "yard.json").num_segments == 4 + 4 + 3 + 1 + 16
    assert "holes" in json.loads(written)["obstacles"][0]
    assert set(re.findall(r"`(\.\w+)`", TEXT)) == set(_KNOWN_ENDINGS)
    assert f"{_MOST_BYTES // 2**20} MiB for a file" in TEXT
