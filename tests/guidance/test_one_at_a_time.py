"""Several real vehicles drive at a real place without harm: the example policy under the filter."""

import importlib

import pyarrow.compute as pc
import pytest

from hav_env import Filtered, Task, rollout
from tests.support.paths import EXAMPLES

# every HAV senses all others of the place
TASK = Task(max_steps=6_000, sensing_range=1_000.0)


@pytest.mark.exhaustive
def test_havs_that_drive_one_at_a_time_pass_the_gate_without_harm(monkeypatch):
    monkeypatch.syspath_prepend(EXAMPLES)
    example = importlib.import_module("one_at_a_time")
    policy = Filtered(example.OneAtATime())
    table = rollout(policy, "gate-2", 7, range(12), TASK, "realistic", guidance="roads")
    for harm in ("jackknifed", "actual_collision", "obstacle_collision"):
        assert not pc.any(table[harm]).as_py()
    assert pc.all(table["goal_1_hit"]).as_py()
