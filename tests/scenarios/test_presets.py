"""Names of scenarios keep their meaning, and lead to usable scenarios."""

import re

import numpy as np
import pytest

from hav_env import Batch, Column, Crossing, RandomPoses, Yard, explicit, find_scenario
from hav_env.scenarios import Explicit, Field, RandomSitePoses, SitePoses, populate, presets
from hav_env.scenarios.presets import SCENARIOS, scenario_of

PAIR = explicit([[4, 6]] * 2, [[0, 0, 0], [30, 0, 0]], [[[9, 9, 9]], [[60, 9, 9]]])


def test_presets_are_what_papers_cite():
    assert {
        "paper-single": RandomPoses(num_havs=1),
        "paper-pair": RandomPoses(num_havs=2),
        "swarm-5": RandomPoses(num_havs=5),
        "swarm-10": RandomPoses(num_havs=10),
        "swarm-20": RandomPoses(num_havs=20),
        "swarm-50": RandomPoses(num_havs=50),
        "swarm-200": RandomPoses(num_havs=200),
        "dense-2": RandomPoses(num_havs=2, area_factor=2.0),
        "dense-5": RandomPoses(num_havs=5, area_factor=2.0),
        "dense-10": RandomPoses(num_havs=10, area_factor=2.0),
        "dense-20": RandomPoses(num_havs=20, area_factor=2.0),
        "dense-50": RandomPoses(num_havs=50, area_factor=2.0),
        "crossing-2": Crossing(num_havs=2),
        "crossing-8": Crossing(num_havs=8),
        "yard-4": Yard(num_havs=4),
        "yard-10": Yard(num_havs=10),
        "column-5": Column(num_havs=5),
    } == SCENARIOS
    assert {type(scenario) for scenario in SCENARIOS.values()} == {*populate.table} - {
        Explicit,
        SitePoses,
        RandomSitePoses,
        Field,
    }


def test_every_name_is_explained():
    for name in SCENARIOS:
        kind, _, number = name.rpartition("-")
        assert re.search(rf"``{kind}-\w+``.*?\|.*\|", presets.__doc__)
        assert re.search(rf"\| ``{kind}-.*{number}``", presets.__doc__)


@pytest.mark.parametrize("name", SCENARIOS)
def test_every_name_leads_to_a_scenario_with_room(name):
    batch = Batch(find_scenario(name), 2)
    batch.reset(0)
    assert batch.worlds.state.x.shape == (SCENARIOS[name].num_havs, 2)


@pytest.mark.parametrize("name", SCENARIOS)
def test_a_name_or_a_scenario_will_do(name):
    assert scenario_of(name) == scenario_of(SCENARIOS[name]) == find_scenario(name)
    assert scenario_of(name, 3) == find_scenario(name)._replace(num_havs=3)


def test_the_havs_of_an_explicit_scenario_cannot_be_other():
    assert scenario_of(PAIR) is scenario_of(PAIR, 2) is PAIR
    with pytest.raises(ValueError, match=r"num_havs is 3, but must be 2, the number of HAVs"):
        scenario_of(PAIR, 3)


def test_a_file_is_a_scenario_too():
    assert np.array_equal(scenario_of("examples/two_havs.json").num_trailers, [2, 3])


@pytest.mark.parametrize(
    ("scenario", "num_havs", "error", "message"),
    [
        ("moon", None, ValueError, "unknown scenario 'moon'; known: paper-single, .*FILE.json"),
        ("none.json", None, ValueError, "no scenario file none.json"),
        ("yard-4", 0, ValueError, "num_havs is 0, but must be at least 1"),
        (Yard(aisle=0.0), None, ValueError, "aisle is 0.0"),
        (None, None, TypeError, "is not a scenario"),
        (5, 2, TypeError, "is not a scenario"),
    ],
)
def test_what_is_no_scenario_is_an_error(scenario, num_havs, error, message):
    with pytest.raises(error, match=message):
        scenario_of(scenario, num_havs)
