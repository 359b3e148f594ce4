"""The commands take the rules and parameters of other readings of the paper."""

import json

import numpy as np
import pyarrow.parquet as pq
import pytest

from baselines.__main__ import main
from baselines.experiments import calibrate
from baselines.experiments.published import PUBLISHED
from baselines.experiments.readings import READINGS
from baselines.policies.avoid_jack import AvoidJack
from hav_env import Task
from hav_env.evaluation.rollout import rollout
from tests.support.budgets import COMPILED, budget

STEPS = budget(300, 20)
COMMON = ["--scenario", "paper-pair", "--episodes", "2", "--task.max-steps", str(STEPS)]
IN_TURN = ["--task.order", "in_turn"]


def run(capsys, *arguments):
    code = main(list(map(str, arguments)))
    captured = capsys.readouterr()
    return code, captured.out, captured.err


OPTIONS = [  # options, rules of the task, parameters of the policy
    (
        [*IN_TURN, "--task.next-goal", "alone", "--task.record-every", 5,
         "--policy.evasion-center", 0.5],
        {"order": "in_turn", "next_goal": "alone", "record_every": 5},
        {"evasion_center": 0.5},
    ),
    (
        ["--task.potential-center", 0.5, "--task.potential-truck-share", 0.25,
         "--policy.evasion-from-center", "--policy.evasion-clipped"],
        {"potential_center": 0.5, "potential_truck_share": 0.25},
        {"evasion_from_center": True, "evasion_clipped": True},
    ),
]  # fmt: skip


@pytest.mark.parametrize(("options", "rules", "parameters"), OPTIONS)
def test_evaluate_runs_other_readings(options, rules, parameters, tmp_path, capsys):
    code, _, err = run(capsys, "evaluate", "avoid_jack", *COMMON, *options, "--output", tmp_path)
    assert code == 0, err
    described = json.loads((tmp_path / "avoid_jack.json").read_text())
    assert described["task"].items() >= rules.items()
    assert described["policy"].items() >= parameters.items()
    table = pq.read_table(tmp_path / "avoid_jack.parquet")
    task, policy = Task(max_steps=STEPS, **rules), AvoidJack(**parameters)
    expected = rollout(policy, "paper-pair", described["seed"], np.arange(2), task)
    assert table.to_pydict() == expected.to_pydict()


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["reserve", *IN_TURN], "order is 'in_turn', but must be 'at_once'"),
        (["avoid_jack", "--task.record-every", 2, "--task.continuous-collisions"], "record_every"),
        (["avoid_jack", "--task.record-every", 0], "record"),
        (["avoid_jack", "--task.potential-center", 1.5], "potential"),
        (["avoid_jack", "--policy.evasion-center", -1], "evasion"),
    ],
)
def test_what_does_not_fit_is_told(options, told, tmp_path, capsys):
    code, _, err = run(capsys, "evaluate", *options, *COMMON, "--output", tmp_path)
    assert code == 2
    assert told in err
    assert "Traceback" not in err
    assert not list(tmp_path.iterdir())


SHORT_EPISODES = [] if COMPILED else ["--task.max-steps", 10]


def test_reproduce_runs_a_reading_by_name(tmp_path, capsys):
    code, out, err = run(
        capsys, "reproduce", "--reading", "published", "--experiments", budget(4, 1), "--seed", 3,
        "--output", tmp_path, "--policy.evasion-center", 0.25, *SHORT_EPISODES,
    )  # fmt: skip
    assert code == 0, err
    assert "reading published with changes" in out
    described = json.loads((tmp_path / "pair.json").read_text())
    assert described["task"]["next_goal"] == "alone"
    assert described["policy"]["evasion_center"] == 0.25
    assert np.isclose(np.degrees(described["scenario"]["fleet"]["steering_max"]), 38)
    report = (tmp_path / "report.md").read_text()
    assert "reading `published with changes`: parameters differ from published" in report
    assert "chi2 of all eight" in report


def test_calibrate_measures_every_row(tmp_path, capsys, monkeypatch):
    rows = READINGS["text"], calibrate.CHOICES[0]
    if not COMPILED:
        rows = tuple(row._replace(task=Task(max_steps=10)) for row in rows)
    monkeypatch.setattr(calibrate, "CALIBRATED", rows)
    code, out, _ = run(capsys, "calibrate", "--experiments", 2, "--output", tmp_path)
    table = pq.read_table(tmp_path / "calibration.parquet")
    assert code == 0
    assert "the paper" in out
    assert table["reading"].to_pylist() == ["text", "steering_max 35 deg"]
    low, share, high = (table[f"pair first goal{end}"][1].as_py() for end in (" low", "", " high"))
    assert 0.0 <= low <= share <= high <= 1.0
    z = [table[f"{published.key} z"][1].as_py() for published in PUBLISHED]
    assert table["chi2"][1].as_py() == pytest.approx(np.square(z).sum())
    described = json.loads((tmp_path / "choices/01-pair.json").read_text())
    assert np.isclose(np.degrees(described["scenario"]["fleet"]["steering_max"]), 35)
