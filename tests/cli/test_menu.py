"""The menu finds commands among entry points, names mistakes, and lists all names of models."""

import importlib.metadata
import os
import subprocess
import sys

import pytest

import hav_env
from hav_env.cli import menu
from hav_env.cli.built_in_names import MEANINGS
from hav_env.cli.list_names import names_of_kind
from hav_env.cli.meanings import meaning_of
from hav_env.cli.menu import find_commands, run_menu
from hav_env.mdp.rewards import REWARDS
from hav_env.policies.names import POLICIES
from hav_env.scenarios.presets import FIELDS, SCENARIOS, SITES
from hav_env.simulator.guiding import GUIDANCES
from hav_env.vehicles import VEHICLES

GROUP = menu.COMMANDS_GROUP


def entry(name, value, group=GROUP):
    return importlib.metadata.EntryPoint(name, value, group)


@pytest.mark.parametrize("words", [[], ["--help"], ["-h"], ["help"]])
def test_the_menu_has_a_line_for_each_command(words, capsys):
    assert run_menu(words) == 0
    told = capsys.readouterr().out
    lines = [line.split() for line in told.splitlines() if line.startswith("  ")]
    assert [line[0] for line in lines] == list(find_commands())
    assert all(len(line) >= 4 for line in lines)
    assert max(map(len, told.splitlines())) <= 80


def test_the_commands_of_the_project_are_there():
    expected = (
        "list evaluate reproduce watch play site survey ablate calibrate train compare compile"
    )
    assert set(find_commands()) >= set(expected.split())


def test_the_version_is_the_package_s(capsys):
    assert run_menu(["--version"]) == 0
    assert capsys.readouterr().out == f"hav_env {hav_env.__version__}\n"


def test_a_misspelt_command_gets_a_suggestion(capsys):
    assert run_menu(["evalute"]) == 2
    told = capsys.readouterr().err
    assert told.startswith("error: unknown command 'evalute' (did you mean 'evaluate'?); known: ")
    assert told.count("\n") == 1


def test_a_command_of_another_package_runs_and_returns_its_code(tmp_path, monkeypatch, capsys):
    (tmp_path / "added.py").write_text(
        'def drive(words):\n    """Drive far. Or not."""\n    print(*words)\n    return 7\n'
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(menu, "find_commands", lambda: {"drive": entry("drive", "added:drive")})
    assert "  drive      Drive far\n" in menu.show_menu()
    assert "added" not in sys.modules
    assert run_menu(["drive", "to", "--goal"]) == 7
    assert capsys.readouterr().out == "to --goal\n"


def test_a_command_without_its_extra_names_the_extra(tmp_path, monkeypatch, capsys):
    (tmp_path / "needy.py").write_text("import torch\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setitem(sys.modules, "torch", None)
    monkeypatch.setattr(menu, "find_commands", lambda: {"learn": entry("learn", "needy:main")})
    assert run_menu(["learn"]) == 2
    told = capsys.readouterr().err
    assert told == (
        "error: hav-env learn needs torch: run pip install -e '.[training]' in the clone\n"
    )


def test_meanings_are_read_from_docstrings_without_an_import(tmp_path, monkeypatch):
    (tmp_path / "far").mkdir()
    (tmp_path / "far/__init__.py").write_text("raise RuntimeError\nfrom far.near import Kept\n")
    (tmp_path / "far/near.py").write_text(
        'class Kept:\n    """Keep 1.5 m away; in\n    all cases. Always."""\n'
        'late: Kept\n"""Come late."""\n'
        "def silent():\n    pass\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    expected = {
        "far:Kept": "Keep 1.5 m away; in all cases",
        "far.near:late": "Come late",
        "far.near:silent": "",
        "far.near:absent": "",
        "far.nowhere:Kept": "",
        "nowhere.at.all:Kept": "",
    }
    for value, meaning in expected.items():
        assert meaning_of(entry("x", value)) == meaning, value


def test_every_built_in_name_is_listed_with_a_meaning():
    theirs = {
        "scenario": SCENARIOS,
        "site": FIELDS | SITES,
        "vehicle": VEHICLES.names(),
        "guidance": GUIDANCES.names(),
        "reward": REWARDS.names(),
    }
    assert {kind: list(names) for kind, names in MEANINGS.items()} == {
        kind: list(names) for kind, names in theirs.items()
    }
    policies = names_of_kind("policies")
    assert list(policies) == POLICIES.names()
    assert all(policies.values())


def test_the_list_fits_a_terminal_and_names_everything(capsys):
    assert run_menu(["list"]) == 0
    told = capsys.readouterr().out
    assert max(map(len, told.splitlines())) <= 80
    names = {line.split()[0] for line in told.splitlines() if line.startswith("  ")}
    assert names >= {*POLICIES.names(), *SCENARIOS, *SITES, *VEHICLES.names()}


def test_one_kind_may_be_listed(capsys):
    assert run_menu(["list", "catalogue"]) == 0
    assert "wb-67 " in capsys.readouterr().out
    assert run_menu(["list", "polices"]) == 2
    assert "did you mean 'policies'?" in capsys.readouterr().err


def test_listing_loads_no_compiler():
    code = (
        "import sys; from hav_env.cli.menu import run_menu; run_menu(['list']);"
        "assert not {'numba', 'pyarrow', 'tyro', 'torch'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.DEVNULL)


@pytest.mark.parametrize("safe", [False, True])
def test_a_script_finds_modules_of_the_current_folder_unless_forbidden(safe, tmp_path):
    script = tmp_path / "bin/hav-env"
    script.parent.mkdir()
    script.write_text("import sys\nfrom hav_env.cli.menu import run_menu\nsys.exit(run_menu())\n")
    (tmp_path / "mine.py").write_text("raise ValueError('found mine')\n")
    done = subprocess.run(
        [sys.executable, *(["-P"] if safe else []), str(script), "evaluate", "mine:Policy"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert ("found mine" in done.stderr) is not safe


def test_an_encoding_without_a_character_does_not_lose_a_table():
    code = (
        "from hav_env.cli.errors import report_errors\n"
        "raise SystemExit(report_errors(lambda words: print('R\\u00fcck \\u2500'), []))"
    )
    env = os.environ | {"PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "LC_ALL": "C"}
    env.pop("PYTHONIOENCODING", None)
    done = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, check=False)
    assert (done.returncode, done.stdout.split()) == (0, [b"R?ck", b"?"])
