"""What README shows runs as it stands there."""

import pathlib
import re

import pytest

from baselines.__main__ import main

ROOT = pathlib.Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()
BLOCKS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
COMMANDS = re.findall(r"^python -m baselines (.*)$", README, re.MULTILINE)


def test_the_python_example_runs(capsys):
    exec(compile(BLOCKS[0], "README.md", "exec"), {})
    assert capsys.readouterr().out == "(2, 64) 0\n"


@pytest.mark.parametrize("command", COMMANDS)
def test_the_commands_run(command, tmp_path, capsys, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "mine.py").write_text(BLOCKS[1])
    arguments = command.replace("examples/", f"{ROOT}/examples/").split()
    arguments += ["--episodes", "2", "--task.max-steps", "200"]
    assert main(arguments) == 0
    assert "goal 1 hit" in capsys.readouterr().out


def test_the_two_commands_of_the_top_are_those_of_ci():
    command = "python3 -m venv .venv && .venv/bin/pip install -q -e '.[all]' && .venv/bin/python"
    assert f"{command} -m baselines reproduce" in README
    assert f"{command} -m pytest" in README
    assert f"{command} -m pytest" in (ROOT / ".ci/run").read_text()
