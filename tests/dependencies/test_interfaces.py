"""Checkers of environments pass with any release of them, and without Stable-Baselines3."""

import warnings

import gymnasium as gym
import pytest
from gymnasium.utils.env_checker import check_env

from hav_env.envs import hav_swarm_v0
from tests.support.budgets import budget

with warnings.catch_warnings():  # PettingZoo warns of the way in which it loads its own games
    warnings.simplefilter("ignore", DeprecationWarning)
    from pettingzoo.test import api_test, parallel_api_test, parallel_seed_test, render_test

# PettingZoo's checkers pass an option that no environment knows
pytestmark = pytest.mark.filterwarnings("ignore:reset ignores the option 'options':UserWarning")
CYCLES = budget(30, 3)


@pytest.mark.parametrize("name", ["hav_env:HAVSwarm-v0", "hav_env:HAVSingle-v0"])
def test_gymnasium(name):
    with gym.make(name) as env:
        check_env(env.unwrapped, skip_render_check=True)


def test_pettingzoo(monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    parallel_api_test(hav_swarm_v0.parallel_env(), num_cycles=CYCLES)
    parallel_seed_test(hav_swarm_v0.parallel_env, num_cycles=CYCLES)
    api_test(hav_swarm_v0.env(), num_cycles=CYCLES)
    render_test(hav_swarm_v0.env)
