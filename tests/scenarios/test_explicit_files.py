"""A scenario in a file is as written; mistakes in it are named."""

import json
import math
import pathlib

import numpy as np
import pytest

from hav_env import Batch, OffAxle, Rectangles, catalogue, explicit, load_explicit
from hav_env.scenarios import explicit_files
from tests.scenarios.test_explicit import HAV, OTHER, TWO, written
from tests.support.comparing import exactly


def test_a_scenario_from_a_file_is_the_same(tmp_path):
    (tmp_path / "two.json").write_text(json.dumps({"havs": [HAV, OTHER], "speed_max": 2.0}))
    loaded, given = load_explicit(tmp_path / "two.json"), written(HAV, OTHER, speed_max=2.0)
    assert exactly(loaded) == exactly(given)


REAL = {"vehicle": "wb-67", "start": [0, 0, 0], "goals": [[50, 0, 0]]}


def test_vehicles_of_the_file_and_of_the_catalogue_start_bent(tmp_path):
    units = {
        "truck": {"wheelbase": 4.0, "hitch": 1.1, "width": 2.5, "front": 1.4, "speed_max": 3.0},
        "trailers": [{"length": 2.0}, {"length": 5.0, "width": 2.4, "rear": 1.0, "bend_max": 1.2}],
    }
    havs = [
        REAL | {"bends": [-0.3]},
        {"vehicle": "mine", "start": [0, 90, 1], "goals": [[50, 90, 0]], "bends": [0.2, 0.1]},
        {"lengths": [3, 5], "start": [0, 200, 0], "goals": [[50, 200, 0]]},
    ]
    (tmp_path / "depot.json").write_text(json.dumps({"havs": havs, "vehicles": {"mine": units}}))
    scenario = load_explicit(tmp_path / "depot.json")
    with pytest.raises(ValueError, match=r"vehicle is .*, but must support hitches"):
        Batch(scenario)
    batch = Batch(scenario, vehicle=OffAxle(bodies=Rectangles(2.0)))
    batch.reset(0)
    fleet, heading = batch.worlds.fleet, batch.worlds.state.heading[..., 0]
    assert fleet.num_trailers[:, 0].tolist() == [1, 2, 1]
    assert fleet.joints.offset[1, :, 0].tolist() == [1.1, 0.0, 0.0]
    assert fleet.joints.limit[1, 2, 0] == 1.2
    assert fleet.limit[1, :3, 0].tolist() == [3.0, scenario.steering[1], 1.2]
    assert fleet.bodies.shape[1, ..., 0].tolist() == [[1.25, 1.4, 1.1], [0, 0, 0], [1.2, 0, 1.0]]
    assert (fleet.bodies.shape[2, :2, 0, 0] == 1.0).all()
    assert heading[0, 1] == -0.3
    np.testing.assert_allclose(np.diff(heading[1]), [0.2, 0.1])
    wb_67 = catalogue("wb-67")
    assert fleet.length[0, :2, 0].tolist() == list(wb_67.lengths)
    twice = explicit(
        [wb_67, "wb-67"], [[0, 0, 0], [0, 99, 0]], [[[50, 0, 0]], [[50, 99, 0]]], bends=[[], []]
    )
    assert (twice.length[0] == twice.length[1]).all()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "not a JSON file"),
        ("", "not a JSON file"),
        ("\udcff", "not a JSON file"),
        ("[]", "must be an object"),
        ("{}", "no entry 'havs'"),
        ('{"havs": []}', "at least one HAV"),
        ('{"havs": [5]}', r"havs\[0\] is 5, but must be an object"),
        ('{"havs": [{"lengths": [4, 6]}]}', r"havs\[0\] has no entry 'start'"),
        (json.dumps({"havs": [HAV | {"colour": 1}]}), r"havs\[0\] has the unknown entry 'colour'"),
        (json.dumps({"havs": [HAV], "speed": 1}), "unknown entry 'speed'"),
        (json.dumps({"havs": [HAV], "speed_max": "fast"}), "fast"),
        (json.dumps({"havs": [HAV], "speed_max": None}), "must be a number"),
        (json.dumps({"havs": [HAV | {"lengths": 5}]}), "lengths is 5, but must be an array"),
        (json.dumps({"havs": [HAV | {"goals": 5}]}), "goals is 5, but must be an array"),
        (json.dumps({"havs": [HAV | {"goals": [5]}]}), r"goals\[0\] is 5, but must be an array"),
        (json.dumps({"havs": [HAV | {"start": ["a", 0, 0]}]}), r"start\[0\] is 'a'"),
        (json.dumps({"havs": [HAV | {"start": [math.nan, 0, 0]}]}), "a pose that is not finite"),
        (json.dumps({"havs": [HAV | {"vehicle": "wb-67"}]}), 'either "lengths" or "vehicle"'),
        (
            json.dumps({"havs": [REAL | {"vehicle": "wb-68"}]}),
            "unknown vehicle 'wb-68'; known: ",
        ),
        (json.dumps({"havs": [REAL | {"vehicle": "antigravity:x"}]}), "unknown vehicle 'antigr"),
        (json.dumps({"havs": [REAL | {"vehicle": "mine.json"}]}), "unknown vehicle 'mine.json'"),
        (json.dumps({"havs": [REAL | {"bends": [math.nan]}]}), "within the limits of its joints"),
        (json.dumps({"havs": [REAL | {"bends": [0.1, 0.2]}]}), "bends of HAV 0 has 2 numbers"),
        (
            json.dumps({"havs": [REAL | {"bends": [2.0]}]}),
            "within the limits of its joints",
        ),
        (json.dumps({"havs": [REAL], "vehicles": {"a": {}}}), "a has no entry 'truck'"),
        (json.dumps({"havs": [REAL], "vehicles": {"a": 5}}), "vehicles.a is 5, but must be an obj"),
    ],
)
def test_a_file_that_holds_no_scenario_is_an_error_that_names_it(text, message, tmp_path):
    path = tmp_path / "scenario.json"
    path.write_bytes(text.encode(errors="surrogateescape"))
    with pytest.raises(ValueError, match=rf"scenario\.json.*{message}"):
        load_explicit(path)


