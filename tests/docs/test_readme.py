"""The examples of README and docs/quickstart.md run as printed."""

import contextlib
import io
import math

import pytest

from tests.docs.commands import blocks, commands, run
from tests.support.budgets import COMPILED, budget
from tests.support.paths import ROOT

README = (ROOT / "README.md").read_text()
LOOP, GYMNASIUM, POLICY = blocks("README.md", "python")
SWARM_LOOP, VECTOR, COMPARE = blocks("docs/quickstart.md", "python")
PAGES = "README.md", "docs/quickstart.md"
EVALUATE = [*dict.fromkeys(line for page in PAGES for line in commands(page, "evaluate"))]
WATCH = [line for page in PAGES for line in commands(page, "watch")]
LONG = "reserve", "context", "--safety", "--vehicle"  # in commands whose code compiles long


def is_long(command):
    return any(word in command.split() for word in LONG)


exhaustive = pytest.mark.exhaustive


def printed(block):
    """Return what a block prints."""
    with contextlib.redirect_stdout(io.StringIO()) as out:
        exec(compile(block, "document", "exec"), {})
    return out.getvalue()


def test_readme_is_short_and_its_loops_too():
    assert len(README.splitlines()) <= 150
    assert len(LOOP.splitlines()) <= 12
    assert len([line for line in GYMNASIUM.splitlines() if line]) == 6


def test_the_animation_is_small():
    pictures = list((ROOT / "docs/images").glob("*.gif"))
    assert pictures
    assert all(picture.stat().st_size <= 2_000_000 for picture in pictures)


def test_the_loops_run():
    assert set(eval(printed(LOOP))) == {"hav_0", "hav_1"}
    shape, _, reward = printed(GYMNASIUM).partition(") ")
    assert shape.startswith("(8, ")
    assert math.isfinite(float(reward))
    assert len(eval(printed(SWARM_LOOP))) == 8


@pytest.mark.skipif(not COMPILED, reason="a thousand worlds at a time")
def test_the_vector_example_runs():
    assert printed(VECTOR) == "(1024, 2, 68) 8\n"


@pytest.mark.parametrize(
    "command",
    [pytest.param(line, marks=[exhaustive] if is_long(line) else []) for line in EVALUATE],
)
def test_the_commands_to_evaluate_run(command, tmp_path, capsys, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "mine.py").write_text(POLICY)
    command = command.replace("examples/", f"{ROOT}/examples/")
    assert run(command, "--episodes", "2", "--task.max-steps", str(budget(200, 10))) == 0
    assert "goal 1 hit" in capsys.readouterr().out


@exhaustive
@pytest.mark.skipif(not COMPILED, reason="a hundred episodes")
def test_policies_are_evaluated_from_python():
    table = printed(COMPARE)
    assert table.startswith("|  | avoid_jack | reserve |\n")
    assert "| goal 2 hit |" in table


@pytest.mark.parametrize("lengthy", [False, pytest.param(True, marks=exhaustive)])
def test_the_commands_to_watch_run(lengthy, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")  # an invisible window
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    for command in WATCH:
        if is_long(command) != lengthy:
            continue
        recorded = command.startswith("hav-env watch pair.npz")
        short = [] if recorded else ["--task.max-steps", str(budget(100, 10))]
        assert run(command, *short) == 0
    made = {"crossing.html", "depot.html"} if lengthy else {"pair.npz", "pair.html", "pair.gif"}
    assert {path.name for path in tmp_path.iterdir()} == made | {"examples"}


def test_the_list_names_policies_and_scenarios(capsys):
    assert run("hav-env list") == 0
    listed = capsys.readouterr().out
    assert {"avoid_jack", "reserve", "swarm-20"} <= set(listed.split())


def test_no_other_command_of_readme_goes_untested():
    setup = "python3 -m venv .venv && .venv/bin/pip install -q -e '.[all]' && .venv/bin/python"
    lines = "".join(blocks("README.md", "bash")).splitlines()
    tested = {*EVALUATE, *WATCH, "hav-env list", ". .venv/bin/activate"}
    assert set(lines) - tested == {f"{setup} -m baselines reproduce", f"{setup} -m pytest -n 2"}
    assert f"{setup} -m pytest -n 2\n" in (ROOT / ".ci/run").read_text()
