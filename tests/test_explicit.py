"""A scenario that is written down is what was written; mistakes in it are named."""

import json
import math

import numpy as np
import pytest

from hav_env import Batch, explicit, load_explicit
from hav_env.world import FOOTPRINT

HAV = {"lengths": [4.0, 6.0], "start": [0.0, 0.0, 0.5], "goals": [[90.0, 0.0, 1.0]]}
OTHER = {"lengths": [3, 2, 5], "start": [30, 0, 0], "goals": [[-90, 0, 0]]}


def written(*havs, **limits):
    columns = [[hav[name] for hav in havs] for name in ("lengths", "start", "goals")]
    return explicit(*columns, **limits)


def test_a_written_scenario_is_what_was_written():
    batch = Batch(written(HAV, OTHER, speed_max=2.0, steering_max=0.5, articulation_max=1.0), 2)
    batch.reset(0)
    for w in range(2):
        world = batch.world(w)
        assert world.fleet.num_trailers.tolist() == [1, 2]
        assert world.fleet.length.tolist() == [[4, 6, math.inf], [3, 2, 5]]
        assert world.fleet.limit[:, :3].tolist() == [[2.0, 0.5, 1.0]] * 2
        assert world.state.x.tolist() == [0, 30]
        assert world.state.heading.tolist() == [[0.5] * 3, [0.0] * 3]
        assert world.goals.tolist() == [[[90, 0, 1]], [[-90, 0, 0]]]
        assert world.fleet.radius[:, FOOTPRINT].tolist() == [6, 7]


def test_a_scenario_from_a_file_is_the_same(tmp_path):
    (tmp_path / "two.json").write_text(json.dumps({"havs": [HAV, OTHER], "speed_max": 2.0}))
    loaded, given = load_explicit(tmp_path / "two.json"), written(HAV, OTHER, speed_max=2.0)
    for one, other in zip(loaded, given, strict=True):
        assert np.array_equal(one, other)


BAD = [
    ({"lengths": [4.0]}, "HAV 0.*truck and at least one trailer"),
    ({"lengths": [4.0, -6.0]}, "HAV 0 has lengths"),
    ({"lengths": [0.0, 6.0]}, "HAV 0 has lengths"),
    ({"lengths": [math.nan, 6.0]}, "HAV 0 has lengths"),
    ({"lengths": [4.0, math.inf]}, "HAV 0 has lengths"),
    ({"start": [0.0, 0.0]}, "HAV 0.*not a pose"),
    ({"start": [0.0, math.nan, 0.0]}, "HAV 0 has a pose that is not finite"),
    ({"goals": []}, "HAV 0 has 0 goals"),
    ({"goals": [[90.0, 0.0, 0.0]] * 2}, "HAV 1 has 1 goals"),
    ({"goals": [[90.0, 0.0, 0.0, 0.0]]}, "HAV 0.*not a pose"),
    ({"goals": [[90.0, math.inf, 0.0]]}, "HAV 0 has a pose that is not finite"),
    ({"start": [17.0, 0.0, 0.0]}, r"starts of HAVs 0 and 1 are 13\.00 m apart"),  # just touching
    ({"goals": [[-85.0, 0.0, 0.0]]}, "goals 1 of HAVs 0 and 1"),
]


@pytest.mark.parametrize(("change", "message"), BAD)
def test_a_mistake_in_a_written_scenario_is_named(change, message, tmp_path):
    with pytest.raises(ValueError, match=message):
        written(HAV | change, OTHER)
    path = tmp_path / "bad.json"
    path.write_text(json.dumps({"havs": [HAV | change, OTHER]}))
    with pytest.raises(ValueError, match=rf"bad\.json.*{message}"):
        load_explicit(path)


@pytest.mark.parametrize(
    ("field", "value"),
    [(f, v) for f in ("speed_max", "steering_max", "articulation_max") for v in (0, -1, math.nan)]
    + [("speed_max", math.inf), ("steering_max", math.pi / 2), ("articulation_max", 3.2)],
)
def test_a_bad_limit_of_a_written_scenario_is_named(field, value):
    with pytest.raises(ValueError, match=f"{field} is"):
        written(HAV, **{field: value})


def test_an_articulation_limit_of_half_a_turn_is_allowed():
    assert written(HAV, articulation_max=math.pi).articulation_max == math.pi


def test_lists_of_unequal_length_are_an_error():
    with pytest.raises(ValueError, match="1 HAVs have lengths, 2 a start and 1 goals"):
        explicit([[4, 6]], [[0, 0, 0], [30, 0, 0]], [[[9, 9, 9]]])
    with pytest.raises(ValueError, match="at least one HAV"):
        explicit([], [], [])


def test_arrays_will_do_for_lists():
    from_arrays = explicit(
        np.array([HAV["lengths"]]), np.array([HAV["start"]]), np.array([HAV["goals"]])
    )
    for one, other in zip(from_arrays, written(HAV), strict=True):
        assert np.array_equal(one, other)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "not a JSON file"),
        ("", "not a JSON file"),
        ("\udcff", "not a JSON file"),
        ("[]", 'an object with a list "havs"'),
        ("{}", 'an object with a list "havs"'),
        ('{"havs": []}', "at least one HAV"),
        ('{"havs": [5]}', "HAV 0 must have"),
        ('{"havs": [{"lengths": [4, 6]}]}', "HAV 0 must have"),
        (json.dumps({"havs": [HAV | {"colour": 1}]}), "HAV 0 must have"),
        (json.dumps({"havs": [HAV], "speed": 1}), "unknown entry 'speed'"),
        (json.dumps({"havs": [HAV], "speed_max": "fast"}), "fast"),
        (json.dumps({"havs": [HAV], "speed_max": None}), "not a number"),
        (json.dumps({"havs": [HAV | {"lengths": 5}]}), "is not a list"),
        (json.dumps({"havs": [HAV | {"goals": 5}]}), "is not a list"),
        (json.dumps({"havs": [HAV | {"goals": [5]}]}), "is not a list"),
        (json.dumps({"havs": [HAV | {"start": ["a", 0, 0]}]}), "a"),
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
