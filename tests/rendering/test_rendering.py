"""Drawings show the world: positions, colours, states; they open a window only on request."""

import numpy as np
import pytest

from hav_env.rendering import Scene
from hav_env.rendering.camera import Camera, round_length
from hav_env.rendering.colors import AMBER, CALM, EVASION, PALETTE, RED, color_of, color_of_bend
from hav_env.rendering.history import History
from hav_env.rendering.viewer import Viewer
from hav_env.world.event_table import EVENTS

SIZE = (480, 360)  # too small for the panels, so that a picture holds HAVs and goals alone


def scene(num_havs=1, num_trailers=2, **changed) -> Scene:
    """Return HAVs 40 m apart, straight, with goals far ahead, except for the changed fields.

    The state of an event, such as "jackknifed", sets which HAVs it has happened to.
    """
    happened = np.zeros((num_havs, len(EVENTS)), np.bool_)
    for event in EVENTS:
        happened[:, event.row] = changed.pop(event.state, False)
    places = 40.0 * np.arange(num_havs)
    nothing, none = np.zeros(num_havs), np.zeros(num_havs, np.bool_)
    units = num_trailers + 1
    standing = Scene(
        time=0.0,
        phase=np.zeros(num_havs, int),
        x=nothing,
        y=places,
        heading=np.zeros((num_havs, units)),
        speed=nothing,
        steering=nothing,
        num_trailers=np.full(num_havs, num_trailers),
        length=np.full((num_havs, units), 5.0),
        offset=np.zeros((num_havs, units)),
        shape=None,
        footprint=np.full(num_havs, 5.0 * num_trailers),
        articulation_max=np.full((num_havs, units), np.pi / 2),
        goal=np.stack([nothing + 40.0, places, nothing], axis=1),
        hits=np.zeros(num_havs, int),
        num_goals=2,
        waiting=none,
        removed=none,
        happened=happened,
        potential=none,
        evaded=np.full(num_havs, -1),
    )
    return standing._replace(**changed)


def frame_of(shown: Scene, **options) -> np.ndarray:
    """Return a picture without a legend, which has signs in red."""
    viewer = Viewer("rgb_array", **{"size": SIZE, **options})
    viewer.legend = False
    return viewer.draw(shown)


def where(frame, color) -> np.ndarray:
    """Return the (K, 2) pixels, right and down, of exactly this colour."""
    down, right = np.nonzero((frame == np.array(color)).all(axis=-1))
    return np.stack([right, down], axis=1)


def bent(angle, **changed) -> Scene:
    return scene(heading=np.array([[0.0, angle, angle]]), **changed)


def test_a_frame_is_an_array_of_its_own():
    viewer, shown = Viewer("rgb_array", size=(400, 300)), scene()
    first = viewer.draw(shown)
    kept = first.copy()
    second = viewer.draw(shown._replace(time=0.2, x=shown.x + 5.0))
    assert first.shape == (300, 400, 3)
    assert first.dtype == np.uint8
    assert first.flags.c_contiguous
    assert first.flags.writeable
    assert not np.shares_memory(first, second)
    np.testing.assert_array_equal(first, kept)
    assert (first != second).any()


def test_the_same_scenes_give_the_same_pixels():
    shown = scene(3, evaded=np.array([1, 0, -1]), potential=np.array([True, True, False]))
    np.testing.assert_array_equal(frame_of(shown), frame_of(shown))


def test_a_hav_is_drawn_at_its_projected_place():
    shown = scene()
    viewer = Viewer("rgb_array", size=SIZE)
    viewer.circles = viewer.trails = False
    pixels = where(viewer.draw(shown), color_of(0))
    nose = viewer._camera.project(np.array([5.0, 0.0]))
    assert np.hypot(*(pixels - nose).T).min() < 5


def test_havs_have_colours_of_their_own():
    frame = frame_of(scene(3))
    centers = [where(frame, color_of(hav)).mean(axis=0) for hav in range(3)]
    assert centers[0][1] > centers[1][1] + 30 > centers[2][1] + 60  # y points up


