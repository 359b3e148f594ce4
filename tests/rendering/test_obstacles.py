"""Obstacles are drawn where they collide, in any number, and do not determine the view."""

import numpy as np
import pytest
import shapely

from hav_env.rendering import describe
from hav_env.rendering.camera import clip_segments
from hav_env.rendering.colors import INK, RED
from hav_env.rendering.history import History
from hav_env.rendering.scene import count_flags
from hav_env.rendering.viewer import Viewer
from hav_env.world.arrays import NEVER, OBSTACLE
from hav_env.world.event_table import EVENTS
from hav_env.world.place.reading import segments_in
from hav_env.world.place.segments import Plane, allocate_place, place_segment
from tests.rendering.test_rendering import SIZE, scene, where

HIT = EVENTS[OBSTACLE].state
GONE = {"removed": np.array([True])}  # nothing but obstacles is drawn
LOW, HIGH = np.array([-2.0, -1.0]), np.array([3.0, 4.0])


def test_the_parts_in_a_box_are_those_of_shapely():
    rng = np.random.default_rng(4)
    segments = rng.uniform(-8.0, 8.0, (400, 4))
    segments[:50, 2] = segments[:50, 0]  # along an axis
    segments[50:100, 3] = segments[50:100, 1]
    segments[100:120, 2:] = segments[100:120, :2]  # points
    segments[120] = 3.0, 4.0, 9.0, 9.0  # it touches a corner
    segments[121] = -2.0, -9.0, -2.0, 9.0  # it runs along an edge
    lines = shapely.linestrings(segments.reshape(-1, 2, 2))
    found, parts = clip_segments(segments, LOW, HIGH)
    expected = shapely.intersects(lines, shapely.box(*LOW, *HIGH))
    assert found.tolist() == np.flatnonzero(expected).tolist()
    inside = shapely.intersection(lines[found], shapely.box(*LOW, *HIGH))
    gaps = shapely.hausdorff_distance(shapely.linestrings(parts.reshape(-1, 2, 2)), inside)
    points = (found >= 100) & (found < 120)  # Shapely finds nothing of them
    assert gaps[~points].max() < 1e-12
    assert np.array_equal(parts[points], segments[found[points]])


@pytest.mark.parametrize("zoom", [1.0, 6.0])
def test_pixels_are_inked_along_obstacles_and_nowhere_else(zoom):
    walls = np.array([[2.0, 5.0, 30.0, -6.0], [10.0, -8.0, 10.0, 8.0], [20.0, 3.0, 1e7, 2e6]])
    frames = []
    for segment in (walls, walls[:0]):
        viewer = Viewer("rgb_array", size=SIZE)
        viewer._zoom = zoom
        viewer.draw(scene())  # aims the camera
        frames.append(viewer.draw(scene(segment=segment, **GONE)))
    inked = (frames[0] != frames[1]).any(axis=-1)
    lines = shapely.linestrings(viewer._camera.project(walls.reshape(-1, 2)).reshape(-1, 2, 2))
    down, right = np.indices(inked.shape) + 0.5
    away = shapely.distance(shapely.union_all(lines), shapely.points(right, down))
    bar = (right > SIZE[0] - 200) & (down > SIZE[1] - 60)  # the scale bar lies above
    assert inked[(away < 0.4) & ~bar].all()
    assert not inked[away > 2.0].any()


def test_obstacles_that_were_hit_are_red():
    walls = np.array([[2.0, 5.0, 30.0, 5.0], [2.0, -5.0, 30.0, -5.0]])
    for struck, red in ((None, ()), ([NEVER], ()), ([0], (0,)), ([1], (1,))):
        viewer = Viewer("rgb_array", size=SIZE)
        viewer.draw(scene())
        numbers = None if struck is None else np.array(struck)
        frame = viewer.draw(scene(segment=walls, struck=numbers, **GONE))
        for wall, (_, y, _, _) in enumerate(walls):
            row = viewer._camera.project(np.array([16.0, y]))[1]
            color = RED if wall in red else INK
            assert np.abs(where(frame, color)[:, 1] + 0.5 - row).min() < 1.5
        assert bool(len(where(frame, RED))) is bool(red)


def test_obstacles_far_away_do_not_move_the_camera_and_near_ones_are_in_the_picture():
    views = {}
    for name, wall in {
        "none": np.zeros((0, 4)),
        "far": [[-9e7, 200.0, 9e7, 200.0]],
        "near": [[20.0, 2.0, 20.0, 25.0]],
        "partly near": [[20.0, 2.0, 20.0, 9e7]],
    }.items():
        viewer = Viewer("rgb_array", size=SIZE)
        viewer.draw(scene(segment=np.asarray(wall, float)))
        views[name] = np.concatenate(viewer._camera.seen())
    np.testing.assert_array_equal(views["far"], views["none"])
    np.testing.assert_array_equal(views["near"], views["partly near"])
    assert views["near"][3] - views["near"][1] >= views["none"][3] - views["none"][1]
    low, high = views["near"][:2], views["near"][2:]
    assert (low < [20.0, 2.0]).all()
    assert (high > [20.0, 8.0]).all()


def test_the_event_is_told_listed_and_counted():
    whole = scene(2, segment=np.array([[0.0, 5.0, 9.0, 5.0]]))
    hit = scene(2, time=1.0, segment=whole.segment, **{HIT: np.array([True, False])})
    assert describe(whole).count(HIT) == 0
    assert describe(hit).split("; ")[1].endswith(HIT)
    assert count_flags(hit)[HIT] == 1
    history = History()
    for shown in (whole, hit, hit):
        history.observe(shown)
    assert list(history.events) == [(1.0, f"HAV 0 {HIT}")]
    plane = hit._replace(happened=hit.happened[:, :OBSTACLE])
    assert HIT not in describe(plane)
    assert HIT not in count_flags(plane)
    viewers = [Viewer("rgb_array"), Viewer("rgb_array")]
    for viewer in viewers:
        viewer.legend = False  # it has red signs
    red = [
        len(where(viewer.draw(shown), RED))
        for viewer, shown in zip(viewers, (plane, hit), strict=True)
    ]
    assert red[0] == 0 < red[1]


def test_segments_of_worlds_are_those_that_were_placed():
    place = allocate_place(4, (1, 2, 2), np.zeros)
    ends = np.random.default_rng(8).uniform(-90.0, 90.0, (3, 4))
    for number, (ax, ay, bx, by) in enumerate(ends):
        place_segment(place, number, 1, ax, ay, bx, by)
    assert segments_in(place, 1) == pytest.approx(ends)
    assert segments_in(place, 0).shape == segments_in(Plane(), 0).shape == (0, 4)