def test_a_file_that_is_missing_is_an_error(tmp_path):
    with pytest.raises(FileNotFoundError, match="nothing"):
        load_explicit(tmp_path / "nothing.json")


NUMBER = '{"havs": [{"lengths": [4, 6], "start": [0, 0, %s], "goals": [[90, 0, 1]]}]}'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("null", "scenario is None, but must be an object"),
        ("3", "scenario is 3, but must be an object"),
        ('"havs"', "scenario is 'havs', but must be an object"),
        ('{"havs": null}', "havs is None, but must be an array"),
        ('{"havs": {}}', "havs is {}, but must be an array"),
        ('{"havs": [], "havs": []}', "the entry 'havs' stands twice"),
        ('{"havs": [{"start": [0, 0, 0], "start": [1, 0, 0]}]}', "the entry 'start' stands twice"),
        (NUMBER % "NaN", "HAV 0 has a pose that is not finite"),
        (NUMBER % "-Infinity", "HAV 0 has a pose that is not finite"),
        (NUMBER % "1e999", "HAV 0 has a pose that is not finite"),
        (NUMBER % '"1"', r"havs\[0\].start\[2\] is '1', but must be a number"),
        (NUMBER % "true", r"start\[2\] is True, but must be a number"),
        (NUMBER % "null", r"start\[2\] is None, but must be a number"),
        (NUMBER % "[1]", r"start\[2\] is \[1\], but must be a number"),
        (NUMBER % "1e7", "heading of the start of HAV 0 is 10000000.0, but must be"),
        (NUMBER % ("1" * 400), r"start\[0\]\[2\] is 111.*, but must be"),
        (NUMBER % ("1" * 5000), "not a JSON file: Exceeds the limit"),
        ("[" * 10**5, "not a JSON file"),
        ('{"havs": []} trailing', "not a JSON file"),
        (
            '{"havs": [{"lengths": [4, 6], "start": [0, 0, 0], "goals": [[1, 0, 0]], "x": 1}]}',
            r"havs\[0\] has the unknown entry 'x'",
        ),
        ('{"havs": [], "": 1}', "unknown entry ''; known: vehicles, havs, speed_max"),
        ("\0" * 8, "not a JSON file"),
    ],
)
def test_a_file_that_cannot_be_is_one_line_with_file_and_entry(text, message, tmp_path):
    path = tmp_path / "scenario.json"
    path.write_text(text)
    with pytest.raises(ValueError, match=rf"^\S*scenario\.json(:| is).*{message}") as told:
        load_explicit(path)
    assert "\n" not in str(told.value)
    assert len(str(told.value)) < 400


def test_a_file_without_end_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(explicit_files, "_MOST_BYTES", 1_000)
    path = tmp_path / "long.json"
    path.write_text(" " * 1_000 + json.dumps(TWO))
    for endless in (path, pathlib.Path("/dev/zero")):
        with pytest.raises(ValueError, match="has more than 1000 bytes"):
            load_explicit(endless)