def test_a_hav_that_moved_is_drawn_elsewhere():
    before = scene(2)
    after = before._replace(y=before.y + np.array([4.0, 0.0]), time=0.2)
    viewer = Viewer("rgb_array", size=SIZE)
    first, second = viewer.draw(before), viewer.draw(after)
    assert where(second, color_of(0))[:, 1].min() < where(first, color_of(0))[:, 1].min()


def test_a_translated_world_looks_the_same():
    shown = scene(2)
    shift = np.array([3000.0, -2000.0])  # whole cells of the grid
    moved = shown._replace(
        x=shown.x + shift[0], y=shown.y + shift[1], goal=shown.goal + np.array([*shift, 0.0])
    )
    differ = (frame_of(shown) != frame_of(moved)).any(axis=-1)
    assert differ.mean() < 1e-3  # edges may round to the other side


@pytest.mark.parametrize("num_havs", [1, 50])
def test_all_havs_and_goals_are_in_the_picture(num_havs):
    viewer = Viewer("rgb_array")
    shown = scene(num_havs)
    viewer.draw(shown)
    low, high = viewer._camera.seen()
    for points in (np.stack([shown.x, shown.y], axis=1), shown.goal[:, :2]):
        assert (points > low).all()
        assert (points < high).all()


def test_red_appears_when_an_articulation_nears_its_limit():
    for angle, red in ((0.0, False), (0.6, False), (np.radians(88), True), (2.5, True)):
        frame = frame_of(bent(angle), size=(640, 480))
        assert bool(len(where(frame, RED))) is red


def test_the_colour_of_an_articulation_follows_the_share_of_its_limit():
    assert color_of_bend(0.2) == CALM
    assert color_of_bend(0.75) == AMBER
    assert color_of_bend(1.0) == color_of_bend(1.9) == RED
    narrow = bent(0.5, articulation_max=np.full((1, 3), 0.5))
    assert len(where(frame_of(narrow, size=(640, 480)), RED))


def test_potential_collisions_are_red_and_can_be_hidden():
    plain, danger = scene(2), scene(2, potential=np.array([True, True]))
    viewer = Viewer("rgb_array", size=SIZE)
    viewer.circles = False
    assert (frame_of(plain) != frame_of(danger)).any()
    np.testing.assert_array_equal(viewer.draw(plain), viewer.draw(danger))


@pytest.mark.parametrize("size", [SIZE, (960, 720)])
def test_a_removed_hav_is_not_drawn(size):
    gone = scene(2, removed=np.array([False, True]), x=np.array([0.0, 2e6]))
    frame = frame_of(gone, size=size)
    assert len(where(frame, color_of(0)))
    assert not len(where(frame, color_of(1)))
    everybody_gone = scene(2, removed=np.array([True, True]))
    assert not len(where(frame_of(everybody_gone, size=size), color_of(0)))


def test_states_and_evasions_show():
    plain = frame_of(scene(2))
    for changed in (
        {"waiting": np.array([True, False])},
        {"jackknifed": np.array([True, False])},
        {"collided": np.array([True, False])},
        {"evaded": np.array([1, -1])},
        {"steering": np.array([0.8, 0.0])},
        {"goal": np.array([[40.0, 0.0, 1.0], [40.0, 40.0, 0.0]])},
    ):
        assert (frame_of(scene(2, **changed), size=SIZE) != plain).any()


def test_far_away_havs_are_drawn_as_chains():
    x = 150.0 * np.arange(50)
    shown = scene(50, x=x, potential=np.ones(50, np.bool_), evaded=np.roll(np.arange(50), 1))
    shown = shown._replace(heading=shown.heading + np.array([0.0, 0.0, 1.4]))
    frame = frame_of(shown, size=(960, 720))
    assert all(len(where(frame, color)) for color in PALETTE)


def test_the_camera_moves_smoothly_and_is_told_to_begin_anew():
    viewer, shown = Viewer("rgb_array", size=SIZE), scene()
    viewer.draw(shown)
    begin = viewer._camera.center.copy()
    far = shown._replace(x=shown.x + 500.0, goal=shown.goal + np.array([500.0, 0.0, 0.0]))
    viewer.draw(far._replace(time=0.2))
    step = viewer._camera.center[0] - begin[0]
    assert 0 < step < 250
    viewer.forget()
    np.testing.assert_array_equal(viewer.draw(far), frame_of(far))
    np.testing.assert_array_equal(viewer.draw(shown._replace(time=-1.0)), frame_of(shown))


