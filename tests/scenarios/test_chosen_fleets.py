"""Vehicles of the catalogue take the place of a scenario's, in Python and on the command line."""

import functools

import numpy as np
import pytest

from baselines.cli.run_options import take_scenario
from hav_env import catalogue, catalogue_fleet, evaluate, find_scenario, parallel_env
from hav_env.cli.menu import run_menu
from hav_env.cli.play import Play, open_environment
from hav_env.scenarios.presets import scenario_of
from tests.support.paths import ROOT


def same(one, other):
    return all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


@pytest.mark.parametrize(
    "fleet",
    ["wb-67,eurocombi", "wb-67, eurocombi", ["wb-67", catalogue("eurocombi")]],
)
def test_names_are_the_fleet_of_the_catalogue(fleet):
    expected = find_scenario("swarm-5")._replace(fleet=catalogue_fleet(["wb-67", "eurocombi"]))
    found = scenario_of("swarm-5", fleet=fleet)
    assert same(found.fleet, expected.fleet)
    assert found._replace(fleet=None) == expected._replace(fleet=None)


def test_a_fleet_stays_itself():
    weighted = catalogue_fleet(["wb-67", "eurocombi"], weights=[3, 1])
    assert scenario_of("paper-pair", fleet=weighted).fleet is weighted
    assert same(scenario_of("paper-pair", fleet=catalogue("wb-67")).fleet, catalogue_fleet("wb-67"))


def test_the_command_line_takes_names_and_says_them_in_the_title():
    words = ["--scenario", "swarm-5", "--fleet", "wb-67", "--fleet.max-trailers", "1"]
    title, scenario, rest = take_scenario(words)
    assert title == "swarm-5 with wb-67"
    assert same(scenario.fleet, catalogue_fleet("wb-67"))
    assert rest == words[4:]


@pytest.mark.parametrize(
    ("fleet", "error", "message"),
    [
        (3, TypeError, "fleet is 3, but must be a fleet, a vehicle of the catalogue or"),
        ({"wb-67": 1}, TypeError, "fleet is {'wb-67': 1}, but must be a fleet"),
        ("wb-67d,,", ValueError, "unknown combination ''"),
        ("eurocombo", ValueError, "did you mean 'eurocombi'"),
        ([], ValueError, "must name at least one vehicle"),
    ],
)
def test_what_is_no_fleet_is_refused(fleet, error, message):
    for call in (parallel_env, functools.partial(evaluate, "random")):
        with pytest.raises(error, match=message):
            call(fleet=fleet, vehicle="realistic")


def test_vehicles_that_a_scenario_states_stay():
    told = "fleet is 'wb-67', but must be None: this Explicit states its vehicles itself"
    with pytest.raises(ValueError, match=told):
        scenario_of(str(ROOT / "examples/two_havs.json"), fleet="wb-67")


def test_commands_say_how_to_drive_real_vehicles(capsys):
    for words, message in (
        (["--vehicle", "eurocombi"], "write --fleet eurocombi --vehicle realistic"),
        (["--fleet", "eurocombi"], "add --vehicle realistic"),
    ):
        for command in ("evaluate", "watch"):
            assert run_menu([command, "random", *words]) == 2
            assert message in capsys.readouterr().err
    with pytest.raises(ValueError, match="add --vehicle realistic"):
        open_environment(Play(fleet="eurocombi"), None)
