"""A folder belongs to one training, which continues as it began; invalid trainings are named."""

import json
import os
import pathlib
import platform
import re
import subprocess

import pytest
import torch

import hav_env
from train import ppo, runs
from train.runs import begin_run, read_run, versions

# versions


def test_versions_hold_the_revision_and_the_packages():
    told = versions()
    here = pathlib.Path(__file__).parent
    command = ["git", "-C", str(here), "rev-parse", "HEAD"]
    git = subprocess.run(command, capture_output=True, text=True, check=False)
    head = git.stdout.strip() if git.returncode == 0 else ""
    assert told["revision"].removesuffix("+") == head
    assert told["hav_env"] == hav_env.__version__
    assert told["python"] == platform.python_version()
    assert told["packages"]["torch"] == torch.__version__
    assert {"gymnasium", "numba", "numpy", "stable-baselines3"} <= set(told["packages"])
    assert json.loads(json.dumps(told)) == told


def test_a_package_that_is_not_installed_is_left_out(monkeypatch):
    monkeypatch.setattr(runs, "_PACKAGES", ("numpy", "no-such-package"))
    assert list(versions()["packages"]) == ["numpy"]


@pytest.mark.parametrize("path", ["", "/nowhere"])
def test_without_git_there_is_no_revision(path, monkeypatch):
    monkeypatch.setenv("PATH", path)
    monkeypatch.setattr(runs, "__file__", os.path.abspath(os.sep) + "file.py")
    assert versions()["revision"] == ""


# folders


def test_a_run_is_described_where_it_begins(tmp_path):
    folder = tmp_path / "deep/down/run"
    begin_run(folder, {"seed": 3})
    told = json.loads((folder / "run.json").read_text())
    assert told == {"arguments": {"seed": 3}, **versions()}
    (folder / "checkpoint.pt").touch()
    assert read_run(folder, "checkpoint.pt") == {"seed": 3}
    assert sorted(path.name for path in folder.iterdir()) == ["checkpoint.pt", "run.json"]


def test_an_empty_folder_is_taken_and_another_one_left_as_it_is(tmp_path):
    (tmp_path / "empty").mkdir()
    begin_run(tmp_path / "empty", {})
    (tmp_path / "full").mkdir()
    (tmp_path / "full/.note").write_text("mine")
    (tmp_path / "file").write_text("mine")
    for name in ("full", "file", "empty"):
        before = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*")}
        with pytest.raises(ValueError, match=rf"{name} exists and is not empty: choose another"):
            begin_run(tmp_path / name, {"seed": 1})
        assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*")} == before


def test_what_is_no_run_is_named(tmp_path):
    with pytest.raises(ValueError, match=r"nowhere is no training run: it has no run\.json"):
        read_run(tmp_path / "nowhere", "checkpoint.pt")
    begin_run(tmp_path / "run", {})
    with pytest.raises(ValueError, match=r"run has no checkpoint\.pt yet"):
        read_run(tmp_path / "run", "checkpoint.pt")
    (tmp_path / "run/checkpoint.pt").touch()
    for text in (b"", b"{", b"[]", b"{}", b"3", b"\xff"):
        (tmp_path / "run/run.json").write_bytes(text)
        with pytest.raises(ValueError, match=r"run\.json is broken"):
            read_run(tmp_path / "run", "checkpoint.pt")


# invalid commands


def refused(capsys, *arguments):
    """Return the one line that states the reason; nothing has been trained."""
    code = ppo.main(list(map(str, arguments)))
    said = [line for line in capsys.readouterr().err.splitlines() if line.startswith("error: ")]
    assert code == 2
    assert len(said) == 1
    return said[0]


@pytest.fixture(autouse=True)
def no_training(monkeypatch, tmp_path):
    """A training that begins all the same does so below the test's folder, and fails."""

    def fail(run):
        raise AssertionError("it has begun")

    monkeypatch.setattr(ppo.Run, "learn", fail)
    monkeypatch.chdir(tmp_path)


