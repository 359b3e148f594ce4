"""A set of seeds is as many runs, each the same as alone, and resumes where it stopped."""

import functools
import json

import pytest

from baselines.policies.files import load_policy
from hav_env.evaluation.rollout import rollout
from tests.support.trainings import EVALUATED, train, words
from train import ppo, scores
from train.sb3.callback import TrainingCallback


@pytest.fixture(autouse=True)
def short_evaluations(monkeypatch):
    monkeypatch.setattr(scores, "rollout", functools.partial(rollout, task=EVALUATED))


def weights_of(folder):
    return {name: load_policy(folder / name).weights.tobytes() for name in NAMES}


NAMES = ("best.policy", "last.policy")
SMALL = {"decisions": 384, "evaluate-every": 128, "checkpoint-every": 128}


def set_of(folder, *seeds):
    return [*words(folder, **SMALL), "--seeds", *map(str, seeds)]


class KilledError(Exception):
    """An error that no code expects."""


@pytest.mark.parametrize("moment", [100, 300], ids=["before its checkpoint", "after it"])
def test_a_set_that_was_killed_ends_with_the_policies_of_single_runs(moment, tmp_path, monkeypatch):
    """It is killed in the second run, before or after that has its first checkpoint."""
    step = TrainingCallback._on_step

    def stopping(callback):
        if callback.run.arguments.seed == 5 and callback.num_timesteps > moment:
            raise KilledError
        return step(callback)

    folder = tmp_path / "set"
    with monkeypatch.context() as patch:
        patch.setattr(TrainingCallback, "_on_step", stopping)
        with pytest.raises(KilledError):
            ppo.main(set_of(folder, 3, 5))
    first = {path: path.stat().st_mtime_ns for path in (folder / "seed-3").glob("c*")}
    assert not (folder / "seed-5/last.policy").exists() or moment > 128
    folder = folder.rename(tmp_path / "moved")
    assert ppo.main(["--resume", str(folder)]) == 0
    moved = {path: path.stat().st_mtime_ns for path in (folder / "seed-3").glob("c*")}
    assert list(moved.values()) == list(first.values())  # finished runs were not trained again
    assert weights_of(folder / "seed-5") == weights_of(train(tmp_path / "5", seed=5, **SMALL))
    assert weights_of(folder / "seed-3") != weights_of(folder / "seed-5")
    told = json.loads((folder / "run.json").read_text())["arguments"]
    assert told["seeds"] == [3, 5]
    assert "seed" not in told
    assert sorted(path.name for path in folder.iterdir()) == ["run.json", "seed-3", "seed-5"]


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (["--seeds", "0"], "seeds is 0, but must be two different ones or more, see --seed"),
        (["--seeds"], "seeds is empty, but must be two different ones or more"),
        (["--seeds", "1", "2", "1"], "seeds is 1 2 1, but must be two different ones or more"),
        (["--seeds", "0", "-1"], "seeds is -1"),
        (["--seeds", "0", str(2**32)], "seeds is 4294967296"),
        (["--seeds", "0", "one"], "seeds is 0 one, but must be whole numbers"),
        (["--seeds", "0", "1", "--seed", "2"], "--seed is of one run and --seeds of several"),
        (["--resume", "run", "--seeds", "0", "1"], "knows no --seeds"),
        (["--seeds", "0", "1", "--layers"], "layers is ()"),
    ],
    ids=str,
)
def test_seeds_that_cannot_be_are_named(more, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert ppo.main(["--preset", "smoke", "--output", "set", *more]) == 2
    (said,) = [line for line in capsys.readouterr().err.splitlines() if line.startswith("error: ")]
    assert message in said
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("seeds", [3, ["a"], [True, 2], {"0": 1}])
def test_a_broken_set_is_named(seeds, tmp_path, capsys):
    (tmp_path / "run.json").write_text(json.dumps({"arguments": {"seeds": seeds}}))
    assert ppo.main(["--resume", str(tmp_path)]) == 2
    assert "is broken: seeds is" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["run.json"]
