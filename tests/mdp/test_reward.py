"""Rewards are weights times terms, and each term matches its name."""

import math

import numpy as np
import pytest
from shapely import LineString, Point

from hav_env import Reward, explicit, parallel_env
from hav_env.maths.dubins import path_length
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.world.arrays import ACTUAL, ARTICULATION, JACKKNIFE, PHASE, STABLE, STEERING, WHEN
from tests.support.budgets import budget
from tests.support.policies import Watched
from tests.support.worlds import limit, put, side_by_side, wrapped

TERMS = Reward._fields
ALONE = Reward(*[0.0] * len(TERMS))
HERE = np.ones(1, np.bool_)


def made(num_worlds=1, **settings):
    """Return a process of worlds whose first episodes have begun."""
    process = DecisionProcess(num_worlds, **settings)
    seeds, everywhere = np.arange(num_worlds), np.ones(num_worlds, np.bool_)
    process.begin(seeds, np.zeros(num_worlds, np.int64), everywhere, process.outcome())
    return process


def terms_of(process, told, names=TERMS):
    """Return the sum of each term since the beginning, (T, C, W)."""
    first = process.info.index(f"return_{names[0]}")
    return told.info[first : first + len(names)]


def left(worlds):
    """Return the lengths (N, W) of the drivable Dubins paths to the goals under way [m]."""
    state = worlds.state
    lengths = np.empty(state.x.shape)
    for agent, w in np.ndindex(*lengths.shape):
        x, y, goal_heading = state.goal[agent, :3, w]
        heading = state.heading[agent, 0, w]
        there = complex(x - state.x[agent, w], y - state.y[agent, w]) * np.exp(-1j * heading)
        turn, stable = wrapped(goal_heading - heading), worlds.fleet.radius[agent, STABLE, w]
        truck, steepest = worlds.fleet.length[agent, 0, w], worlds.fleet.limit[agent, STEERING, w]
        radius = max(stable, truck / np.tan(steepest))
        lengths[agent, w] = path_length(there.real, there.imag, turn, radius)
    return lengths


class Referee:
    """Computes the terms of ``Reward`` again from the states of the worlds."""

    def __init__(self, worlds):
        """Take the worlds, and record their states."""
        self.worlds, self.total = worlds, np.zeros((len(TERMS), *worlds.state.x.shape))
        self.note()

    def note(self):
        worlds = self.worlds
        first, state = worlds.record.first, worlds.state
        self.waited = state.waiting.copy()
        self.hits = state.goal[:, PHASE] + state.waiting
        self.left = left(worlds)
        self.harmed = (first[:, [JACKKNIFE, ACTUAL], WHEN] >= 0).astype(float)

    def judge(self, duration):
        """Add the terms of the last action."""
        worlds, before = self.worlds, (self.waited, self.hits, self.left, self.harmed)
        self.note()
        waited, hits, was_left, harmed = before
        gained = self.hits - hits
        terms = {
            "progress": was_left - np.where(gained > 0, 0.0, self.left),
            "goal": gained,
            "jackknife": self.harmed[:, 0] - harmed[:, 0],
            "actual_collision": self.harmed[:, 1] - harmed[:, 1],
            "potential_collision": duration * self.depth(),
            "proximity": duration * self.nearness() ** 2,
            "articulation": duration * self.bend() ** 2,
            "steering": duration * (worlds.state.steering / worlds.fleet.limit[:, STEERING]) ** 2,
            "time": np.full(waited.shape, duration),
        }
        self.total += np.where(waited, 0.0, np.stack([terms[name] for name in TERMS]))

    def bend(self):
        worlds = self.worlds
        bends = np.abs(np.diff(worlds.state.heading, axis=1))  # (N, U - 1, W)
        joints = np.arange(1, bends.shape[1] + 1)[:, None]
        bends = np.where(joints <= worlds.fleet.num_trailers[:, None], bends, 0.0)
        share = bends.max(axis=1) / worlds.fleet.limit[:, ARTICULATION]
        return np.clip(2.0 * share - 1.0, 0.0, 1.0)

    def nearness(self):
        """Return 1 where the front touches the nearest chain, 0 where it is 5 m away, (N, W)."""
        num_havs, num_worlds = self.worlds.state.x.shape
        gaps = np.full((num_havs, num_havs, num_worlds), math.inf)
        for one, other, w in np.ndindex(gaps.shape):
            if one != other:
                front = Point(self.chain(one, w).coords[0])
                gaps[one, other, w] = front.distance(self.chain(other, w))
        return np.clip(1.0 - gaps.min(axis=1) / 5.0, 0.0, 1.0)

    def chain(self, hav, w):
        state, fleet = self.worlds.state, self.worlds.fleet
        units = slice(fleet.num_trailers[hav, w] + 1)
        steps = fleet.length[hav, units, w] * np.exp(1j * state.heading[hav, units, w])
        rear = complex(state.x[hav, w], state.y[hav, w])
        axles = [rear + steps[0], rear, *(rear - steps[1:].cumsum())]
        return LineString([(axle.real, axle.imag) for axle in axles])

    def depth(self):
        places = self.worlds.state.x + 1j * self.worlds.state.y
        radius = self.worlds.fleet.radius[:, 0]
        depth = 1.0 - np.abs(places[:, None] - places) / (radius[:, None] + radius)
        depth[np.diag_indices(len(places))] = 0.0
        return np.maximum(depth.max(axis=1), 0.0)


