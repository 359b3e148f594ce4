"""The commands: their output, their resumption, and their messages about bad input."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pyarrow.parquet as pq
import pytest

from baselines.__main__ import main
from baselines.evaluation import runs as results
from baselines.evaluation.runs import Experiments, run_experiments
from baselines.policies.avoid_jack import AvoidJack
from hav_env import RandomPoses, Task
from hav_env.policies.names import POLICIES
from tests.support.budgets import COMPILED, budget
from tests.support.paths import EXAMPLES

STEPS = budget(300, 20)
SHORT = ["--task.max-steps", str(STEPS)]


def run(capsys, *arguments):
    code = main(list(map(str, arguments)))
    captured = capsys.readouterr()
    return code, captured.out, captured.err


@pytest.mark.parametrize(
    "names",
    [("avoid_jack", "random"), pytest.param(POLICIES.names(), marks=pytest.mark.exhaustive)],
    ids=["two", "all"],
)
def test_evaluate_compares_policies_on_the_same_episodes(names, tmp_path, capsys):
    code, out, _ = run(
        capsys, "evaluate", *names, "--scenario", "paper-pair", "--episodes", 4,
        "--output", tmp_path, *SHORT,
    )  # fmt: skip
    assert code == 0
    assert all(name in out for name in names)
    tables = [pq.read_table(tmp_path / f"{name}.parquet") for name in names]
    for column in ("episode", "hav", "truck_length", "start_x", "goal_2_heading"):
        assert all(table[column].equals(tables[0][column]) for table in tables)
    assert "actual collision" in (tmp_path / "table.md").read_text()


def test_parameters_of_policy_and_scenario_are_options(tmp_path, capsys):
    code, _, _ = run(
        capsys, "evaluate", "avoid_jack", "--episodes", 2, "--num-havs", 3, "--policy.beta", 1.2,
        "--output", tmp_path, *SHORT,
    )  # fmt: skip
    described = json.loads((tmp_path / "avoid_jack.json").read_text())
    assert code == 0
    assert pq.read_table(tmp_path / "avoid_jack.parquet").num_rows == 6
    assert described["policy"]["beta"] == 1.2
    assert described["scenario"]["num_havs"] == 3


@pytest.mark.parametrize(
    ("name", "option", "field"),
    [
        ("swarm-10", "--area-factor", "area_factor"),
        ("crossing-8", "--gap", "gap"),
        ("yard-4", "--aisle", "aisle"),
        ("column-5", "--distance", "distance"),
    ],
)
def test_every_drawn_scenario_has_its_own_options(name, option, field, tmp_path, capsys):
    code, _, _ = run(
        capsys, "evaluate", "random", "--scenario", name, "--episodes", 1, "--num-havs", 3,
        option, 55, "--fleet.max-trailers", 2, "--output", tmp_path, "--task.max-steps", 5,
    )  # fmt: skip
    described = json.loads((tmp_path / "random.json").read_text())["scenario"]
    assert code == 0
    assert described["num_havs"] == 3
    assert described[field] == 55.0
    assert described["fleet"]["type"] == "RandomFleet"
    assert described["fleet"]["max_trailers"] == 2
    assert max(pq.read_table(tmp_path / "random.parquet")["num_trailers"].to_pylist()) <= 2


@pytest.mark.exhaustive
def test_a_policy_of_ones_own_is_evaluated_from_its_module(tmp_path, capsys, monkeypatch):
    examples = EXAMPLES
    monkeypatch.syspath_prepend(examples)
    code, out, _ = run(
        capsys, "evaluate", "avoid_jack", "slow_down:SlowDown", "--episodes", 1,
        "--scenario", examples / "two_havs.json", "--output", tmp_path, *SHORT,
    )  # fmt: skip
    assert code == 0
    assert "slow_down:SlowDown" in out
    assert pq.read_table(tmp_path / "slow_down-SlowDown.parquet").num_rows == 2


def test_an_interrupted_run_resumes_and_ends_with_the_same_bytes(tmp_path, monkeypatch):
    monkeypatch.setattr(results, "PART", 6)  # three episodes of two HAVs
    experiments = Experiments(AvoidJack(), RandomPoses(num_havs=2), 8, 5, Task(max_steps=STEPS))
    whole = run_experiments(experiments, tmp_path / "whole", "pair")

    def stop(episodes, steps):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_experiments(experiments, tmp_path / "stopped", "pair", advance=stop)
    assert len(list((tmp_path / "stopped/pair.parts").iterdir())) == 1
    done = []
    resumed = run_experiments(
        experiments, tmp_path / "stopped", "pair", advance=lambda n, steps: done.append(steps)
    )
    assert done[0] == 0  # the first part was not run again
    assert all(steps > 0 for steps in done[1:])
    assert resumed.read_bytes() == whole.read_bytes()
    assert sorted(path.name for path in resumed.parent.iterdir()) == ["pair.json", "pair.parquet"]


def test_a_killed_command_resumes_and_ends_with_the_same_bytes(tmp_path, capsys):
    episodes = budget(20_000, 1_500)

    def command(folder):
        return [
            "evaluate", "random", "--episodes", str(episodes), "--output", str(tmp_path / folder),
            "--task.max-steps", str(budget(50, 3)),
        ]  # fmt: skip

    process = subprocess.Popen(
        [sys.executable, "-m", "baselines", *command("killed")],
        stderr=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
    )
    parts = tmp_path / "killed/random.parts"
    deadline = time.monotonic() + 300
    while not (parts.exists() and list(parts.glob("0*.parquet"))):
        assert process.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert not (tmp_path / "killed/random.parquet").exists()
    assert run(capsys, *command("killed"))[0] == 0
    assert run(capsys, *command("whole"))[0] == 0
    assert not parts.exists()
    killed, whole = (tmp_path / folder / "random.parquet" for folder in ("killed", "whole"))
    assert killed.read_bytes() == whole.read_bytes()


def test_the_number_of_experiments_does_not_change_an_experiment(tmp_path):
    few = Experiments(AvoidJack(), RandomPoses(), 3, 5, Task(max_steps=STEPS))
    more = few._replace(num_episodes=7)
    first = pq.read_table(run_experiments(few, tmp_path / "few", "a"))
    second = pq.read_table(run_experiments(more, tmp_path / "more", "a"))
    assert second.slice(0, 3).equals(first)


def test_a_folder_does_not_mix_runs(tmp_path, capsys):
    arguments = ["evaluate", "random", "--episodes", 2, "--output", tmp_path, *SHORT]
    assert run(capsys, *arguments)[0] == 0
    code, _, err = run(capsys, *arguments, "--seed", 1)
    assert code == 2
    assert "another seed" in err
    assert run(capsys, *arguments, "--seed", 1, "--overwrite")[0] == 0
    # the error comes before anything is discarded
    assert run(capsys, *arguments, "--overwrite", "--threads", 0)[0] == 2
    assert pq.read_table(tmp_path / "random.parquet").num_rows == 2


def test_results_without_a_description_are_not_taken_for_ones_own(tmp_path, capsys):
    arguments = ["evaluate", "random", "--episodes", 2, "--output", tmp_path, *SHORT]
    assert run(capsys, *arguments)[0] == 0
    (tmp_path / "random.json").unlink()
    code, _, err = run(capsys, *arguments)
    assert code == 2
    assert "results without a description" in err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["fly"], "unknown command 'fly'"),
        (["evaluate"], "name the policies"),
        (["evaluate", "nobody"], "unknown policy 'nobody'"),
        (["evaluate", "nowhere:Nobody"], "cannot load policy"),
        (["evaluate", "math:sin"], "is not a policy"),
        (["evaluate", "random", "--speed", "3"], "--speed"),
        (["evaluate", "avoid_jack", "--policy.beta", "nan"], "policy beta is nan"),
        (["evaluate", "avoid_jack", "--policy.beta", "much"], "--policy.beta"),
        (["evaluate", "random", "--num-havs", "0"], "num_havs is 0"),
        (["evaluate", "random", "--fleet.min-length", "-1"], "min_length is -1"),
        (["evaluate", "random", "--episodes", "0"], "episodes is 0"),
        (["evaluate", "random", "--seed", "-1"], "seed is -1"),
        (["evaluate", "random", "--threads", "0"], "threads is 0"),
        (["evaluate", "random", "--task.dt", "0"], "task dt is 0"),
        (["evaluate", "random", "--vehicle.substeps", "0"], "vehicle substeps is 0"),
        (["evaluate", "random", "--policy.hold", "0"], "policy hold is 0"),
        (["evaluate", "avoid_jack", "--policy.beta", "1.6"], "policy beta is 1.6"),
        (["evaluate", "avoid_jack", "--policy.close-factor", "-1"], "close_factor is -1"),
        (["evaluate", "random", "--scenario", "yard-4", "--aisle", "0"], "aisle is 0"),
        (["evaluate", "random", "--scenario", "moon"], "unknown scenario 'moon'"),
        (["evaluate", "random", "--scenario", "none.json"], "no scenario file none.json"),
        (["reproduce", "--policy", "nobody"], "unknown policy 'nobody'"),
        (["reproduce", "--experiments", "0"], "experiments is 0"),
        (["reproduce", "--reading", "nobodys"], "reading is 'nobodys', but must be one of text"),
        (["calibrate", "--experiments", "0"], "experiments is 0"),
        (["calibrate", "--search", "--seed", str(2**32 - 1)], f"seed is {2**32 + 2}"),
    ],
)
def test_bad_input_is_one_line_and_an_exit_code(arguments, message, tmp_path, capsys):
    code, _, err = run(capsys, *arguments, *(["--output", tmp_path] if len(arguments) > 1 else []))
    said = [line for line in err.splitlines() if line.startswith("error: ")]
    assert code == 2
    assert len(said) == 1
    assert message in said[0]
    assert not list(tmp_path.glob("*.parquet"))


@pytest.mark.parametrize("command", [["reproduce"], ["calibrate"], ["calibrate", "--search"]])
def test_what_is_kept_needs_a_folder(command, capsys):
    code, _, err = run(capsys, *command, "--output", "None")
    assert code == 2
    assert err.splitlines()[-1] == "error: output is None, but must be a folder"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('{"havs": [', "is not a JSON file"),
        ("[" * 100_000, "is not a JSON file"),
        ("[]", "scenario is [], but must be an object"),
        ('{"havs": [{"lengths": [4, 8], "start": [0, 0, 0]}]}', "no entry 'goals'"),
        ('{"havs": [{"lengths": ["4", 8], "start": [0, 0, 0], "goals": [[9, 0, 0]]}]}', "lengths"),
        ('{"havs": [{"lengths": [4, 8], "start": [0, 0, NaN], "goals": [[9, 0, 0]]}]}', "finite"),
        ('{"havs": [{"lengths": [4, 8], "start": [1e999, 0, 0], "goals": [[9, 0, 0]]}]}', "finite"),
        (
            '{"havs": [{"lengths": [4, 8], "start": [%s, 0, 0], "goals": [[9, 0, 0]]}]}' % 10**400,
            "start",
        ),
        ('{"havs": [{"lengths": [4, -8], "start": [0, 0, 0], "goals": [[9, 0, 0]]}]}', "lengths"),
    ],
)
def test_a_broken_scenario_file_is_named(text, message, tmp_path, capsys):
    path = tmp_path / "broken.json"
    path.write_text(text)
    code, _, err = run(capsys, "evaluate", "random", "--scenario", path, "--output", tmp_path / "o")
    assert code == 2
    assert str(path) in err
    assert message in err


def test_an_unwritable_folder_is_named(tmp_path, capsys):
    (tmp_path / "file").write_text("in the way")
    output = tmp_path / "file/results"
    code, _, err = run(capsys, "evaluate", "random", "--episodes", 1, "--output", output)
    assert code == 2
    assert "file" in err.splitlines()[-1]


# whole episodes take minutes without compilation
SHORT_EPISODES = [] if COMPILED else ["--task.max-steps", 10]


def test_reproduce_writes_tables_report_and_figures_twice_the_same(tmp_path, capsys):
    folders = [tmp_path / name for name in ("one", "two")]
    for folder, threads in zip(folders, (1, 2), strict=True):
        code, out, _ = run(
            capsys, "reproduce", "--experiments", budget(6, 2), "--seed", 3, "--output", folder,
            "--threads", threads, *SHORT_EPISODES,
        )  # fmt: skip
        assert code == 0
        assert "86.76 %" in out  # the paper's
    names = sorted(path.name for path in folders[0].iterdir())
    assert {"single.parquet", "pair.parquet", "report.md"} <= set(names)
    assert {"goals_pair.png", "goals_pair.svg", "jackknife_weight.png"} <= set(names)
    assert any(name.startswith("trajectory_") for name in names)
    for name in names:
        assert (folders[0] / name).read_bytes() == (folders[1] / name).read_bytes(), name


def test_defaults_are_the_papers():
    assert np.isclose(np.degrees(AvoidJack().beta), 75)


def test_tables_come_where_figures_cannot(tmp_path, capsys, monkeypatch):
    for name in [name for name in sys.modules if name.startswith("baselines.figures")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    code, out, err = run(
        capsys, "reproduce", "--experiments", 1, "--output", tmp_path, "--task.max-steps", 10
    )
    assert code == 0
    assert "86.76 %" in out
    assert "they need matplotlib: run pip install -e '.[plots]' in the clone" in err
    assert "## Figures" not in (tmp_path / "report.md").read_text()
