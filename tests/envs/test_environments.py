"""Laws of every environment that external checkers do not test."""

import gymnasium as gym
import numpy as np
import pytest

from hav_env import Observation, Task, parallel_env
from hav_env.envs.gymnasium_vector import HAVSwarmVectorEnv
from hav_env.policies.driver import PolicyDriver
from hav_env.world.arrays import SPEED, STEERING
from tests.support.budgets import budget
from tests.support.comparing import exactly, leaves
from tests.support.worlds import side_by_side


def single(name):
    return lambda **settings: gym.make(f"hav_env:{name}-v0", **settings).unwrapped


def vector(name, **always):
    return lambda **settings: gym.make_vec(f"hav_env:{name}-v0", num_envs=3, **settings, **always)


FACES = {
    "parallel": parallel_env,
    "swarm": single("HAVSwarm"),
    "single": single("HAVSingle"),
    "swarms": vector("HAVSwarm"),
    "singles": vector("HAVSingle"),
    "swarms at once": vector("HAVSwarm", autoreset_mode="SameStep"),
    "singles at once": vector("HAVSingle", autoreset_mode="SameStep"),
}
faces = pytest.mark.parametrize("face", list(FACES.values()), ids=FACES)


def draw(env, rng):
    """Return random actions, all of them valid."""
    if hasattr(env, "possible_agents"):
        return {agent: rng.uniform(-1, 1, 2).astype(np.float32) for agent in env.agents}
    return rng.uniform(-1, 1, env.action_space.shape).astype(np.float32)


def over(env, outcome):
    if hasattr(env, "possible_agents"):
        return not env.agents
    return not hasattr(env, "num_envs") and (outcome[2] or outcome[3])


def play(env, steps, seed=5):
    """Yield the results of an environment, from reset to reset."""
    rng = np.random.default_rng(seed)
    yield env.reset(seed=seed)
    for _ in range(steps):
        outcome = env.step(draw(env, rng))
        yield outcome
        if over(env, outcome):
            yield env.reset()


