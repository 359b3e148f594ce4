"""A wrong name of a model gets the nearest right one, of names, files, modules and classes."""

import inspect
import pathlib
import re

import pytest

import hav_env
from baselines.cli.run_options import take_scenario
from baselines.commands.evaluate import main
from hav_env.evaluation.evaluate import usual_episodes
from hav_env.policies.names import POLICIES
from hav_env.scenarios.presets import REGISTRY as SCENARIO_NAMES
from tests.support.paths import EXAMPLES

MODEL = """
from typing import NamedTuple

from hav_env import act


class Halt(NamedTuple):
    speed: float = 0.0


@act.register(Halt)
def halt(policy, memory, world, agent, lane):
    return policy.speed, 0.0
"""


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Work in a folder with a module and the folder of a run."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    pathlib.Path("halting_things.py").write_text(MODEL)
    pathlib.Path("runs/smoke").mkdir(parents=True)
    for name in ("best", "last"):
        pathlib.Path(f"runs/smoke/{name}.policy").touch()
    pathlib.Path("mine.policy").touch()


@pytest.mark.parametrize(
    ("name", "suggestion"),
    [
        ("reserv", "reserve"),
        ("runs/smoke", "runs/smoke/best.policy"),
        ("runs/smoke/best", "runs/smoke/best.policy"),
        ("runs/smoke/lst.policy", "runs/smoke/last.policy"),
        ("mine.polcy", "mine.policy"),
        ("RESERVE", "reserve"),
        ("halting_things", "halting_things:Halt"),
        ("halting_things.py", "halting_things:Halt"),
        ("halt", "halting_things:Halt"),
        ("halting_things.py:Halt", "halting_things:Halt"),
        ("sub/slow.py:Class", "sub.slow:Class"),
        ("halting_thing:Halt", "halting_things:Halt"),
        ("halting_things:Hlat", "halting_things:Halt"),
    ],
)
def test_a_wrong_name_gets_the_nearest_one(name, suggestion, here):
    with pytest.raises(ValueError, match=re.escape(f"(did you mean {suggestion!r}?)")) as told:
        POLICIES.find(name)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("name", ["", "zzz", "zzz:Zzz", "zzz.policy", "a\0b", "shy", "ppo"])
def test_a_name_that_is_near_nothing_gets_no_suggestion(name, here):
    with pytest.raises(ValueError, match="policy") as told:
        POLICIES.find(name)
    assert "did you mean" not in str(told.value)


@pytest.mark.parametrize(
    ("kind", "name", "told"),
    [
        ("policy", "eurocombi", "a vehicle of the catalogue, but must be a policy: write --fl"),
        ("policy", "paper-pair", "a scenario, but must be a policy: write --scenario paper-pair"),
        ("policy", str(EXAMPLES / "depot.json"), "a scenario, but must be a policy: write --scen"),
        ("scenario", "reserve", "a policy, but must be a scenario: write hav-env evaluate r"),
        ("vehicle", "wb-67", "must be a vehicle: write --fleet wb-67 --vehicle realistic"),
        ("combination", "realistic", "a vehicle, but must be a vehicle of the catalogue: write"),
    ],
)
def test_a_name_of_another_kind_is_named_with_its_use(kind, name, told):
    with pytest.raises(ValueError, match=re.escape(told)):
        hav_env.find_model(kind, name)


def test_parameters_stand_behind_a_name(here):
    assert POLICIES.find("reserve:patience=5") == hav_env.make_policy("reserve", patience=5.0)
    found = POLICIES.make("avoid_jack:close-factor=3,b=1e-1")
    assert found == hav_env.make_policy("avoid_jack", close_factor=3.0, b=0.1)
    halt = POLICIES.find("halting_things:Halt:speed=2")
    assert (type(halt).__name__, halt) == ("Halt", (2.0,))
    assert hav_env.find_scenario("crossing-8:gap=30")._replace(gap=20.0) == hav_env.find_scenario(
        "crossing-8:gap=20"
    )


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("reserve:patence=5", "no parameter 'patence' (did you mean 'patience'?)"),
        ("reserve:patience=long", "patience is long, a str and not a number"),
        ("reserve:patience=-1", "patience is -1.0, but must be at least 0"),
        ("reserve:patience=5,6", "holds '6', but must hold FIELD=VALUE,FIELD=VALUE"),
        ("reserve:patience", "a parameter of 'reserve' is written reserve:patience=VALUE"),
        ("nobody:patience=5", "unknown policy 'nobody'"),
    ],
)
def test_a_wrong_parameter_behind_a_name_is_named(name, told):
    with pytest.raises((TypeError, ValueError), match=re.escape(told)) as error:
        POLICIES.find(name)
    assert "\n" not in str(error.value)


def test_a_scenario_of_real_vehicles_names_the_vehicle_that_it_needs(capsys):
    assert main(["avoid_jack", "--scenario", "docks-6"]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "--vehicle realistic" in told


def test_the_command_and_the_function_have_the_same_defaults():
    usual = inspect.signature(hav_env.evaluate).parameters
    assert take_scenario([])[0] == usual["scenario"].default
    assert usual["episodes"].default is None
    explicit = SCENARIO_NAMES.make(str(next(EXAMPLES.rglob("*.json"))))
    assert usual_episodes(explicit) == 1
    assert usual_episodes(hav_env.find_scenario("paper-single")) > 1