SMALL = ["--preset", "smoke", "--worlds", "2", "--batch-size", "64", "--layers", "4"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--preset", "giant"], "unknown preset 'giant'; known: single, pair, guided, field,"),
        (["--preset"], "--preset needs a value behind it"),
        (["--speed", "3"], "--speed"),
        (["stray"], "stray"),
        (["--scenario", "moon"], "unknown scenario 'moon'; known: paper-single"),
        (["--scenario", "none.json"], "no scenario file none.json"),
        (["--decisions", "0"], "decisions is 0, but must be at least 1"),
        (["--decisions", "many"], "--decisions"),
        (["--worlds", "0"], "worlds is 0"),
        (["--rollout-decisions", "1"], "rollout_decisions is 1, but must be at least 2"),
        (["--batch-size", "1"], "batch_size is 1, but must be at least 2"),
        (["--epochs", "0"], "epochs is 0"),
        (["--threads", "0"], "threads is 0"),
        (["--evaluate-every", "0"], "evaluate_every is 0"),
        (["--evaluation-episodes", "-1"], "evaluation_episodes is -1"),
        (["--checkpoint-every", "0"], "checkpoint_every is 0"),
        (["--seed", "-1"], "seed is -1"),
        (["--seed", str(2**32)], "seed is 4294967296"),
        (["--learning-rate", "0"], "learning_rate is 0"),
        (["--learning-rate", "nan"], "learning_rate is nan"),
        (["--deviation", "-1"], "deviation is -1"),
        (["--clip-range", "inf"], "clip_range is inf"),
        (["--discount", "1.1"], "discount is 1.1, but must be in (0, 1]"),
        (["--gae-lambda", "nan"], "gae_lambda is nan"),
        (["--entropy", "nan"], "entropy is nan"),
        (["--entropy", "-1"], "entropy is -1"),
        (["--layers"], "layers is ()"),
        (["--layers", "8", "0"], "layers is (8, 0)"),
        (["--frame-skip", "0"], "frame_skip is 0"),
        (["--max-steps", "0"], "max_steps is 0"),
        (["--observation.neighbors", "-1"], "neighbors is -1"),
        (["--reward.goal", "nan"], "reward goal is nan"),
        (["--reward", "smiles"], "unknown reward 'smiles'; known: default"),
        (["--reward", "json:JSONDecoder"], "'json:JSONDecoder' is not a reward"),
        (["--reward"], "--reward needs a value behind it"),
        (["--vehicle=hover"], "unknown vehicle 'hover'; known: on_axle"),
        (["--vehicle.substeps", "0"], "vehicle substeps is 0"),
        (["--curriculum.share", "2"], "curriculum share is 2.0"),
        (["--curriculum.begin", "0.9"], "curriculum end is 0.5, but must be at least its begin"),
    ],
    ids=str,
)
def test_an_argument_that_cannot_be_is_named(arguments, message, tmp_path, capsys):
    assert message in refused(capsys, *SMALL, "--output", "run", *arguments)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("output", ["full", "full/file", "full/file/below"])
def test_a_folder_that_cannot_be_is_named_and_stays_as_it_is(output, tmp_path, capsys):
    (tmp_path / "full").mkdir()
    (tmp_path / "full/file").write_text("mine")
    assert output in refused(capsys, *SMALL, "--output", output)
    assert [path.name for path in tmp_path.rglob("*")] == ["full", "file"]
    assert (tmp_path / "full/file").read_text() == "mine"


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Return the folder of a run up to its first checkpoint."""

    def begin(run):
        run.curve.append({"score": 0.0})
        run.write_checkpoint()

    with monkeypatch.context() as patch:
        patch.setattr(ppo.Run, "learn", begin)
        patch.setattr(ppo, "conclude", lambda *told: {})
        assert ppo.main([*SMALL, "--output", "run"]) == 0
    return tmp_path / "run"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--resume"], "--resume needs a value"),
        (["--resume="], "--resume needs the folder of a run"),
        (["--resume", "nowhere"], "nowhere is no training run"),
        (["--resume", "run", "--seed", "1"], "knows no --seed"),
        (["--threads=2", "--resume=run"], "knows no --threads=2"),
        (["--resume", "run", "--preset", "pair"], "knows no --preset"),
    ],
)
def test_a_run_goes_on_as_it_began_or_not_at_all(arguments, message, run, capsys):
    before = {path: path.read_bytes() for path in run.rglob("*")}
    assert message in refused(capsys, *arguments)
    assert {path: path.read_bytes() for path in run.rglob("*")} == before


def test_a_run_without_a_checkpoint_is_named(run, capsys):
    (run / "checkpoint.pt").unlink()
    assert "run has no checkpoint.pt yet" in refused(capsys, "--resume", run)


def test_a_broken_checkpoint_is_named(run, capsys):
    path = run / "checkpoint.pt"
    whole = path.read_bytes()
    parts = [whole[: len(whole) * k // 8] for k in range(8)]
    for text in (*parts, b"hello", bytes(1_000)):
        path.write_bytes(text)
        assert f"cannot go on from {path}: " in refused(capsys, "--resume", run)
    torch.save({"policy": {}}, path)
    assert f"cannot go on from {path}: " in refused(capsys, "--resume", run)
    path.write_bytes(whole)
    with pytest.raises(AssertionError, match="it has begun"):
        ppo.main(["--resume", str(run)])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"layers": [5]}, "cannot go on from"),
        ({"scenario": "moon"}, "unknown scenario 'moon'"),
        ({"worlds": 0}, "worlds is 0"),
        ({"mood": "good"}, "the run has other arguments than this version: .*mood"),
        ({"reward": {"smiles": 1}}, "the run has other arguments than this version: .*smiles"),
        ({"reward": {"class": "json:JSONDecoder"}}, "other arguments than this .*not a reward"),
        ({"vehicle": {"class": "on_axle", "x": 1}}, "other arguments than this version: .*fields"),
        ({"layers": None}, "the run has other arguments than this version"),
        ({"output": ...}, "the run has other arguments than this version: 'output'"),
    ],
    ids=str,
)
def test_a_run_with_other_arguments_is_named(changes, message, run, capsys):
    told = json.loads((run / "run.json").read_text())
    arguments = told["arguments"] | changes
    kept = {name: value for name, value in arguments.items() if value is not ...}
    (run / "run.json").write_text(json.dumps(told | {"arguments": kept}))
    assert re.search(message, refused(capsys, "--resume", run))
