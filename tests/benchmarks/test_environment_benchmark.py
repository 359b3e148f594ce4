"""The benchmark of the environments compares like with like; no test asserts speed."""

import json

import gymnasium as gym
import numpy as np
import pytest

import hav_env
from benchmarks.environments import as_json
from benchmarks.interfaces.aims import FAST, find_aims
from benchmarks.interfaces.clocks import clocked, spread_ends
from benchmarks.interfaces.empty import EmptyParallelEnv, make_empty
from benchmarks.interfaces.faces import (
    ENDS,
    HAVS,
    IN_SINGLE,
    PARALLEL,
    PARALLEL_EMPTY,
    PARALLEL_SHORT,
    SHORT,
    SWARM,
    Vector,
    empty,
    made,
)
from benchmarks.interfaces.fresh_process import import_hav_env
from benchmarks.interfaces.peers import MPE_SPREAD, NAVIGATION, Peer

FASTEST = SWARM + ENDS + IN_SINGLE


def kinds(value):
    """Return the types in nested dictionaries and tuples, and the shapes of arrays."""
    if isinstance(value, dict):
        return {key: kinds(inner) for key, inner in value.items()}
    if isinstance(value, tuple):
        return [kinds(inner) for inner in value]
    return (value.dtype, value.shape) if isinstance(value, np.ndarray) else type(value)


def wrappers(env):
    """Return the types of an environment's wrappers."""
    found = []
    while isinstance(env, gym.Wrapper):
        found.append(type(env))
        env = env.env
    return found


@pytest.mark.parametrize("name", HAVS)
def test_the_empty_environment_returns_what_the_real_one_does(name):
    real, idle = gym.make(f"hav_env:{name}"), make_empty(f"hav_env:{name}")
    assert wrappers(idle) == wrappers(real) != []
    assert idle.observation_space == real.observation_space
    assert idle.action_space == real.action_space
    assert kinds(idle.reset(seed=0)) == kinds(real.reset(seed=0))
    action = real.action_space.sample()
    assert kinds(idle.step(action)) == kinds(real.step(action))


def test_the_empty_parallel_environment_returns_what_the_real_one_does():
    real = hav_env.parallel_env()
    idle = EmptyParallelEnv(hav_env.parallel_env())
    assert kinds(idle.reset(seed=0)) == kinds(real.reset(seed=0))
    assert idle.agents == real.agents
    actions = {agent: real.action_space(agent).sample() for agent in real.agents}
    assert kinds(idle.step(actions)) == kinds(real.step(actions))


def test_the_clock_counts_who_acted_and_takes_one_action_at_least():
    taken = []
    assert clocked(lambda action: taken.append(action) or 0, ["first", "second"], 0.0) == 0.0
    assert taken == ["first"]


def test_episodes_that_are_spread_end_in_equal_numbers_at_every_step():
    env = gym.make_vec("hav_env:HAVSwarm-v0", num_envs=9, max_steps=2)
    actions = np.zeros(env.action_space.shape)
    env.reset(seed=0)
    assert spread_ends(env, actions, 2) == 3
    for _ in range(4):
        _, _, terminated, truncated, _ = env.step(actions)
        assert np.count_nonzero(terminated | truncated) == 3


def made_up_rates():
    """Return rates of all that the aims need, but for the peers."""
    rates = {Vector(SWARM, 1_024, 2): 6e6, Vector(SWARM, 4_096, 2): 8e6, Vector(SWARM, 64, 1): 9e6}
    rates |= {Vector(SWARM, 1_024, 2, SHORT): 4e6, Vector(SWARM, 4_096, 1): 9e6}
    rates |= {Vector(FASTEST, 4_096, 2): 16e6, Vector(FASTEST, 1_024, 2, SHORT): 12e6}
    rates |= {PARALLEL: 50.0, PARALLEL_SHORT: 40.0, PARALLEL_EMPTY: 200.0}
    return rates | {name(env): 50.0 for name in (made, empty) for env in HAVS}


def test_the_best_batches_are_compared():
    peers = {Peer(MPE_SPREAD): 5.0, Peer(NAVIGATION, 1_024, 1): 1e6, Peer(NAVIGATION, 64, 2): 2e6}
    found = {aim.what: aim for aim in find_aims(made_up_rates() | peers, 0.5)}
    assert found["vector"][4:6] == (8e6, 4e6)
    assert found["vector"].reached
    assert found[f"vector : {NAVIGATION}"][4:6] == (4.0, 2.0)
    assert found[f"vector : {NAVIGATION}"].reached is False
    assert found[FAST].reached
    assert found[f"{FAST} : {NAVIGATION}"][4:6] == (8.0, 6.0)
    assert found[f"{FAST}, short episodes : long"][4] == 0.75
    assert found["vector, short episodes : long"].reached is False
    assert found[f"PettingZoo : {MPE_SPREAD}"][4:6] == (10.0, 8.0)
    assert found["PettingZoo : empty"].reached is False
    assert found["import hav_env"].reached


def test_what_has_no_peer_is_not_judged_and_the_rest_is_written():
    rates = made_up_rates()
    found = find_aims(rates, 2.0)
    assert [aim.reached for aim in found if MPE_SPREAD in aim.what or "VMAS" in aim.what] == [
        *(None,) * 6
    ]
    assert found[-1].reached is False
    written = json.loads(json.dumps(as_json(rates, 2.0, [], found)))
    assert len(written["vector"]) == 7
    assert written["aims"][0]["reached"] is True


def test_importing_hav_env_loads_nothing_heavy():
    _, loaded = import_hav_env()
    assert loaded == []
