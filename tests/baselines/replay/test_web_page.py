"""The page receives the data that it shows: axles and events, in little space."""

import base64
import json
import re

import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from baselines.replay.interpolation import scene_at
from baselines.replay.trajectory import chain_points, record_trajectory
from baselines.replay.web_page import template, write_replay
from hav_env import OffAxle, RandomPoses, Rectangles, Task, catalogue_fleet
from hav_env.vehicles import catalogue
from hav_env.world.event_table import EVENTS
from tests.support.recorded import driven_into_wall


@pytest.fixture(scope="module")
def trajectory():
    return record_trajectory(AvoidJack(), RandomPoses(2), 0, 5, Task(max_steps=200))


@pytest.fixture(scope="module")
def told(trajectory, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "page.html"
    write_replay(trajectory, path)
    return told_by(path)


def told_by(path) -> dict:
    """Return the data of the episode in a page."""
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


def test_the_page_knows_what_is_reserved_and_when_time_is_up(tmp_path):
    walls = driven_into_wall()
    angles = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    round_one = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    outlines = np.array([round_one, 9.0 * round_one + 40.0, 2.0 * round_one - 7.0])
    reserved = walls.reserved.copy()
    reserved[10:, 0], reserved[40:, 1] = 1, 2  # outline 0 is in no shown state
    write_replay(walls._replace(outline=outlines, reserved=reserved), tmp_path / "page.html")
    data = told_by(tmp_path / "page.html")
    corners = data["outlineUnit"] * numbers(data["outlines"], "<i2").reshape(-1, 24, 2)
    np.testing.assert_allclose(corners + data["origin"], outlines[1:], atol=0.01)
    found = numbers(data["reserved"], "<i4").reshape(reserved.shape)
    assert np.array_equal(found, np.where(reserved < 0, -1, reserved - 1))
    assert data["maxSteps"] == 100
    scene = scene_at(walls._replace(outline=outlines, reserved=reserved), 20 * walls.dt)
    np.testing.assert_array_equal(scene.reserved[0], outlines[1])
    assert np.isnan(scene.reserved[1]).all()
    assert scene_at(walls, 0.0).reserved is None


def test_states_take_few_bytes(trajectory, told):
    arrays = ("step", "phase", "x", "y", "axles", "driving", "steering", "evaded", "removed")
    size = sum(len(base64.b64decode(told[name])) for name in arrays)
    units = trajectory.num_trailers.sum() + 2
    assert size == len(trajectory.step) * (4 + 2 * 19 + 4 * units)


def test_the_page_knows_all_events(told):
    names = [event.state for event in EVENTS if not event.obstacles]
    assert [event["state"] for event in told["events"]] == names
    assert all(f"{event.color}: ()" in template() for event in EVENTS)
