"""The commands take a policy in a file by its name; an unfit policy prints one line."""

import json
import pathlib
import re

import numpy as np
import pyarrow.parquet as pq
import pytest

from baselines.__main__ import main
from baselines.policies.files import save_policy
from tests.support.budgets import budget
from tests.support.networks import doctor, random_network

SHORT = ["--task.max-steps", str(budget(300, 20))]


@pytest.fixture
def path(tmp_path) -> pathlib.Path:
    """Return the file of a policy for a single HAV, which is blind to others."""
    save_policy(random_network(), tmp_path / "chance.policy", {})
    return tmp_path / "chance.policy"


def run(capsys, *arguments):
    code = main(list(map(str, arguments)))
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_evaluate_takes_files_among_names(path, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    save_policy(random_network(1), tmp_path / "other.policy", {})
    common = ["--scenario", "paper-pair", "--episodes", 3, "--output", "results", *SHORT]
    code, out, _ = run(capsys, "evaluate", "random", "chance.policy", "other.policy", *common)
    assert code == 0
    assert "chance.policy" in out
    tables = [f"{name}.parquet" for name in ("random", "chance-policy", "other-policy")]
    assert [pq.read_table(tmp_path / "results" / name).num_rows for name in tables] == [6, 6, 6]
    assert run(capsys, "evaluate", "./chance.policy", *common)[0] == 0
    save_policy(random_network(2), path, {})  # the same name, but another policy
    code, _, err = run(capsys, "evaluate", "chance.policy", *common)
    assert code == 2
    assert "another policy" in err


def test_policies_with_parameters_stand_beside_each_other(tmp_path, capsys):
    common = ["--episodes", 2, "--output", tmp_path / "results", *SHORT]
    code, out, err = run(capsys, "evaluate", "random", "random:hold=2", *common)
    assert code == 0, err
    assert re.search(r"^ +random +random:hold=2$", out, re.MULTILINE)
    told = json.loads((tmp_path / "results/random-hold-2.json").read_text())
    assert told["policy"]["hold"] == 2


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["random", "reserve", "--policy.hold", "5"], "Behind one of several: NAME:hold=VALUE"),
        (["random:hold=2", "--policy.hold=5"], "needs a single policy, by its name alone"),
        (["random", "--gap", "40"], "unknown option --gap: it belongs to --scenario crossing-2"),
        (["random", "--policy.patience", "5"], "it belongs to policy context or reserve"),
        (["random", "--senario", "paper-pair"], "did you mean '--scenario'?"),
        (["random", "--guidance.clearance", "1"], "it belongs to --guidance lattice"),
        (["random", "--vehicle.actuators.braking", "1"], "belongs to --vehicle limited"),
    ],
)
def test_an_option_of_another_model_is_named_with_that_model(words, message, capsys):
    code, _, err = run(capsys, "evaluate", *words)
    assert code == 2
    assert err.count("\n") == 1
    assert message in err


def test_watch_shows_a_file(path, tmp_path, capsys):
    page = tmp_path / "x.html"
    assert run(capsys, "watch", path, "--output", page, *SHORT)[0] == 0
    assert "chance.policy" in page.read_text()


def test_reproduce_takes_a_policy_that_is_blind_to_others(path, tmp_path, capsys):
    # an untrained network hits no goals: episodes would take their full time
    code, out, err = run(
        capsys, "reproduce", "--policy", path, "--experiments", budget(4, 2),
        "--output", tmp_path / "results", "--task.max-steps", budget(2_000, 10),
    )  # fmt: skip
    assert code == 0, err
    assert "86.76 %" in out
    found = {file.name for file in (tmp_path / "results").iterdir()}
    assert {"single.parquet", "pair.parquet", "report.md"} <= found
    report = (tmp_path / "results/report.md").read_text()
    assert "frame_skip=5" in report
    assert max(map(len, report.splitlines())) < 2_000  # it does not list the weights
    assert len(report.splitlines()) < 100


def pair(path):
    save_policy(random_network(neighbors=1), path, {})


def of_short_havs(path):
    save_policy(random_network(max_trailers=3), path, {})


def text(path):
    path.write_text("hello")


@pytest.mark.parametrize(
    ("arguments", "write", "message"),
    [
        (["evaluate", "FILE"], pathlib.Path.unlink, "there is no policy file"),
        (["evaluate", "FILE"], text, "is no policy file, or a broken one"),
        (["evaluate", "FILE"], pair, "trained to observe 1 neighbors"),
        (["evaluate", "FILE"], of_short_havs, "up to 3 trailers"),
        (["evaluate", "random", "FILE"], text, "is no policy file, or a broken one"),
        (["evaluate", "FILE", "--policy.beta", "1"], None, "--policy.beta"),
        (["evaluate", "FILE", "--policy.frame-skip", "1"], None, "--policy.frame-skip"),
        (["evaluate", "FILE", "--policy.limit=1"], None, "--policy.limit"),
        (["watch", "FILE", "--policy.beta", "1"], None, "--policy.beta"),
        (["reproduce", "--policy", "FILE", "--policy.beta", "1"], None, "--policy.beta"),
        (["watch", "FILE"], pathlib.Path.unlink, "there is no policy file"),
        (["watch", "FILE"], pair, "trained to observe 1 neighbors"),
        (["reproduce", "--policy", "FILE"], pathlib.Path.unlink, "there is no policy file"),
        (["reproduce", "--policy", "FILE"], pair, "trained to observe 1 neighbors"),
        (["reproduce", "--policy", "FILE"], text, "is no policy file, or a broken one"),
        (["evaluate", "chance.policies"], None, "FILE.policy"),
        (
            ["evaluate", "nobody"],
            None,
            "known: avoid_jack, context, dubins_pursuit, ppo_beginner, ppo_guided, ppo_pair",
        ),
    ],
)
def test_bad_input_is_one_line_and_an_exit_code(arguments, write, message, path, tmp_path, capsys):
    if write is not None:
        write(path)
    words = [str(path) if word == "FILE" else word for word in arguments]
    output = tmp_path / ("x.html" if words[0] == "watch" else "results")
    code, _, err = run(capsys, *words, "--output", output)
    said = [line for line in err.splitlines() if line.startswith("error: ")]
    assert code == 2
    assert len(said) == 1
    assert message in said[0]
    assert not list(tmp_path.glob("**/*.parquet"))
    assert not (tmp_path / "x.html").exists()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"sizes": [52, 9, 2]}, "sizes is [52, 9, 2], which does not fit"),
        ({"sizes": [52]}, "sizes is int64 of shape (1,), which does not fit"),
        ({"weights": np.zeros(5, np.float32)}, "weights is float64 of shape (5,), which does not"),
        ({"mean": np.zeros(5)}, "mean is float64 of shape (5,), which does not fit"),
        ({"scale": np.full(56, np.inf)}, "policy scale"),
        ({"weights": np.full(474, np.nan)}, "policy weights"),
        ({"frame_skip": 0}, "frame_skip is 0"),
    ],
    ids=["a unit more", "no layer", "few weights", "few means", "infinite", "nan", "no step"],
)
def test_contents_that_do_not_fit_together_are_named(changes, message, path, capsys):
    doctor(path, **changes)
    code, _, err = run(capsys, "evaluate", path, "--episodes", 1, *SHORT)
    assert code == 2
    assert len([line for line in err.splitlines() if line.startswith("error: ")]) == 1
    assert message in err