@pytest.mark.parametrize("frame_skip", [1, 4])
@pytest.mark.parametrize(
    "scenario",
    [
        "paper-pair",
        *(pytest.param(name, marks=pytest.mark.exhaustive) for name in ("crossing-8", "column-5")),
    ],
)
def test_every_term_is_what_its_docstring_says(scenario, frame_skip):
    num_worlds = budget(6, 1)
    reward = Reward(proximity=-0.5)
    process = made(num_worlds, scenario=scenario, frame_skip=frame_skip, reward=reward)
    worlds, rng = process.batch.worlds, np.random.default_rng(1)
    # narrow limits and turns, so that there are jackknifes and deep bends
    worlds.fleet.limit[:, ARTICULATION] = 0.5
    referee = Referee(worlds)
    for _ in range(budget(300, 6)):
        actions = rng.uniform(0.5, 1.0, (num_worlds, process.num_havs, 2))
        told = process.step(actions)
        referee.judge(0.2 * frame_skip)
        off = terms_of(process, told) - referee.total * np.array(reward)[:, None, None]
        rounded = np.where(np.array(TERMS) == "progress", 3e-5, 1e-8)  # paths are in float32
        assert (np.abs(off).max(axis=(1, 2)) < rounded).all()
    if budget(1, 0):
        happened = (referee.total != 0.0).any(axis=(1, 2))
        assert happened[[TERMS.index(name) for name in ("jackknife", "articulation", "time")]].all()


def test_progress_over_an_episode_is_the_first_paths_less_what_is_left():
    """The sum does not depend on the path: detours gain nothing."""
    reward = ALONE._replace(progress=1.0)
    env = parallel_env(num_havs=3, reward=reward, max_steps=budget(400, 20))
    rng = np.random.default_rng(0)
    _, infos = env.reset(seed=4)
    first = {agent: info["dubins_to_goal"] for agent, info in infos.items()}
    assert min(first.values()) > 1.0
    total = dict.fromkeys(first, 0.0)
    while env.agents:
        actions = {agent: rng.uniform(-1, 1, 2) for agent in env.agents}
        _, rewards, *_, infos = env.step(actions)
        total = {agent: value + rewards[agent] for agent, value in total.items()}
    for agent, info in infos.items():
        assert info["goals_hit"] == 0.0
        assert total[agent] == pytest.approx(first[agent] - info["dubins_to_goal"], abs=1e-9)


def test_progress_through_two_goals_is_the_length_of_both_paths():
    scenario = explicit(
        [[3.0, 4.0]] * 2,
        [[0, 0, 0], [0, 50, 0]],
        [[[5, 0, 0], [12, 0, 0]], [[9, 50, 0], [20, 50, 0]]],
    )
    env = parallel_env(scenario=scenario, reward=ALONE._replace(progress=1.0, goal=100.0))
    env.reset(seed=0)
    while env.agents:
        *_, infos = env.step(dict.fromkeys(env.agents, np.array([1.0, 0.0])))
    for agent, info in infos.items():
        worlds, k = env._world.process.batch.worlds, int(agent[-1])
        lengths = worlds.record.goal[k, :, 4, 0]  # Dubins lengths from where goals were assigned
        assert info["return_goal"] == 200.0
        assert info["return_progress"] == pytest.approx(lengths.sum(), rel=1e-6)


