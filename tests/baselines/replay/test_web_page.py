"""The page is given what it shows: where the axles are, what happened; in little room."""

import base64
import json
import re

import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from baselines.replay.trajectory import chain_points, record_trajectory
from baselines.replay.web_page import template, write_replay
from hav_env import OffAxle, RandomPoses, Rectangles, Task, catalogue_fleet
from hav_env.vehicles import catalogue
from hav_env.world.event_table import EVENTS


@pytest.fixture(scope="module")
def trajectory():
    return record_trajectory(AvoidJack(), RandomPoses(2), 0, 5, Task(max_steps=200))


@pytest.fixture(scope="module")
def told(trajectory, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "page.html"
    write_replay(trajectory, path)
    return told_by(path)


def told_by(path) -> dict:
    """Return what a page was told of its episode."""
    found = re.search(r'id="episode">(.*?)</script>', path.read_text(), re.DOTALL)
    return json.loads(found[1])


def numbers(text: str, kind: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), kind)


def test_the_page_knows_every_axle_to_a_centimetre(trajectory, told):
    states = len(trajectory.step)
    axles = numbers(told["axles"], "<i2").reshape(states, -1, 2)
    x, y = (numbers(told[axis], "<f4").reshape(states, 2) for axis in "xy")
    end = 0
    for hav in range(2):
        begin, end = end, end + len(told["lengths"][hav])
        places = told["axleUnit"][hav] * axles[:, begin:end]
        places = np.insert(places, 1, 0.0, axis=1)
        places += np.stack([x[:, hav], y[:, hav]], axis=-1)[:, None] + told["origin"]
        np.testing.assert_allclose(places, chain_points(trajectory, hav, slice(None)), atol=0.01)


def test_the_page_knows_hitches_limits_and_bodies(told, tmp_path):
    kind = catalogue("baggage-train")
    scenario = RandomPoses(2, fleet=catalogue_fleet(kind))
    vehicle = OffAxle(bodies=Rectangles())
    kept = record_trajectory(AvoidJack(), scenario, 0, 5, Task(max_steps=2), vehicle)
    write_replay(kept, tmp_path / "page.html")
    real = told_by(tmp_path / "page.html")
    for hav in range(2):
        assert real["lengths"][hav] == list(kind.lengths)
        assert real["hitchOffsets"][hav] == [*kind.offsets[1:], 0.0]
        assert real["articulationMax"][hav][1:] == list(kind.limits[1:])
        assert real["shapes"][hav] == np.transpose(kind.bodies).tolist()
    assert told["shapes"] is None
    assert not any(any(own) for own in told["hitchOffsets"])
    assert {limit for own in told["articulationMax"] for limit in own[1:]} == {np.pi / 2}


def test_states_take_few_bytes(trajectory, told):
    arrays = ("step", "phase", "x", "y", "axles", "driving", "steering", "evaded", "removed")
    size = sum(len(base64.b64decode(told[name])) for name in arrays)
    units = trajectory.num_trailers.sum() + 2
    assert size == len(trajectory.step) * (4 + 2 * 19 + 4 * units)


def test_the_page_knows_all_events(told):
    names = [event.state for event in EVENTS if not event.obstacles]
    assert [event["state"] for event in told["events"]] == names
    assert all(f"{event.color}: ()" in template() for event in EVENTS)
