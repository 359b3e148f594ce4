"""Readings of the paper by name: the text is the default; the others match their descriptions."""

import math

import numpy as np
import pytest

from baselines.experiments.readings import (
    READINGS,
    TEXT,
    circles,
    find_reading,
    scenario_of_reading,
    vary,
)
from baselines.policies.avoid_jack import AvoidJack
from hav_env import OnAxle, RandomFleet, Task, find_scenario
from hav_env.evaluation.figures import FOLDED_THROUGH
from hav_env.evaluation.rollout import rollout
from hav_env.policies.checks import check_models
from tests.support.budgets import budget


def test_the_text_is_the_default_of_everything():
    assert TEXT[2:6] == (AvoidJack(), RandomFleet(), Task(), OnAxle())
    for size in ("single", "pair"):
        assert scenario_of_reading(TEXT, size) == find_scenario(f"paper-{size}")


def test_names_are_keys_and_all_can_be_run():
    for name, reading in READINGS.items():
        assert reading.name == name
        assert find_reading(name) is reading
        assert reading.told
        for size in ("single", "pair"):
            scenario = scenario_of_reading(reading, size)
            check_models(reading.policy, scenario, reading.task, reading.vehicle)
    with pytest.raises(ValueError, match="reading is 'mine', but must be one of text"):
        find_reading("mine")


def test_other_parameters_leave_the_rest_as_it_was():
    varied = vary(TEXT, "mine", policy={"b": 0.6}, task={"dt": 0.1}, jackknifed=FOLDED_THROUGH)
    assert varied.policy == AvoidJack(b=0.6)
    assert varied.task == Task(dt=0.1)
    assert (varied.fleet, varied.vehicle) == (TEXT.fleet, TEXT.vehicle)
    assert varied.jackknifed is FOLDED_THROUGH
    again = vary(varied, "again", **circles(0.5, 0.25))
    assert again.jackknifed is FOLDED_THROUGH
    assert again.policy == AvoidJack(b=0.6, evasion_center=0.5, evasion_truck_share=0.25)
    assert again.task == Task(dt=0.1, potential_center=0.5, potential_truck_share=0.25)


def test_circles_leave_starts_and_goals_where_they_are():
    """Area and placement go by the text in every reading of the circles."""
    short, wide = {"max_steps": budget(400, 5)}, circles(0.5, 0.5)
    readings = vary(TEXT, "x", task=short), vary(TEXT, "y", **wide | {"task": wide["task"] | short})
    tables = [
        rollout(one.policy, scenario_of_reading(one, "pair"), 5, np.arange(6), one.task)
        for one in readings
    ]
    for column in ("start_x", "start_heading", "goal_1_x", "goal_2_y", "footprint_radius"):
        assert tables[0][column].equals(tables[1][column])


def test_published_departs_from_the_text_where_it_says():
    published = READINGS["published"]
    assert published.fleet == RandomFleet(steering_max=math.radians(38.0))
    assert published.vehicle == OnAxle()
    rules, texts = published.task._asdict(), Task()._asdict()
    assert {rule for rule in rules if rules[rule] != texts[rule]} == {
        "next_goal", "order", "potential_center", "potential_truck_share",
    }  # fmt: skip