def test_a_full_circle_earns_no_progress():
    process = made(scenario=side_by_side(500.0), reward=ALONE._replace(progress=1.0))
    worlds, steering = process.batch.worlds, 0.5
    limit(worlds, steering=steering)
    put(worlds, [3.0, 4.0], 0.0, 0.0, 0.3)
    process.observe_worlds(HERE, process.outcome())
    around = 2.0 * math.pi * 3.0 / math.tan(steering)
    steps = math.ceil(around / 0.2)
    speed = around / steps / 0.2  # the last step ends where the first began
    action = np.array([[[2.0 * speed - 1.0, 1.0]]])
    gains = [0.0, *(terms_of(process, process.step(action))[0, 0, 0] for _ in range(steps))]
    assert gains[-1] == pytest.approx(0.0, abs=1e-3)
    assert np.abs(gains).max() > 1.0


@pytest.mark.parametrize("term", TERMS)
def test_a_weight_scales_its_own_term_and_no_other(term):
    totals = {}
    for weight in (0.0, 1.0, -3.0):
        process = made(num_havs=3, reward=Reward()._replace(**{term: weight}))
        for k in range(budget(60, 5)):
            told = process.step(np.full((1, 3, 2), [1.0, 1.0 if k % 40 < 20 else -1.0]))
        totals[weight] = terms_of(process, told)[..., 0]
        shares = process.batch.worlds  # the rewards change nothing in the world
        totals[weight, "x"] = shares.state.x.copy()
    which = TERMS.index(term)
    others = [k for k in range(len(TERMS)) if k != which]
    assert np.array_equal(totals[0.0, "x"], totals[-3.0, "x"])
    assert (totals[0.0][which] == 0.0).all()
    assert totals[-3.0][which] == pytest.approx(-3.0 * totals[1.0][which])
    for weight in (1.0, -3.0):
        assert np.array_equal(totals[weight][others], totals[0.0][others])


def test_who_waits_gets_nothing():
    env = parallel_env(scenario=side_by_side(2.0, 90.0), max_steps=60)
    env.reset(seed=0)
    rewards_then = []
    while env.agents:
        _, rewards, *_, infos = env.step(dict.fromkeys(env.agents, np.array([1.0, 0.0])))
        rewards_then.append(rewards["hav_0"])
    assert infos["hav_0"]["waits"] == 1.0
    assert rewards_then[0] != 0.0
    assert rewards_then[-30:] == [0.0] * 30


@pytest.mark.exhaustive
def test_a_reward_of_ones_own_is_told_under_the_names_of_its_terms():
    reward = Watched(remaining=-0.25)
    env = parallel_env(scenario=side_by_side(2.0, 90.0), reward=reward, frame_skip=3)
    _, infos = env.reset(seed=0)
    names = [name for name in infos["hav_0"] if name.startswith("return_")]
    assert names == [f"return_{name}" for name in Watched._fields]
    total, was_left = 0.0, infos["hav_1"]["dubins_to_goal"]
    for step in range(1, 20):
        _, rewards, *_, infos = env.step(dict.fromkeys(env.agents, np.array([1.0, 0.0])))
        info = infos["hav_1"]
        terms = 0.6, 0.6 * step, info["dubins_to_goal"], was_left, 0.0
        assert rewards["hav_1"] == pytest.approx(np.dot(reward, terms))
        total, was_left = total + rewards["hav_1"], info["dubins_to_goal"]
        assert sum(info[name] for name in names) == pytest.approx(total)
    assert infos["hav_0"]["return_waited"] == 0.0  # a HAV that waited gets the reward 0
    assert infos["hav_0"]["return_seconds"] < infos["hav_1"]["return_seconds"]


def test_the_returns_by_term_sum_to_the_return_of_the_episode():
    env = parallel_env(scenario="paper-pair", max_cycles=5)
    env.reset(seed=0)
    total = dict.fromkeys(env.possible_agents, 0.0)
    while env.agents:
        actions = {agent: [1.0, 0.5] for agent in env.agents}
        _, rewards, _, _, infos = env.step(actions)
        for agent, reward in rewards.items():
            total[agent] += reward
    for agent, info in infos.items():
        returns = [value for name, value in info.items() if name.startswith("return_")]
        assert len(returns) == len(Reward())
        assert total[agent] == pytest.approx(sum(returns), rel=1e-5)
