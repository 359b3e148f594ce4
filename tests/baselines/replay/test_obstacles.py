"""Recorded episodes store obstacles and collisions; films, pages and figures show both."""

import base64
import json
import re

import matplotlib.colors
import numpy as np
import pytest

from baselines.figures.trajectory_plot import draw_trajectory
from baselines.policies.dubins_pursuit import DubinsPursuit
from baselines.replay.interpolation import scene_at
from baselines.replay.trajectory import record_trajectory
from baselines.replay.trajectory_files import load_trajectory, save_trajectory
from baselines.replay.web_page import write_replay
from hav_env import OffAxle, Task, build_site, explicit
from hav_env.world.arrays import NEVER, OBSTACLE, WHEN, WHERE
from hav_env.world.event_table import EVENTS
from tests.support.budgets import COMPILED
from tests.support.recorded import HIT, WALLS, driven_into_wall


def test_a_file_gives_the_same_episode_again(tmp_path):
    driven = driven_into_wall()
    plane = driven._replace(segment=WALLS[:0], first=driven.first[:, :OBSTACLE])
    for trajectory in (driven, plane, driven._replace(segment=WALLS[:1])):
        save_trajectory(trajectory, tmp_path / "run.npz")
        loaded = load_trajectory(tmp_path / "run.npz")
        assert loaded.first.tolist() == trajectory.first.tolist()
        assert loaded.segment.tobytes() == trajectory.segment.tobytes()
        assert loaded.segment.shape == trajectory.segment.shape


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"segment": np.zeros((2, 3))}, "'segment' is float64 of shape"),
        ({"segment": np.zeros((2, 4), int)}, "'segment' is int64"),
        ({"segment": np.full((2, 4), np.nan)}, "not finite"),
        ({"segment": np.full((2, 4), 2e9)}, "too large"),
        ({"segment": np.zeros((100_001, 4))}, "too many obstacles"),
        ({"segment": WALLS[:0]}, "an obstacle that there is not"),
        ({"first": np.full((2, 4, 2), 3)}, "an obstacle that there is not"),
        ({"first": np.full((2, 3, 2), NEVER)}, "obstacles without their event"),
        ({"first": np.full((2, 5, 2), NEVER)}, "'first' is int64 of shape"),
        ({"first": np.full((2, 2, 2), NEVER)}, "'first' is int64 of shape"),
        ({"version": 4}, "version 4 of the layout, not 5"),
    ],
)
def test_contents_that_no_episode_has_are_named(changes, message, tmp_path):
    if "first" in changes and changes["first"].shape[1] == 4:
        changes["first"][:, :OBSTACLE] = NEVER
    fields = {"kind": "hav_env trajectory", "version": 5, **driven_into_wall()._asdict()}
    np.savez(tmp_path / "odd.npz", **{**fields, **changes})
    with pytest.raises(ValueError, match=message):
        load_trajectory(tmp_path / "odd.npz")


def test_a_scene_shows_which_obstacle_was_hit_from_then_on():
    trajectory = driven_into_wall()
    for step, struck in ((0, NEVER), (HIT - 1, NEVER), (HIT, 0), (100, 0)):
        scene = scene_at(trajectory, step * trajectory.dt)
        assert scene.struck.tolist() == [struck, NEVER]
        assert scene.happened[:, OBSTACLE].tolist() == [struck != NEVER, False]
        assert scene.segment is trajectory.segment
    plane = trajectory._replace(segment=WALLS[:0], first=trajectory.first[:, :OBSTACLE])
    assert scene_at(plane, 20.0).struck is None


def test_a_page_has_the_obstacles_and_the_events_that_can_happen(tmp_path):
    driven = driven_into_wall()
    plane = driven._replace(segment=WALLS[:0], first=driven.first[:, :OBSTACLE])
    for trajectory in (driven, plane):
        write_replay(trajectory, tmp_path / "page.html")
        found = re.search(r'id="episode">(.*?)</script>', (tmp_path / "page.html").read_text())
        told = json.loads(found[1])
        segments = np.frombuffer(base64.b64decode(told["segments"]), "<f4").reshape(-1, 2)
        expected = trajectory.segment.reshape(-1, 2)
        assert segments + told["origin"] == pytest.approx(expected, abs=5e-3)
        names = [event["state"] for event in told["events"]]
        assert names == [event.state for event in EVENTS[: trajectory.first.shape[1]]]


def test_a_figure_has_all_obstacles_and_keeps_its_view():
    driven = driven_into_wall()
    plane = driven._replace(segment=WALLS[:0], first=driven.first[:, :OBSTACLE])
    views = []
    for trajectory in (driven, plane):
        figure = draw_trajectory(trajectory, "walls")
        drawn = [
            (np.array(found.get_segments()), found.get_color()[0])
            for found in figure.axes[0].collections
            if hasattr(found, "get_segments")
        ]
        told = {text.get_text() for text in figure.legends[0].get_texts()}
        views.append([*figure.axes[0].get_xlim(), *figure.axes[0].get_ylim()])
        assert ("obstacles" in told) is ("obstacle that was hit" in told) is bool(drawn)
        if drawn:
            assert np.array_equal(drawn[0][0].reshape(-1, 4), WALLS)
            assert np.array_equal(drawn[1][0].reshape(-1, 4), WALLS[:1])
            red, green, blue, _ = matplotlib.colors.to_rgba(drawn[1][1])
            assert red > 3 * max(green, blue) - 0.1
    np.testing.assert_allclose(views[0], views[1], atol=1.0)  # the legend has one row more


@pytest.mark.skipif(COMPILED, reason="a loop of its own would be compiled for it")
def test_what_is_recorded_is_the_world_as_it_was():
    site = build_site(lines=[[[10.0, -5.0], [10.0, 5.0]], [[-9.0, 8.0], [40.0, 8.0]]])
    scenario = explicit([[4.0, 5.0]], [[0.0, 0.0, 0.0]], [[[90.0, 0.0, 0.0]]], site=site)
    found = record_trajectory(DubinsPursuit(), scenario, 0, 0, Task(max_steps=60), OffAxle())
    assert found.segment == pytest.approx(site.segment)
    step, wall = found.first[0, OBSTACLE]
    assert wall == 0
    row = found.first[0, OBSTACLE, WHEN]
    assert found.x[row - 1, 0] + 4.0 < 10.0 <= found.x[row, 0] + 4.0
    assert found.first[0, :OBSTACLE, WHERE].tolist() == [NEVER] * OBSTACLE
    assert step == row
