"""Times of worlds: sums over their HAVs, with those that never arrive at the cap."""

import numpy as np
import pytest

from baselines.evaluation.arrival_times import world_times
from baselines.evaluation.feasibility import shortest_times
from baselines.policies.dubins_pursuit import DubinsPursuit
from hav_env import Task, find_scenario
from hav_env.evaluation.rollout import rollout
from tests.support.budgets import budget

CAP = budget(900, 8)
NEAR = {"distance_tolerance": budget(0.5, 60.0), "heading_tolerance": budget(0.5, 4.0)}


@pytest.mark.parametrize(("scenario", "timed"), [("paper-single", 2), ("paper-pair", 1)])
def test_the_time_of_a_world_is_written_out_hav_by_hav(scenario, timed):
    scenario = find_scenario(scenario)
    task = Task(max_steps=CAP, **NEAR)
    table = rollout(DubinsPursuit(), scenario, 7, np.arange(budget(30, 4)), task=task)
    steep, stable = shortest_times(table, scenario.fleet)
    worlds: dict[int, list[float]] = {}
    missed = 0
    for place, row in enumerate(table.to_pylist()):
        arrived = row[f"goal_{timed}_step"]
        missed += arrived is None
        path = steep[0, place] + steep[1, place] if timed == 2 else stable[0, place]
        world = worlds.setdefault(row["episode"], [0.0, 0.0])
        world[0] += CAP if arrived is None else arrived
        world[1] += path
    found = world_times(table, scenario.fleet, CAP)
    assert np.stack(found, 1) == pytest.approx(np.array(list(worlds.values())))
    assert 0 < missed < table.num_rows