@faces
def test_two_instances_with_one_seed_agree_in_every_bit_of_500_steps(face):
    steps = budget(500, 25)
    made = [face(max_steps=steps // 3, num_havs=3) for _ in range(2)]
    for one, other in zip(*(play(env, steps) for env in made), strict=True):
        assert exactly(one) == exactly(other)


@faces
def test_another_seed_is_another_episode(face):
    (one, _), (other, _) = (face().reset(seed=seed) for seed in (1, 2))
    assert exactly(one) != exactly(other)


@faces
def test_no_two_returns_share_memory(face):
    env, before = face(max_steps=4, num_havs=2), []
    for outcome in play(env, 12):
        arrays = [part for part in leaves(outcome).values() if isinstance(part, np.ndarray)]
        assert arrays
        for array in arrays:
            assert not any(np.shares_memory(array, earlier) for earlier in before)
        before += arrays


@faces
def test_what_was_returned_does_not_change_any_more(face):
    env, kept = face(max_steps=4, num_havs=2), []
    for outcome in play(env, 12):
        kept.append((outcome, exactly(outcome)))
    assert all(exactly(outcome) == then for outcome, then in kept)


@faces
def test_what_is_done_to_a_return_does_not_matter(face):
    made = [face(max_steps=4, num_havs=2) for _ in range(2)]
    for touched, left_alone in zip(*(play(env, 12) for env in made), strict=True):
        assert exactly(touched) == exactly(left_alone)
        for part in leaves(touched).values():
            if isinstance(part, np.ndarray):
                part[...] = 1


def info_of(outcome):
    return outcome[-1]


# names under which wrappers and trainers write their own entries
RESERVED = {"episode", "final_obs", "final_info", "terminal_observation", "TimeLimit.truncated"}


@faces
def test_no_number_has_a_name_that_others_have_taken(face):
    env = face()
    env.reset(seed=0)
    names = (env if hasattr(env, "_process") else env._world).__dict__
    info = names["_process" if "_process" in names else "process"].info
    assert len(set(info)) == len(info)
    assert not RESERVED & set(info)
    assert not [name for name in info if name.startswith("_")]


def test_infos_of_agents_are_floats_under_the_same_names_at_every_step():
    env = parallel_env(num_havs=3, max_steps=5)
    names = list(env.reset(seed=0)[1]["hav_0"])
    assert len(names) > 10
    for outcome in play(env, 20):
        for info in info_of(outcome).values():
            assert list(info) == names
            assert {type(value) for value in info.values()} == {float}


def test_infos_of_one_hav_are_floats_and_those_of_a_swarm_arrays():
    alone, swarm = FACES["single"](max_steps=5), FACES["swarm"](num_havs=3, max_steps=5)
    names = list(alone.reset(seed=0)[1])
    for outcome in play(alone, 20):
        assert list(info_of(outcome)) == names
        assert {type(value) for value in info_of(outcome).values()} == {float}
    for outcome in play(swarm, 20):
        assert list(info_of(outcome)) == names
        for value in info_of(outcome).values():
            assert (value.dtype, value.shape) == (np.float64, (3,))


def test_flags_and_rewards_have_the_types_of_python():
    for outcome in play(parallel_env(max_steps=5), 20):
        if len(outcome) == 5:
            _, rewards, terminations, truncations, _ = outcome
            assert {type(reward) for reward in rewards.values()} == {float}
            flags = [*terminations.values(), *truncations.values()]
            assert {type(flag) for flag in flags} == {bool}
    for name in ("swarm", "single"):
        for outcome in play(FACES[name](max_steps=5), 20):
            if len(outcome) == 5:
                assert list(map(type, outcome[1:4])) == [float, bool, bool]


@pytest.mark.parametrize("team_reward", ["sum", "mean", "min"])
def test_returns_by_term_grow_by_the_rewards(team_reward):
    env = FACES["swarm"](num_havs=3, team_reward=team_reward)
    _, info = env.reset(seed=3)
    rng, together = np.random.default_rng(0), {"sum": sum, "mean": np.mean, "min": min}

    def returns(info):
        return sum(value for name, value in info.items() if name.startswith("return_"))

    before = returns(info)
    assert (before == 0.0).all()
    for _ in range(budget(300, 20)):
        _, reward, _, _, info = env.step(draw(env, rng))
        gained = returns(info) - before
        assert reward == pytest.approx(together[team_reward](gained), abs=1e-9)
        before = returns(info)


def test_after_the_end_nobody_acts_and_nothing_is_told():
    env = parallel_env(scenario=side_by_side(0.6, 0.6))
    env.reset(seed=0)
    while env.agents:
        outcome = env.step(dict.fromkeys(env.agents, np.array([1.0, 0.0])))
    assert set(outcome[2].values()) == {True}
    for _ in range(3):
        assert env.step({}) == ({}, {}, {}, {}, {})
    observations, infos = env.reset()
    assert list(observations) == list(infos) == env.agents == ["hav_0", "hav_1"]


@pytest.mark.parametrize(
    "scenario",
    [
        "paper-single",
        "paper-pair",
        "crossing-8",
        pytest.param("yard-4", marks=pytest.mark.exhaustive),
    ],
)
def test_no_episode_is_over_when_it_begins(scenario):
    worlds = budget(1_000, 20)
    rules = dict.fromkeys(("on_collision", "on_jackknife"), "end")
    env = HAVSwarmVectorEnv(worlds, scenario=scenario, autoreset_mode="Disabled", **rules)
    _, info = env.reset(seed=1)
    for name in ("waits", "goals_hit", "is_success", "jackknifed", "potential_collision"):
        assert not info[name].any()
    standing = np.zeros(env.action_space.shape)
    standing[..., 0] = -1.0
    _, _, terminated, truncated, _ = env.step(standing)
    assert not (terminated | truncated).any()


def random_actions(env, rng):
    return lambda: rng.uniform(-1.0, 1.0, env.action_space.shape)


def avoid_jack(env, rng):
    batch = env._process.batch
    driver, limit = PolicyDriver("avoid_jack", batch), batch.worlds.fleet.limit

    def act():
        driver.forget(batch.worlds.state.clock[0] == 0)
        speed, steering = driver.decide()
        shares = 2.0 * speed / limit[:, SPEED] - 1.0, steering / limit[:, STEERING]
        return np.stack(shares, axis=-1).transpose(1, 0, 2)

    return act


BUSY = [
    {"scenario": "paper-pair"},
    {"scenario": "crossing-8", "observation": Observation(neighbors=3, chains=True)},
    {"scenario": "paper-pair", "num_havs": 5, "on_goal": "remove", "frame_skip": 3},
    {"scenario": "paper-pair", "task": Task(distance_tolerance=20.0, heading_tolerance=4.0)},
]


@pytest.mark.parametrize("driver", [random_actions, avoid_jack])
@pytest.mark.parametrize("settings", BUSY)
def test_every_observation_of_a_thousand_episodes_is_within_its_bounds(driver, settings):
    worlds, steps, rounds = budget(250, 2), budget(300, 6), budget(4, 2)
    env = HAVSwarmVectorEnv(worlds, max_steps=steps, **settings)
    space, act, ends = env.observation_space, driver(env, np.random.default_rng(2)), 0
    observation, _ = env.reset(seed=7)
    while ends < rounds * worlds:
        assert observation.dtype == np.float32
        # a comparison with NaN is false
        inside = (observation >= space.low) & (observation <= space.high)
        assert inside.all()
        observation, _, terminated, truncated, _ = env.step(act())
        ends += np.count_nonzero(terminated | truncated)
