"""Driving by keyboard: the effect of held keys on the action, and the begin and end of episodes."""

import numpy as np
import pytest

from hav_env.__main__ import main
from hav_env.cli import play
from hav_env.cli.play import STANDING_ACTION, Controls, Play, drive, next_action, watch_keyboard

NOTHING = frozenset()


def hold(*names, action=STANDING_ACTION, frames=1):
    """Return the action after some frames with these keys held."""
    action = np.array(action)
    for _ in range(frames):
        action = next_action(frozenset(names), action)
    return action


def test_actions_stay_in_their_range():
    np.testing.assert_array_equal(hold("faster", "left", frames=100), [1, 1])
    np.testing.assert_array_equal(
        hold("slower", "right", action=(1.0, 1.0), frames=100), [-1.0, -1.0]
    )
    assert hold().dtype == np.float32


def test_the_speed_stays_and_the_steering_returns():
    speed, steering = hold(action=(0.3, 0.9), frames=100)
    assert speed == pytest.approx(0.3)
    assert steering == 0.0
    one = hold(action=(0.3, 0.9))
    assert one[1] == pytest.approx(0.9 - Controls().release)


def test_opposite_keys_cancel():
    np.testing.assert_allclose(hold("left", "right", "faster", "slower", action=(0.1, 0)), [0.1, 0])


def test_left_mirrors_right():
    left, right = hold("left", action=(0.0, 0.2)), hold("right", action=(0.0, -0.2))
    np.testing.assert_array_equal(left, right * [1, -1])


class Road:
    """An environment that ends after three steps and records its calls."""

    def __init__(self, **info):
        """Take the info of every step."""
        self.calls, self.actions, self.info, self.left = [], [], info, 0

    def reset(self, *, seed=None):
        self.calls.append(f"reset {seed}")
        self.left = 3
        self.render()
        return None, {}

    def step(self, action):
        self.calls.append("step")
        self.actions.append(action)
        self.left -= 1
        self.render()
        return None, 0.0, self.left == 0, False, self.info

    def render(self):
        self.calls.append("render")

    def close(self):
        self.calls.append("close")


def test_every_frame_is_rendered_and_an_episode_ends_once():
    road, told = Road(is_success=True), []
    frames = [NOTHING] + 6 * [frozenset({"faster"})]
    assert drive(road, frames, seed=7, tell=told.append) == 1
    assert road.calls == ["reset 7", "render"] + 3 * ["step", "render"] + 3 * ["render"]
    assert told == ["goals reached; R begins a new episode"]
    assert [action[0] for action in road.actions] == sorted(action[0] for action in road.actions)


def test_a_held_key_begins_one_new_episode():
    road, again = Road(), frozenset({"again"})
    assert drive(road, [NOTHING, again, again, NOTHING, again], seed=3, tell=print) == 3
    assert [call for call in road.calls if "reset" in call] == ["reset 3", "reset 4", "reset 5"]


def test_quit_ends_at_once():
    road = Road()
    assert drive(road, iter([NOTHING, frozenset({"quit"}), NOTHING])) == 1
    assert road.calls == ["reset 0", "render"]


@pytest.mark.parametrize(
    ("info", "told"),
    [
        ({"jackknifed": True, "actual_collision": True}, "jackknifed, collided"),
        ({"obstacle_collision": True}, "hit an obstacle"),
        ({}, "time is over"),
    ],
)
def test_the_end_of_an_episode_is_told(info, told):
    lines = []
    drive(Road(**info), 5 * [NOTHING], tell=lines.append)
    assert lines == [f"{told}; R begins a new episode"]


@pytest.fixture
def keyboard(monkeypatch):
    """Return pygame with an invisible window."""
    import pygame

    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    yield pygame
    pygame.display.quit()


def test_keys_are_watched_while_there_is_a_window(keyboard, monkeypatch):
    frames = watch_keyboard()
    assert next(frames) == NOTHING
    keyboard.display.init()
    keyboard.display.set_mode((80, 60))
    assert next(frames) == NOTHING
    held = {keyboard.K_w, keyboard.K_LEFT, keyboard.K_ESCAPE}

    class Pressed:
        def __getitem__(self, key):
            return key in held

    monkeypatch.setattr(keyboard.key, "get_pressed", Pressed)
    assert next(frames) == {"faster", "left", "quit"}
    keyboard.display.quit()
    assert list(frames) == []


