"""The blocks that docs show to extend the project run, each in a process of its own."""

import os
import re
import subprocess
import sys

import pytest

from tests.docs.commands import blocks, commands, run
from tests.support.budgets import COMPILED, budget
from tests.support.paths import ROOT

EXTENDING = blocks("docs/extending.md", "python")
FILES = {found[1]: b for b in EXTENDING if (found := re.match(r"# (\w+\.py)\n", b))}
SCRIPTS = [block for block in EXTENDING if block not in FILES.values()]
OTHERS = [*blocks("docs/policies.md", "python"), *blocks("docs/glossary.md", "python")]
OTHERS += [*blocks("docs/index.md", "python"), *blocks("docs/api/index.md", "python")]
OTHERS += blocks("docs/api/files.md", "python")


@pytest.fixture
def folder(tmp_path):
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    return tmp_path


def execute(block, folder):
    path = os.pathsep.join([str(folder), str(ROOT)])
    done = subprocess.run(
        [sys.executable, "-W", "error::UserWarning", "-c", block],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2_000:]
    assert done.stdout.strip()


def test_each_kind_has_a_block():
    assert set(FILES) == {"my_pursuit.py", "my_ring.py", "my_sand.py", "my_arrival.py"}
    assert len(SCRIPTS) == 6


@pytest.mark.skipif(not COMPILED, reason="whole episodes")
@pytest.mark.exhaustive
@pytest.mark.parametrize("block", SCRIPTS + OTHERS)
def test_the_blocks_run(block, folder):
    execute(block, folder)


POLICIES = "avoid_jack", "reserve"
COMMANDS = [
    *commands("docs/extending.md", "evaluate"),
    *commands("docs/leaderboard.md", "evaluate"),
]


@pytest.mark.exhaustive
@pytest.mark.parametrize("command", COMMANDS)
def test_the_commands_run(command, folder, capsys, monkeypatch):
    monkeypatch.syspath_prepend(folder)
    monkeypatch.chdir(folder)
    assert run(command, "--episodes", "2", "--task.max-steps", str(budget(200, 10))) == 0
    assert "goal 1 hit" in capsys.readouterr().out
    if "--output" in command:
        entry = {path.name for path in (folder / "results/entry").iterdir()}
        named = {f"{name}.{ending}" for name in POLICIES for ending in ("json", "parquet")}
        assert entry >= {"table.md"} | named
