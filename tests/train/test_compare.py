"""Policies beside each other: same episodes, same figures as `evaluate`, files that last."""

import functools

import numpy as np
import pyarrow.parquet as pq
import pytest

from hav_env import Task
from hav_env.evaluation.comparison import compare, read_columns, score, tabulate_scores
from tests.support.budgets import COMPILED, budget
from train import compare as compare_command
from train.compare import main

EPISODES = budget(20, 1)
EASY = Task(max_steps=30, distance_tolerance=1e3, heading_tolerance=4.0)  # goals are hit
WORDS = ["--single", "avoid_jack", "dubins_pursuit", "--pair", "avoid_jack"]


def run(folder, *more):
    words = [*WORDS, "--episodes", EPISODES, "--output", folder, "--shown", 0, *more]
    return main([str(word) for word in words])


def shorten(patch):
    """Whole episodes take minutes without compilation."""
    if not COMPILED:
        for name in ("Experiments", "record_trajectory"):
            whole = getattr(compare_command, name)
            patch.setattr(compare_command, name, functools.partial(whole, task=EASY))


@pytest.fixture(autouse=True)
def short_episodes(monkeypatch):
    shorten(monkeypatch)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return the folder of a finished comparison."""
    folder = tmp_path_factory.mktemp("compare")
    with pytest.MonkeyPatch.context() as patch:
        shorten(patch)
        assert run(folder) == 0
    return folder


def test_the_report_is_what_the_evaluator_says_of_the_tables(folder):
    names = ["avoid_jack", "dubins_pursuit"]
    files = [folder / f"paper-single-{name.replace('_', '-')}.parquet" for name in names]
    tables = [read_columns(path) for path in files]
    report = (folder / "report.md").read_text()
    for row in compare(names, tables):
        assert f"| {' | '.join(row)} |" in report
    kept = pq.read_table(folder / "paper-single-figures.parquet")
    assert kept.equals(tabulate_scores(score(names, tables)))
    first = {row["figure"]: row for row in kept.to_pylist() if row["policy"] == "avoid_jack"}
    hit = tables[0]["goal_1_hit"].to_numpy(zero_copy_only=False)
    assert first["goal 1 hit"]["value"] == pytest.approx(np.mean(hit))
    assert first["goal 1 hit"]["difference_value"] is None


def test_pictures_are_drawn_and_shown(folder):
    report = (folder / "report.md").read_text()
    for scenario in ("paper-single", "paper-pair"):
        for what in ("bars", "episode"):
            assert (folder / f"{scenario}-{what}.png").stat().st_size > 10_000
            assert f"{scenario}-{what}.png" in report


def test_a_second_run_finds_everything_done(folder):
    before = {path: path.read_bytes() for path in folder.glob("*.parquet")}
    assert run(folder) == 0
    assert before == {path: path.read_bytes() for path in folder.glob("*.parquet")}


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--single", "avoid_jak"], "unknown policy 'avoid_jak'"),
        (["--episodes", "0"], "episodes is 0, but must be at least 1"),
        (["--seed", "-1"], "seed"),
        (["--nonsense"], "nonsense"),
        (["--pair", "nowhere.policy"], "there is no policy file nowhere.policy"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(words, told, tmp_path, capsys):
    assert main([*words, "--output", str(tmp_path / "out")]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()[-1:]
    assert line.startswith("error: ")
    assert told in line
    assert not (tmp_path / "out").exists()


def test_other_results_in_the_folder_are_kept(folder, capsys):
    assert run(folder, "--seed", 3) == 2
    assert "has another seed" in capsys.readouterr().err
