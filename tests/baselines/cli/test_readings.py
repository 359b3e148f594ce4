"""The commands take the rules and parameters of other readings of the paper."""

import json

import numpy as np
import pyarrow.parquet as pq
import pytest

from baselines.__main__ import main
from baselines.policies.avoid_jack import AvoidJack
from hav_env import Task
from hav_env.evaluation.rollout import rollout
from tests.support.budgets import budget

STEPS = budget(300, 20)
COMMON = ["--scenario", "paper-pair", "--episodes", "2", "--task.max-steps", str(STEPS)]
IN_TURN = ["--task.order", "in_turn"]


def run(capsys, *arguments):
    code = main(list(map(str, arguments)))
    captured = capsys.readouterr()
    return code, captured.out, captured.err


READINGS = [  # options, rules of the task, parameters of the policy
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


@pytest.mark.parametrize(("options", "rules", "parameters"), READINGS)
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
