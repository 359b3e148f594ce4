"""The checks of Gymnasium, PettingZoo and Stable-Baselines3 pass for these environments."""

import warnings

import gymnasium as gym
import pytest
from gymnasium.utils.env_checker import check_env
from stable_baselines3.common.env_checker import check_env as check_env_for_sb3

from hav_env import Observation, Task
from hav_env.envs import hav_swarm_v0
from tests.support.budgets import COMPILED, budget
from tests.support.worlds import side_by_side

with warnings.catch_warnings():  # PettingZoo warns of the way in which it loads its own games
    warnings.simplefilter("ignore", DeprecationWarning)
    from pettingzoo.test import (
        api_test,
        max_cycles_test,
        parallel_api_test,
        parallel_seed_test,
        render_test,
        seed_test,
        state_test,
    )

IDS = ("hav_env:HAVSwarm-v0", "hav_env:HAVSingle-v0")
# HAVs that leave one after another, wherever they turn
LEAVING = {
    "scenario": side_by_side(2.0, 3.0, 5.0),
    "task": Task(distance_tolerance=1.5, heading_tolerance=4.0),
    "on_goal": "remove",
}
# without compilation, the draw of a field takes seconds
_OF_REAL_PLACES = ("docks-6", *["field-4"] * COMPILED)
# real vehicles among obstacles, which their observations and rewards know
AMONG_OBSTACLES = {
    "vehicle": "realistic",
    "observation": Observation(obstacles=2, rays=8),
    "reward": "site",
}
LARGE = ("swarm-50",)  # each step takes a second without compilation
# of scenarios that differ in numbers alone, one is enough
_NAMED = ("paper-single", "paper-pair", "dense-10", "crossing-8", "yard-4", "column-5", *LARGE)
SETTINGS = {
    **{name: {"scenario": name} for name in _NAMED if COMPILED or name not in LARGE},
    "five": {"num_havs": 5},
    "leaving": LEAVING,
    "held": {"frame_skip": 3},
    "reported at ends": {"info": "ends"},
    "leaving, reported at ends": LEAVING | {"info": "ends"},
    "blind": {"observation": Observation(neighbors=0)},
    "chains": {"observation": Observation(neighbors=1, chains=True)},
    **{name: AMONG_OBSTACLES | {"scenario": name} for name in _OF_REAL_PLACES},
}
QUICK = ("paper-pair", "five", "leaving", "held", "reported at ends")  # few kinds of code


def cases(names):
    """Return parameters of a test: those of kinds of code that take long are exhaustive."""
    return [
        pytest.param(SETTINGS[k], id=k, marks=[] if k in QUICK else [pytest.mark.exhaustive])
        for k in names
    ]


settings = pytest.mark.parametrize("settings", cases(SETTINGS))
small_settings = pytest.mark.parametrize(
    "settings", cases(name for name in SETTINGS if name not in LARGE)
)

# PettingZoo's checkers pass an option that no environment knows
pytestmark = pytest.mark.filterwarnings("ignore:reset ignores the option 'options':UserWarning")


@pytest.fixture(autouse=True)
def no_display(monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")


def cycles(settings) -> int:
    """Return a sufficient number of actions: large swarms are slow in checkers."""
    large = settings.get("scenario") in LARGE
    return 5 if large else budget(60, 4)


def episodes(settings):
    """Return a function that makes an environment with short episodes."""
    return settings | {"max_cycles": cycles(settings)}


@pytest.mark.parametrize("name", IDS)
def test_gymnasium_finds_nothing_wrong_and_draws_in_every_mode(name):
    check_env(gym.make(name, max_steps=50).unwrapped)


@small_settings
@pytest.mark.parametrize("name", IDS)
def test_gymnasium_finds_nothing_wrong_whatever_the_scenario(name, settings):
    check_env(gym.make(name, **settings).unwrapped, skip_render_check=True)


@pytest.mark.parametrize("name", IDS)
def test_gymnasium_sees_through_its_own_wrappers_without_a_warning(name):
    env = gym.make(name, max_steps=20)  # the passive checker looks at the first calls
    env.reset(seed=1)
    over = False
    while not over:
        *_, terminated, truncated, _ = env.step(env.action_space.sample())
        over = terminated or truncated


@small_settings
def test_stable_baselines_finds_nothing_wrong(settings):
    check_env_for_sb3(gym.make(IDS[0], flatten=True, **settings).unwrapped, skip_render_check=True)
    check_env_for_sb3(gym.make(IDS[1], **settings).unwrapped, skip_render_check=True)


@settings
def test_the_parallel_interface_is_kept(settings):
    env = hav_swarm_v0.parallel_env(**episodes(settings))
    parallel_api_test(env, num_cycles=2 * cycles(settings))  # beyond an end


@settings
def test_the_interface_of_one_after_the_other_is_kept(settings):
    api_test(hav_swarm_v0.env(**episodes(settings)), num_cycles=2 * cycles(settings))


@small_settings
def test_a_seed_gives_the_same_episode(settings):
    def one_by_one(**options):
        return hav_swarm_v0.env(**episodes(settings), **options)

    def together(**options):
        return hav_swarm_v0.parallel_env(**episodes(settings), **options)

    parallel_seed_test(together, num_cycles=cycles(settings))
    seed_test(one_by_one, num_cycles=cycles(settings))


def test_an_episode_has_as_many_cycles_as_it_was_told():
    max_cycles_test(hav_swarm_v0)


@settings
def test_the_state_of_the_world_is_told(settings):
    made = episodes(settings)
    state_test(hav_swarm_v0.env(**made), hav_swarm_v0.parallel_env(**made))


def test_the_swarm_is_drawn_in_every_mode():
    render_test(hav_swarm_v0.env)


@pytest.mark.parametrize("num_havs", [1, 2, 5])
def test_a_swarm_is_drawn_whatever_its_size(num_havs):
    render_test(lambda **options: hav_swarm_v0.env(num_havs=num_havs, **options))
