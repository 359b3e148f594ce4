"""Pictures and windows: copies after a rendering, several windows, other libraries, no display."""

import copy
import os
import pickle
import subprocess
import sys

import cloudpickle
import gymnasium as gym
import numpy as np
import pygame
import pytest

from hav_env import parallel_env
from hav_env.rendering.viewer import Viewer
from tests.support.comparing import exactly

FACES = {
    "parallel": parallel_env,
    "swarm": lambda **settings: gym.make("hav_env:HAVSwarm-v0", **settings).unwrapped,
    "single": lambda **settings: gym.make("hav_env:HAVSingle-v0", **settings).unwrapped,
    "swarms": lambda **settings: gym.make_vec("hav_env:HAVSwarm-v0", num_envs=2, **settings),
}
WAYS = {
    "deepcopy": copy.deepcopy,
    "cloudpickle": lambda env: pickle.loads(cloudpickle.dumps(env)),
    **{
        f"protocol {k}": lambda env, k=k: pickle.loads(pickle.dumps(env, protocol=k))
        for k in range(2, pickle.HIGHEST_PROTOCOL + 1)
    },
}


@pytest.fixture(autouse=True)
def unseen(monkeypatch):
    """Open invisible windows."""
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    yield
    pygame.display.quit()


def drive(env, steps):
    """Step and render; return the results and the pictures."""
    told = []
    for k in range(steps):
        if hasattr(env, "possible_agents"):
            actions = {agent: np.array([1.0, 0.1 * k]) for agent in env.agents}
        else:
            actions = np.full(env.action_space.shape, 0.1 * k + 0.2)
        told += [exactly(env.step(actions)), exactly(env.render())]
    return told


@pytest.mark.parametrize(
    ("face", "way"),
    [
        *(("parallel", way) for way in ("deepcopy", "cloudpickle", "protocol 5")),
        *(
            pytest.param("parallel", f"protocol {k}", marks=pytest.mark.exhaustive)
            for k in range(2, 5)
        ),
        *(
            (face, way)
            for face in FACES
            for way in ("deepcopy", "protocol 5")
            if face != "parallel"
        ),
    ],
)
@pytest.mark.parametrize("render_mode", [None, "ansi", "rgb_array", "human"])
def test_a_copy_goes_on_as_the_environment_does_and_looks_the_same(face, way, render_mode):
    if face == "swarms" and render_mode == "human":
        pytest.skip("a vector has no window")
    env, again = FACES[face](render_mode=render_mode), WAYS[way]
    fresh = again(env)
    env.reset(seed=4)
    begun = again(env)
    fresh.reset(seed=4)
    assert drive(env, 2) == drive(begun, 2) == drive(fresh, 2)
    later = again(again(env))
    assert drive(env, 2) == drive(later, 2)
    for one in (env, fresh, begun, later):
        one.close()


def test_copies_do_not_share_their_pictures():
    env = parallel_env(render_mode="rgb_array")
    env.reset(seed=0)
    before = env.render()
    twin = copy.deepcopy(env)
    drive(twin, 20)
    assert np.array_equal(env.render(), before)


def humans(number):
    made = [parallel_env(render_mode="human") for _ in range(number)]
    for env in made:
        env.reset(seed=0)
    return made


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 0, 2)])
def test_windows_survive_each_other_in_any_order(order):
    made = humans(3)
    for k in range(3):
        made[order[k]].close()
        for still in order[k + 1 :]:
            drive(made[still], 2)
        assert pygame.display.get_init() == (k < 2)


def test_a_window_opens_again_after_its_closing():
    (env,) = humans(1)
    env.close()
    drive(env, 2)
    assert pygame.display.get_surface() is not None
    env.close()
    env.close()


def test_the_close_button_is_for_all_that_share_the_window():
    first, second = humans(2)
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    drive(first, 1)
    drive(second, 1)
    assert not pygame.display.get_init()
    drive(first, 2)
    assert not pygame.display.get_init()
    (third,) = humans(1)
    assert pygame.display.get_init()
    third.close()


@pytest.mark.parametrize("quit_it", [pygame.display.quit, pygame.quit, pygame.font.quit])
@pytest.mark.parametrize(
    ("render_mode", "begin_it"),
    [
        ("human", None),
        *(
            pytest.param("human", begin, marks=pytest.mark.exhaustive)
            for begin in (pygame.init, pygame.display.init)
        ),
        *(("rgb_array", begin) for begin in (None, pygame.init, pygame.display.init)),
    ],
)
def test_drawing_survives_that_somebody_else_quits_pygame(render_mode, begin_it, quit_it):
    env, twin = (parallel_env(render_mode=render_mode) for _ in range(2))
    told = []
    for one in (env, twin):
        one.reset(seed=0)
        drive(one, 2)
        if one is env:
            quit_it()
            if begin_it is not None:
                begin_it()
        told.append(drive(one, 2))
        told.append(drive(one, 2))
        one.close()
    assert told[:2] == told[2:]


def test_a_window_of_another_library_is_not_ours_to_close():
    (env,) = humans(1)
    other = pygame.display.set_mode((320, 200))  # takes the window over
    drive(env, 1)
    other = pygame.display.set_mode((320, 200))
    env.close()
    other.fill((0, 0, 0))
    pygame.display.flip()


def test_cart_pole_and_we_do_not_close_each_other():
    for ours_first in (True, False):
        cart = gym.make("CartPole-v1", render_mode="human")
        (env,) = humans(1)
        cart.reset(seed=0)
        drive(env, 1)
        cart.step(0)
        (env if ours_first else cart).close()
        if ours_first:
            cart.step(0)
            cart.close()
        else:
            drive(env, 2)
            env.close()


def run_python(code, **variables):
    hidden = ("DISPLAY", "WAYLAND_DISPLAY")
    kept = {k: v for k, v in os.environ.items() if not k.startswith("SDL_") and k not in hidden}
    return subprocess.run(
        [sys.executable, "-c", code],
        env=kept | variables,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("variables", [{}, {"SDL_VIDEODRIVER": "x11"}])
def test_without_a_display_a_window_is_refused_in_one_line(variables):
    code = """
import hav_env
env = hav_env.parallel_env(render_mode="human")
try:
    env.reset(seed=0)
except OSError as error:
    print(error)
"""
    done = run_python(code, **variables)
    assert done.stdout.startswith("render_mode is human, but there is no display: use rgb_array")
    assert done.stdout.count("\n") == 1


@pytest.mark.parametrize("size", [(0, 100), (-5, 5), (100, 10**9), (np.nan, 5)])
def test_a_size_that_cannot_be_is_named(size):
    with pytest.raises(ValueError, match=r"size is .*, but must be from 1 to"):
        Viewer("rgb_array", size=size)


@pytest.mark.parametrize("rate", [0, -1, np.nan, np.inf, 1e9])
def test_a_rate_that_cannot_be_is_named(rate):
    with pytest.raises(ValueError, match=r"frames_per_second is .*, but must be above 0"):
        Viewer("human", frames_per_second=rate)
