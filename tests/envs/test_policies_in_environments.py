"""A policy acts equally whatever runs it: AVOID-JACK through every environment and the rollout."""

import functools

import gymnasium as gym
import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from hav_env import find_scenario, parallel_env
from hav_env.envs.gymnasium_vector import HAVSwarmVectorEnv
from hav_env.envs.stable_baselines3 import HAVVecEnv
from hav_env.evaluation.rollout import rollout
from hav_env.policies.driver import PolicyDriver
from hav_env.world.arrays import SPEED, STEERING
from hav_env.world.task import Task
from tests.support.budgets import budget

MAX_STEPS = budget(4_000, 20)
SEEDS = range(budget(6, 1))
METRICS = ("goals_hit", "steps", "path_length", "largest_articulation", "jackknifed")


class Actor:
    """AVOID-JACK as a learner acts: shares of speed and steering from -1 to 1."""

    def __init__(self, batch):
        """Take the worlds whose HAVs it drives."""
        self.driver, self.limit = PolicyDriver("avoid_jack", batch), batch.worlds.fleet.limit

    def act(self):
        """Return actions (W, N, 2)."""
        speed, steering = self.driver.decide()
        shares = 2.0 * speed / self.limit[:, SPEED] - 1.0, steering / self.limit[:, STEERING]
        return np.stack(shares, axis=-1).transpose(1, 0, 2)


@functools.cache
def by_rollout(scenario):
    tables = [
        rollout(
            AvoidJack(), find_scenario(scenario), seed, np.zeros(1, int), Task(max_steps=MAX_STEPS)
        )
        for seed in SEEDS
    ]
    rows = [row for table in tables for row in table.to_pylist()]
    num_goals = find_scenario(scenario).num_goals
    for row in rows:
        row["goals_hit"] = sum(row[f"goal_{g + 1}_hit"] for g in range(num_goals))
    return np.array([[row[name] for name in METRICS] for row in rows], float)


def by_agents(scenario):
    rows = []
    for seed in SEEDS:
        env = parallel_env(scenario=scenario, max_steps=MAX_STEPS)
        env.reset(seed=seed)
        actor = Actor(env._world.process.batch)
        while env.agents:
            *_, infos = env.step(dict(zip(env.agents, actor.act()[0], strict=True)))
        rows += [[info[name] for name in METRICS] for info in infos.values()]
    return np.array(rows)


def by_swarm(scenario):
    rows = []
    for seed in SEEDS:
        env = gym.make("hav_env:HAVSwarm-v0", scenario=scenario, max_steps=MAX_STEPS).unwrapped
        env.reset(seed=seed)
        actor, flags = Actor(env._world.process.batch), (False, False)
        while not any(flags):
            _, _, *flags, info = env.step(actor.act()[0])
        rows.append(np.stack([info[name] for name in METRICS], axis=-1))
    return np.concatenate(rows)


def by_single(scenario):
    """Drive the first HAV ourselves, and let the environment drive the others."""
    rows = []
    for seed in SEEDS:
        env = gym.make(
            "hav_env:HAVSingle-v0", scenario=scenario, others="avoid_jack", max_steps=MAX_STEPS
        ).unwrapped
        env.reset(seed=seed)
        actor, flags = Actor(env._world.process.batch), (False, False)
        while not any(flags):
            _, _, *flags, info = env.step(actor.act()[0, 0])
        rows.append([info[name] for name in METRICS])
    return np.array(rows)


def by_vector(scenario):
    env = HAVSwarmVectorEnv(
        len(SEEDS), scenario=scenario, max_steps=MAX_STEPS, autoreset_mode="SameStep"
    )
    env.reset(seed=SEEDS[0])
    actor, rows = Actor(env._process.batch), {}
    while len(rows) < len(SEEDS):
        *_, terminated, truncated, info = env.step(actor.act())
        for w in np.flatnonzero(terminated | truncated):
            final = info["final_info"]
            rows.setdefault(w, np.stack([final[name][w] for name in METRICS], axis=-1))
        actor.driver.forget(terminated | truncated)
    return np.concatenate([rows[w] for w in sorted(rows)])


def by_rows_of_sb3(scenario):
    env = HAVVecEnv(len(SEEDS), scenario=scenario, max_steps=MAX_STEPS)
    # a seed for each row; that of the first HAV is the world's
    num_havs = env.process.num_havs
    env._seeds = np.repeat(np.array(SEEDS), num_havs).tolist()
    env.reset()
    actor, rows = Actor(env.process.batch), {}
    while len(rows) < env.num_envs:
        _, _, ends, infos = env.step(actor.act().reshape(-1, 2))
        for row in np.flatnonzero(ends):
            rows.setdefault(row, [infos[row][name] for name in METRICS])
        actor.driver.forget(ends[::num_havs])
    return np.array([rows[row] for row in sorted(rows)])


@pytest.mark.parametrize("face", [by_agents, by_swarm, by_vector, by_rows_of_sb3])
@pytest.mark.parametrize("scenario", ["paper-single", "paper-pair", "crossing-8"])
def test_every_hav_fares_as_in_a_rollout(scenario, face):
    expected = by_rollout(scenario)
    assert face(scenario) == pytest.approx(expected, rel=1e-6, abs=1e-6)
    if budget(1, 0):
        assert expected[:, 0].sum() > 0  # goals were hit


def test_one_hav_alone_fares_as_in_a_rollout():
    assert by_single("paper-single") == pytest.approx(by_rollout("paper-single"), rel=1e-6)


def test_one_hav_among_others_fares_as_in_a_rollout_until_it_is_done():
    """Its episode may end before that of the others."""
    found, expected = by_single("paper-pair"), by_rollout("paper-pair")[::2]
    ends = METRICS.index("steps")
    assert (found[:, ends] <= expected[:, ends]).all()
    others = [k for k in range(len(METRICS)) if k != ends]
    assert found[:, others] == pytest.approx(expected[:, others], rel=1e-6)
