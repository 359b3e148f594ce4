"""Targets of drawings: arrays without a display, windows, a line of text; and missing packages."""

import os
import subprocess
import sys

import numpy as np
import pygame
import pytest

from hav_env.rendering import describe, scene_of
from hav_env.rendering.viewer import Viewer
from hav_env.world.arrays import ACTUAL, JACKKNIFE, REMOVED
from tests.rendering.test_rendering import SIZE, frame_of, scene
from tests.support.paths import ROOT
from tests.support.worlds import aim, open_plane, put, stand


def test_an_unknown_render_mode_is_refused():
    with pytest.raises(ValueError, match="render_mode is 'rgb', but must be one of: human, rgb"):
        Viewer("rgb")
    with pytest.raises(ValueError, match="must be from 1 to 8192 pixels"):
        Viewer("rgb_array", size=(0, 100))


def test_closing_twice_is_fine():
    viewer = Viewer("rgb_array", size=SIZE)
    viewer.draw(scene())
    viewer.close()
    viewer.close()
    assert viewer.draw(scene()) is None


def run_python(code: str, **variables) -> str:
    hidden = ("DISPLAY", "WAYLAND_DISPLAY")
    kept = {k: v for k, v in os.environ.items() if not k.startswith("SDL_") and k not in hidden}
    command = [sys.executable, "-c", code]
    done = subprocess.run(
        command, env=kept | variables, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_arrays_need_no_display_and_say_nothing():
    code = f"""
import sys
sys.path.insert(0, {str(ROOT)!r})
import pygame
from tests.rendering import test_rendering
frame = test_rendering.frame_of(test_rendering.scene())
assert frame.any() and not pygame.display.get_init()
"""
    run_python(code)
    assert run_python("import hav_env.rendering.viewer") == ""


def test_without_pygame_it_is_said_what_is_missing():
    code = """
import sys
sys.modules["pygame"] = None
try:
    import hav_env.rendering.viewer
except ImportError as error:
    print(error)
"""
    assert (
        run_python(code)
        == "rendering needs pygame-ce: run pip install -e '.[rendering]' in the clone\n"
    )


def test_the_simulator_imports_no_pygame():
    code = (
        "import sys, hav_env, hav_env.rendering, hav_env.cli.play; print('pygame' in sys.modules)"
    )
    assert run_python(code).strip() == "False"


@pytest.fixture
def window(monkeypatch):
    """Return a viewer with an invisible window."""
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    viewer = Viewer("human", size=SIZE, frames_per_second=1000)
    yield viewer
    viewer.close()


def press(key) -> None:
    pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=key))


def test_a_window_opens_and_closes(window):
    assert window.draw(scene()) is None
    assert pygame.display.get_surface().get_size() == SIZE
    window.close()
    assert not pygame.display.get_init()
    window.close()


def test_the_close_button_ends_the_drawing(window):
    window.draw(scene())
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    window.draw(scene())
    assert window.closed
    assert not pygame.display.get_init()
    assert window.draw(scene()) is None


def test_keys_change_what_is_seen(window):
    shown = scene(2)
    window.draw(shown)
    followed = []
    for _ in range(3):
        press(pygame.K_f)
        window.draw(shown)
        followed.append(window.follow)
    assert followed == [0, 1, None]
    for key in (pygame.K_t, pygame.K_c, pygame.K_PLUS, pygame.K_MINUS, pygame.K_PLUS):
        press(key)
    window.draw(shown)
    assert (window.trails, window.circles) == (False, False)
    scale = window._camera.scale
    for _ in range(500):
        window.draw(shown)
    assert window._camera.scale > scale


def test_space_pauses_until_space(window):
    shown = scene()
    window.draw(shown)
    press(pygame.K_SPACE)
    press(pygame.K_SPACE)
    window.draw(shown)
    assert not window._paused
    press(pygame.K_SPACE)
    tick = window._clock

    class Clock:
        ticks = 0

        def tick(self, rate):
            self.ticks += 1
            if self.ticks == 5:
                press(pygame.K_SPACE)
            tick.tick(rate)

    window._clock = Clock()
    window.draw(shown)
    assert window._clock.ticks > 5


def test_a_scene_shows_the_world_of_a_batch():
    batch = open_plane(2, 2, 3, goals=2)
    put(batch.worlds, [4.0, 6.0, 5.0], 1.0, 2.0, [0.1, 0.2, 0.3], w=1)
    put(batch.worlds, [3.0, 6.0, 5.0], 20.0, 2.0, w=1, agent=1)
    aim(batch.worlds, 0, 1, 9.0, 8.0, 0.7)
    stand(batch, 5)
    seen = scene_of(batch.worlds, 1, 0.2, np.array([1, -1]))
    assert (seen.time, seen.phase.tolist(), seen.num_goals) == (1.0, [0, 0], 2)
    np.testing.assert_allclose(seen.x, [1.0, 20.0])
    np.testing.assert_allclose(seen.heading[0, :3], [0.1, 0.2, 0.3])
    np.testing.assert_allclose(seen.goal[0], [9.0, 8.0, 0.7])
    np.testing.assert_array_equal(seen.potential, [True, True])
    np.testing.assert_array_equal(seen.hits, [0, 0])
    np.testing.assert_array_equal(seen.evaded, [1, -1])
    assert not (
        seen.removed | seen.happened[:, [JACKKNIFE, ACTUAL]].any(axis=1) | seen.waiting
    ).any()
    put(batch.worlds, [3.0, 6.0, 5.0], -2e6, 2.0, w=1, agent=1)
    far = scene_of(batch.worlds, 1, 0.2)
    np.testing.assert_array_equal(far.removed, [False, False])  # only far away
    batch.worlds.record.total[1, REMOVED, 1] = 1.0
    batch.worlds.state.waiting[0, 1] = True
    np.testing.assert_allclose(seen.x, [1.0, 20.0])  # a copy
    parked = scene_of(batch.worlds, 1, 0.2, np.array([1, 0]))
    np.testing.assert_array_equal(parked.removed, [False, True])
    np.testing.assert_array_equal(parked.potential, [False, False])
    np.testing.assert_array_equal(parked.evaded, [-1, -1])  # a waiting or removed HAV evades none
    assert frame_of(parked).any()


def test_one_line_tells_what_there_is_to_see():
    shown = scene(
        2,
        time=12.4,
        goal=np.array([[10.0, 10.0, 0.0], [-5.0, 40.0, 0.0]]),
        heading=np.array([[0.0, 0.0, np.radians(34)], [0.0, 0.0, 0.0]]),
        evaded=np.array([1, -1]),
        waiting=np.array([False, True]),
        jackknifed=np.array([True, False]),
    )
    assert describe(shown) == (
        "12.4 s; HAV 0 goal 1/2 14.1 m ahead-left, bend 34/90 deg, evades HAV 1, jackknifed;"
        " HAV 1 goal 1/2 5.0 m behind, bend 0/90 deg, waits"
    )
    gone = scene(1, removed=np.array([True]), collided=np.array([True]))
    assert describe(gone) == "0.0 s; HAV 0 removed"


def test_a_swarm_is_told_in_counts():
    flags = np.arange(50) < 3
    swarm = scene(50, phase=np.ones(50, int), waiting=flags, collided=flags)
    assert describe(swarm) == "0.0 s; goal 2/2; 50 HAVs: 3 at goal, 3 collided"
    assert describe(scene(50)) == "0.0 s; goal 1/2; 50 HAVs: all under way"
