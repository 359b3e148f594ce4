"""What README shows runs as it stands there."""

import re

import pytest

from baselines.__main__ import main
from tests.support.budgets import COMPILED, budget
from tests.support.paths import ROOT

README = (ROOT / "README.md").read_text()
BLOCKS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
EVALUATE = re.findall(r"^python -m baselines (evaluate .*)$", README, re.MULTILINE)
WATCH = re.findall(r"^python -m baselines (watch .*)$", README, re.MULTILINE)


@pytest.mark.skipif(not COMPILED, reason="a thousand worlds at a time")
def test_the_python_example_runs(capsys):
    exec(compile(BLOCKS[0], "README.md", "exec"), {})
    assert capsys.readouterr().out == "(1024, 2, 68) 8\n"


@pytest.mark.parametrize("command", EVALUATE)
def test_the_commands_to_evaluate_run(command, tmp_path, capsys, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "mine.py").write_text(BLOCKS[1])
    arguments = command.replace("examples/", f"{ROOT}/examples/").split()
    arguments += ["--episodes", "2", "--task.max-steps", str(budget(200, 10))]
    assert main(arguments) == 0
    assert "goal 1 hit" in capsys.readouterr().out


@pytest.mark.skipif(not COMPILED, reason="a hundred episodes")
def test_policies_are_evaluated_from_python(tmp_path, capsys, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "mine.py").write_text(BLOCKS[1])
    exec(compile(BLOCKS[2], "README.md", "exec"), {})
    told = capsys.readouterr().out
    assert told.startswith("|  | avoid_jack | mine:TurnToGoal |\n")
    assert "| goal 2 hit |" in told


def test_the_commands_to_watch_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")  # a window that nobody sees
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    for command in WATCH:
        recorded = command.startswith("watch pair.npz")
        short = [] if recorded else ["--task.max-steps", str(budget(100, 10))]
        assert main([*command.split(), *short]) == 0
    made = {"pair.npz", "pair.html", "pair.gif", "depot.html"}
    assert {path.name for path in tmp_path.iterdir()} == made | {"examples"}


def test_the_two_commands_of_the_top_are_those_of_ci():
    command = "python3 -m venv .venv && .venv/bin/pip install -q -e '.[all]' && .venv/bin/python"
    assert f"{command} -m baselines reproduce" in README
    assert f"{command} -m pytest -n 2\n" in README
    assert f"{command} -m pytest -n 2\n" in (ROOT / ".ci/run").read_text()