def test_the_close_button_ends_the_driving(keyboard):
    from hav_env.rendering.viewer import Viewer
    from tests.rendering.test_rendering import SIZE, scene

    class Drawn(Road):
        viewer = Viewer("human", size=SIZE, frames_per_second=1000)

        def render(self):
            super().render()
            self.viewer.draw(scene())
            if self.calls.count("render") == 3:
                keyboard.event.post(keyboard.event.Event(keyboard.QUIT))

    road = Drawn()
    assert drive(road, watch_keyboard()) == 1
    assert road.calls.count("render") == 4
    assert road.viewer.closed


def test_play_closes_the_environment(monkeypatch, keyboard):
    roads = {"human": Road(), None: Road()}
    monkeypatch.setattr(play, "open_environment", lambda options, mode="human": roads[mode])
    assert main(["play", "--seed", "5"]) == 0  # no window opens, so it ends after a frame
    assert roads["human"].calls == ["reset 5", "render", "close"]
    assert roads[None].calls[0] == "reset 5"  # compiled without a window first
    assert "step" in roads[None].calls


def test_one_hav_of_the_real_environment_is_driven_among_others(monkeypatch, keyboard):
    env = play.open_environment(Play(num_havs=3, scenario="crossing-8"))
    frames = [NOTHING] + 20 * [frozenset({"faster", "left"})]
    try:
        assert drive(env, frames) == 1
        state = env.unwrapped._world.process.batch.worlds.state
        assert state.x.shape == (3, 1)
        assert (state.speed > 0.0).all()
        assert state.steering[0, 0] > 0.0
    finally:
        env.close()


def test_the_window_names_every_key_and_the_hav_of_the_user(keyboard):
    env = play.open_environment(Play(num_havs=2), "rgb_array")
    try:
        env.reset(seed=0)
        shown = env.render()
        told = " ".join(play.PLAY_KEYS).lower()
        assert all(word in told for word in ("speed", "steering", "episode", "zoom", "pause"))
        screen = env.unwrapped._world.screen
        viewer = screen._viewers[0]
        assert (viewer.caption, viewer.own) == (play.PLAY_KEYS, 0)
        viewer.caption, viewer.own = (), None
        bare = env.render()
        differs = (shown != bare).any(axis=2)
        corner = differs[:140, -260:]
        assert corner.mean() > 0.02  # the keys
        assert differs.sum() > corner.sum()  # the mark round the HAV
    finally:
        env.close()


def test_options_come_from_the_command_line(monkeypatch, capsys):
    asked = []
    monkeypatch.setattr(play, "play", asked.append)
    command = ["play", "--num-havs", "7", "--others", "random", "--scenario", "swarm-10"]
    assert main(command) == 0
    assert asked == [Play(7, "swarm-10", others="random")]
    for words in (["fly"], ["play", "--spead", "3"], ["play", "--seed", "soon"]):
        assert main(words) == 2
        captured = capsys.readouterr()
        assert captured.out == ""
        assert captured.err.startswith("error: ")
        assert captured.err.count("\n") == 1


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--num-havs", "0"], "num_havs is 0"),
        (["--num-havs", "-2"], "num_havs is -2"),
        (["--num-havs", "2.5"], ""),
        (["--num-havs", "nan"], ""),
        (["--num-havs", "0", "--scenario", "swarm-5"], "num_havs is 0"),
        (["--seed", "-1"], "seed is -1"),
        (["--seed", "4294967296"], "seed is 4294967296"),
        (["--seed", "nan"], ""),
        (["--seed", "1.5"], ""),
        (["--others", "ghost"], "unknown policy 'ghost'"),
        (["--scenario", "moon"], "unknown scenario 'moon'"),
        (["--scenario", "no.json"], "no scenario file no.json"),
    ],
    ids=lambda part: " ".join(part) if isinstance(part, list) else "",
)
def test_what_cannot_be_played_is_refused_before_a_window_opens(words, told, keyboard, capsys):
    keyboard.display.quit()
    assert main(["play", *words]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith("error: ")
    assert captured.err.count("\n") == 1
    assert told in captured.err
    assert not keyboard.display.get_init()


def test_after_the_last_seed_comes_the_first():
    road, again = Road(), frozenset({"again"})
    drive(road, [NOTHING, again], seed=2**32 - 1, tell=print)
    assert [call for call in road.calls if "reset" in call] == ["reset 4294967295", "reset 0"]