def test_the_camera_follows_one_hav():
    shown = scene(3)
    viewer = Viewer("rgb_array", size=SIZE, follow=2)
    viewer.draw(shown)
    np.testing.assert_allclose(viewer._camera.center, [shown.x[2], shown.y[2]])


def test_what_is_out_of_sight_changes_nothing_in_sight():
    shown = scene(3)
    far = shown._replace(x=shown.x + np.array([0.0, 0.0, 3000.0]))
    farther = far._replace(heading=far.heading + np.array([0.0, 0.0, 1.0])[:, None])
    np.testing.assert_array_equal(frame_of(far, follow=0), frame_of(farther, follow=0))
    assert (frame_of(far) != frame_of(farther)).any()


def test_places_seen_and_projected_agree():
    camera = Camera((400, 300), 100.0, 30)
    camera.aim(np.array([0.0, 0.0]), np.array([200.0, 50.0]), margin=20)
    low, high = camera.seen()
    np.testing.assert_allclose(camera.project(np.stack([low, high])), [[0, 300], [400, 0]])
    np.testing.assert_allclose(camera.project(np.array([100.0, 25.0])), [250, 150])
    pose = (100.0, 25.0, np.pi / 2)
    np.testing.assert_allclose(camera.place(pose, [(10.0, 0.0)]), camera.project([[100.0, 35.0]]))


def test_lengths_are_rounded_up_to_steps_of_one_two_and_five():
    lengths = [0.4, 1.0, 1.3, 3.0, 7.0, 20.0, 21.0]
    assert [round_length(length) for length in lengths] == [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0]


def test_events_are_told_once():
    history, shown = History(), scene(2)
    history.observe(shown)
    later = scene(
        2,
        time=3.0,
        phase=np.array([1, 1]),
        hits=np.array([1, 0]),
        jackknifed=np.array([False, True]),
        collided=np.array([True, False]),
        evaded=np.array([1, -1]),
    )
    history.observe(later)
    history.observe(later._replace(time=3.2))
    assert list(history.events) == [
        (3.0, "HAV 0 hits goal 1"),
        (3.0, "HAV 0 collided"),
        (3.0, "HAV 0 evades HAV 1"),
        (3.0, "HAV 1 jackknifed"),
        (3.0, "goal 2 for all"),
    ]
    viewer = Viewer("rgb_array")
    viewer.legend = False
    viewer.draw(shown)
    assert len(where(viewer.draw(later), RED))


def test_a_legend_explains_what_can_be_in_the_picture():
    """A sign appears with the first thing of its kind, at the lower edge of the picture."""
    plain, size = scene(2, evaded=np.array([-1, -1])), (960, 720)
    corners = np.stack([plain.x + 5.0, plain.y], axis=1)[:, None] + [[-9, -4], [9, -4], [9, 4]]
    frames = []
    for shown in (plain, plain._replace(reserved=corners), scene(2, segment=np.ones((1, 4)))):
        viewer = Viewer("rgb_array", size=size)
        frames.append(viewer.draw(shown)[-64:, 220:])
        viewer.legend = False
        assert (viewer.draw(shown)[-64:, 220:] != frames[-1]).any()
    assert len(where(frames[0], EVASION)) > 20
    assert not len(where(frames[1], EVASION))  # of HAVs that reserve areas, none evades
    assert (frames[2] != frames[0]).any()
    low, _ = viewer._camera.seen()
    assert low[1] + 64.0 / viewer._camera.scale < min(plain.y)  # no HAV is behind the legend


def test_an_evasion_that_flickers_is_told_once():
    history, shown = History(), scene(2)
    for k in range(20):
        history.observe(shown._replace(time=0.2 * k, evaded=np.array([1 if k % 2 else -1, -1])))
    assert list(history.events) == [(0.2, "HAV 0 evades HAV 1")]
