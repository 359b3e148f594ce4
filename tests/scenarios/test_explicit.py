"""An explicit scenario is as written; mistakes in it are named."""

import itertools
import json
import math
import os
import subprocess
import sys
import time

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hav_env import (
    Batch,
    Task,
    explicit,
    find_scenario,
    load_explicit,
    parallel_env,
)
from hav_env.envs.stable_baselines3 import HAVVecEnv
from hav_env.scenarios.presets import scenario_of
from hav_env.scenarios.written import _find_overlap
from hav_env.world.arrays import FOOTPRINT
from tests.support.comparing import exactly

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
    assert exactly(from_arrays) == exactly(written(HAV))


TWO = {"havs": [HAV, OTHER], "speed_max": 2.0}


@pytest.mark.parametrize(
    "encoding",
    ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32", "utf-32-le"],
)
def test_a_file_may_be_in_any_unicode_with_a_byte_order_mark_or_without(encoding, tmp_path):
    path = tmp_path / "größe.json"
    path.write_bytes(json.dumps(TWO, indent=1).encode(encoding))
    assert exactly(load_explicit(path)) == exactly(written(HAV, OTHER, speed_max=2.0))


def test_a_file_is_read_alike_whatever_the_locale(tmp_path):
    path = tmp_path / "two.json"
    path.write_bytes(json.dumps(TWO | {"größe": 1}, ensure_ascii=False).encode("utf-8-sig"))
    script = f"import hav_env; hav_env.load_explicit({str(path)!r})"
    for locale in ({"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}, {}):
        environment = os.environ | locale | {"PYTHONIOENCODING": "utf-8"}
        done = subprocess.run(
            [sys.executable, "-c", script], env=environment, capture_output=True, check=False
        )
        assert "unknown entry 'größe'" in done.stderr.decode("utf-8"), done.stderr


def test_a_path_will_do_wherever_a_name_does(tmp_path):
    path = tmp_path / "Two.JSON"
    path.write_text(json.dumps(TWO))
    other = path.with_suffix(".scenario")
    other.write_text(json.dumps(TWO))
    for scenario in (path, str(path), other):
        assert scenario_of(scenario).num_havs == find_scenario(scenario).num_havs == 2
        env = parallel_env(scenario=scenario)
        assert len(env.reset(seed=0)[0]) == 2
    for make in (gym.make, gym.make_vec):
        make("hav_env:HAVSwarm-v0", scenario=path).reset(seed=0)
        make("hav_env:HAVSingle-v0", scenario=path).reset(seed=0)
    assert HAVVecEnv(2, scenario=path).num_envs == 4


@pytest.mark.parametrize("spread", [(100.0, 0.0), (0.0, 100.0), (60.0, 60.0)])
def test_a_swarm_of_thousands_is_checked_at_once_and_right(spread):
    count = 3_000
    start = np.outer(np.arange(count), [*spread, 0.0])
    start = start[np.random.default_rng(0).permutation(count)]
    goals = start[:, None] + [1.0, 0.0, 0.0]
    began = time.monotonic()
    assert explicit([[4.0, 8.0]] * count, start, goals).num_havs == count
    start[7, :2] = start[2_000, :2] + 16.0 / math.sqrt(2.0) - 1e-6
    with pytest.raises(ValueError, match=r"starts of HAVs 7 and 2000 are 16\.00 m apart"):
        explicit([[4.0, 8.0]] * count, start, goals)
    assert time.monotonic() - began < 10.0


@given(st.integers(2, 12), st.integers(0, 10**6))
def test_an_overlap_is_found_as_by_looking_at_all_pairs(count, seed):
    rng = np.random.default_rng(seed)
    places, radius = rng.uniform(0.0, 100.0, (count, 2)), rng.uniform(0.1, 30.0 / count, count)
    pairs = itertools.combinations(range(count), 2)
    expected = {
        (i, h) for i, h in pairs if math.dist(places[i], places[h]) <= radius[i] + radius[h]
    }
    found = _find_overlap(places, radius)
    assert (found is None) == (not expected)
    assert found is None or tuple(sorted(found)) in expected


@pytest.mark.parametrize("place", [(0.0, 0.0), (2e7, -2e7), (1e8, 1e8)])
@pytest.mark.parametrize("heading", [-1e6, 0.3, 1e6])
@pytest.mark.parametrize(
    "limits",
    [
        {"speed_max": 1e3, "steering_max": 1.5, "articulation_max": math.pi},
        {"speed_max": 1e-3, "steering_max": 1e-3, "articulation_max": 1e-3},
    ],
)
@pytest.mark.parametrize("length", [0.01, 1e3])
def test_at_the_corners_of_what_may_be_written_all_stays_finite(place, heading, limits, length):
    x, y = place
    start, goals = [[x, y, heading]], [[[-x, -y, -heading], [x, -y, 0.0]]]
    scenario = explicit([[length] * 5], start, goals, **limits)
    env = parallel_env(scenario=scenario, task=Task(dt=10.0, max_steps=10**8))
    observations, _ = env.reset(seed=0)
    state = env._world.process.batch.worlds.state
    for turn in (1.0, -1.0, 0.1, 1.0):
        assert env.observation_space("hav_0").contains(observations["hav_0"])
        assert env.state_space.contains(env.state())
        observations, rewards, *_ = env.step({"hav_0": np.array([1.0, turn])})
        assert np.isfinite(rewards["hav_0"])
        # as after the longest episode of turning at the fastest rate
        state.heading[:] += 1.4e15 if turn == 0.1 else 0.0
        state.x[:] += 1e12 if turn == 0.1 else 0.0
