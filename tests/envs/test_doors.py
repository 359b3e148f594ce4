"""A hundred invalid inputs, through every interface: an error in one line that names them."""

import functools
import math
import pathlib
import re
import time
from fractions import Fraction

import gymnasium as gym
import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.random import Random
from baselines.replay.trajectory import record_trajectory
from hav_env import (
    Batch,
    Column,
    Explicit,
    Observation,
    OnAxle,
    RandomFleet,
    RandomPoses,
    Reward,
    Task,
    Yard,
    explicit,
    find_scenario,
    parallel_env,
)
from hav_env.envs.stable_baselines3 import HAVVecEnv
from hav_env.evaluation.rollout import rollout
from hav_env.policies.checks import check_policy

SINGLE, HUGE = RandomPoses(), 10**30
many = functools.partial(gym.make_vec, "hav_env:HAVSwarm-v0")
single = functools.partial(gym.make_vec, "hav_env:HAVSingle-v0")
roll = functools.partial(rollout, Random(), SINGLE)
record = functools.partial(record_trajectory, Random(), SINGLE, task=Task(max_steps=2))
UNITS, START, GOALS = [[4.0, 8.0]], [[0.0, 0.0, 0.0]], [[[50.0, 0.0, 0.0]]]
ARRAYS = (np.array([1]), np.ones((1, 2)), np.zeros((1, 3)), np.ones((1, 1, 3)))


def wrong(**changes):
    """Return an explicit scenario that was not built with ``explicit``."""
    fields = explicit(UNITS, START, GOALS)._asdict()
    fields |= dict(zip(("num_trailers", "length", "start", "goals"), ARRAYS, strict=True))
    fields |= {"num_havs": 1, "num_goals": 1, "max_trailers": 1, "speed_max": 1.0}
    return Explicit(**fields | {"steering_max": 0.7, "articulation_max": 1.5} | changes)


def fleet(**changes):
    return RandomPoses(fleet=RandomFleet()._replace(**changes))


ENVIRONMENT = [
    ({"num_havs": value}, "num_havs")
    for value in (True, False, 0, -3, 2.0, 2.5, math.nan, "2", b"2", 1j, [2], {2}, HUGE, 10**6)
]
ENVIRONMENT += [
    ({"frame_skip": value}, "frame_skip")
    for value in (True, 0, -1, 1.5, HUGE, 10**9, "5", None, [1], np.ones(1), Fraction(3, 2))
]
ENVIRONMENT += [
    ({"threads": value}, "threads") for value in (True, 0, -1, 1.5, HUGE, 10**6, "2", [1], 1j)
]
ENVIRONMENT += [
    ({"max_steps": value}, "max_steps")
    for value in (True, 0, 1.5, HUGE, 10**5000, "100", math.inf, math.nan, None, 1j)
]
ENVIRONMENT += [
    ({"dt": value}, "dt")
    for value in (True, 0.0, -0.2, "0.1", 1e-9, 1e9, math.nan, math.inf, None, 1j, np.ones(1), [1])
]
ENVIRONMENT += [
    ({"sensing_range": value}, "sensing_range") for value in (-1.0, 1e300, 10**400, "far", None)
]
ENVIRONMENT += [
    ({"heading_tolerance": 1e100}, "heading_tolerance"),
    ({"distance_tolerance": 0.0}, "distance_tolerance"),
    ({"on_goal": 1}, "on_goal"),
    ({"on_goal": None}, "on_goal"),
    ({"on_goal": ["park"]}, "on_goal"),
    ({"on_jackknife": "END"}, "on_jackknife"),
    ({"on_collision": np.array(["end"])}, "on_collision"),
    ({"task": None}, "task"),
    ({"task": Task}, "task"),
    ({"task": (0.2,)}, "task"),
    ({"observation": None}, "observation"),
    ({"observation": Observation(True)}, "observation neighbors"),
    ({"observation": Observation(HUGE)}, "observation neighbors"),
    ({"observation": Observation(chains="yes")}, "observation chains"),
    ({"observation": Observation(fronts=1)}, "observation fronts"),
    ({"reward": Reward(goal="10")}, "reward goal"),
    ({"reward": Reward(goal=True)}, "reward goal"),
    ({"reward": Reward(time=1e100)}, "reward time"),
    ({"reward": Reward(steering=None)}, "reward steering"),
    ({"reward": Reward}, "reward"),
    ({"vehicle": OnAxle(substeps=HUGE)}, "vehicle substeps"),
    ({"vehicle": OnAxle(substeps=True)}, "vehicle substeps"),
    ({"vehicle": OnAxle(simultaneous="no")}, "vehicle simultaneous"),
    ({"vehicle": OnAxle}, "vehicle"),
    ({"scenario": RandomPoses(num_havs=2.0)}, "scenario num_havs"),
    ({"scenario": RandomPoses(num_havs="2")}, "scenario num_havs"),
    ({"scenario": RandomPoses(num_havs=HUGE)}, "scenario num_havs"),
    ({"scenario": RandomPoses(num_goals=10**9)}, "scenario num_goals"),
    ({"scenario": RandomPoses(pose_attempts=HUGE)}, "scenario pose_attempts"),
    ({"scenario": RandomPoses(world_attempts=10**9)}, "scenario world_attempts"),
    ({"scenario": RandomPoses(area_factor=1e300)}, "scenario area_factor"),
    ({"scenario": RandomPoses(fleet=None)}, "scenario fleet"),
    ({"scenario": RandomPoses(fleet=SINGLE)}, "scenario fleet"),
    ({"scenario": fleet(speed_max=1e18)}, "fleet speed_max"),
    ({"scenario": fleet(speed_max="1")}, "fleet speed_max"),
    ({"scenario": fleet(min_length=1e-100)}, "fleet min_length"),
    ({"scenario": fleet(max_trailers=10**9)}, "fleet max_trailers"),
    ({"scenario": fleet(min_trailers=True)}, "fleet min_trailers"),
    ({"scenario": fleet(trailer_redraw=0)}, "fleet trailer_redraw"),
    ({"scenario": fleet(trailer_sigma=1e300)}, "fleet trailer_sigma"),
    ({"scenario": fleet(steering_max=math.pi / 2)}, "fleet steering_max"),
    ({"scenario": Yard(aisle=1e300)}, "scenario aisle"),
    ({"scenario": Yard(gap=None)}, "scenario gap"),
    ({"scenario": Column(distance="long")}, "scenario distance"),
    ({"scenario": RandomPoses}, "scenario"),
    ({"scenario": b"paper-pair"}, "scenario"),
    ({"scenario": pathlib.Path("paper-pair")}, "paper-pair"),
    ({"scenario": wrong(num_trailers=[1])}, "scenario num_trailers"),
    ({"scenario": wrong(num_trailers=np.array([1.0]))}, "scenario num_trailers"),
    ({"scenario": wrong(num_trailers=np.array([2]))}, "scenario num_trailers"),
    ({"scenario": wrong(length=np.ones((1, 3)))}, "scenario length"),
    ({"scenario": wrong(length=np.full((1, 2), "4"))}, "scenario length"),
    ({"scenario": wrong(start=np.zeros(3))}, "scenario start"),
    ({"scenario": wrong(goals=np.zeros((1, 2, 3)))}, "scenario goals"),
    ({"scenario": wrong(num_havs=2)}, "scenario num_trailers"),
]
OTHERS = [
    (lambda: many(num_envs=0), "num_envs"),
    (lambda: many(num_envs=True), "num_envs"),
    (lambda: many(num_envs=2.0), "num_envs"),
    (lambda: many(num_envs=10**9), "num_envs"),
    (lambda: many(num_envs=HUGE), "num_envs"),
    (lambda: single(num_envs="4"), "num_envs"),
    (lambda: HAVVecEnv(10**9), "num_worlds"),
    (lambda: HAVVecEnv(1.5), "num_worlds"),
    (lambda: Batch(SINGLE, 10**9), "num_worlds"),
    (lambda: Batch(SINGLE, math.nan), "num_worlds"),
    (lambda: Batch(SINGLE, "1"), "num_worlds"),
    (lambda: Batch(SINGLE, threads=0.5), "threads"),
    *(
        (functools.partial(Batch(SINGLE).reset, seed), "seed")
        for seed in (True, None, {1}, 1.0, 1.5, "1", b"1", -1, 2**32, HUGE, [1], 1j, np.ones(1))
    ),
    *(
        (functools.partial(Batch(SINGLE).reset, 0, episodes), "episodes")
        for episodes in ([0.5], [1.0], [HUGE], ["1"], [True], [None], {1}, [[0], [1, 2]], 1j, "1")
    ),
    (lambda: roll(0, [0.5]), "episodes"),
    (lambda: roll(0, [10**12]), "episodes"),
    (lambda: roll(0, []), "episodes"),
    (lambda: roll(0, None), "episodes"),
    (lambda: roll(True, [0]), "seed"),
    (lambda: roll(0, [0], threads=1.5), "threads"),
    (lambda: rollout(Random(), "paper-pare", 0, [0]), "paper-pare"),
    (lambda: rollout(Random(), SINGLE, 0, [0], task=3), "task"),
    (lambda: rollout(Random(), SINGLE, 0, [0], vehicle=3), "3 is not a vehicle"),
    (lambda: rollout(Random(hold=True), SINGLE, 0, [0]), "policy hold"),
    (lambda: rollout(Random(hold=HUGE), SINGLE, 0, [0]), "policy hold"),
    (lambda: record(0, HUGE), "episode"),
    (lambda: record(0, 0.5), "episode"),
    (lambda: record(0, True), "episode"),
    (lambda: record(0.5, 0), "seed"),
    (lambda: record(0, 0, every=0), "every"),
    (lambda: record(0, 0, every=1.5), "every"),
    (lambda: record(0, 0, every=HUGE), "every"),
    (lambda: record(0, 0, every="2"), "every"),
    (lambda: check_policy(AvoidJack(b="0.5"), SINGLE), "policy b"),
    (lambda: check_policy(AvoidJack(b=1e300), SINGLE), "policy b"),
    (lambda: check_policy(AvoidJack(c=None), SINGLE), "policy c"),
    (lambda: check_policy(AvoidJack(c=np.ones(2)), SINGLE), "policy c"),
    (lambda: check_policy(AvoidJack(beta=2.0), SINGLE), "policy beta"),
    (lambda: check_policy(AvoidJack(dt=True), SINGLE), "policy dt"),
    (lambda: check_policy(AvoidJack(keep_first="yes"), SINGLE), "policy keep_first"),
    (lambda: check_policy(AvoidJack(evasion_release=0.5), SINGLE), "policy evasion_release"),
    (lambda: check_policy(AvoidJack(close_factor=1j), SINGLE), "policy close_factor"),
    (lambda: find_scenario(3), "scenario is 3"),
    (lambda: find_scenario(None), "scenario is None"),
    (lambda: find_scenario("x" * 5000 + ".json"), "no scenario file"),
    (lambda: find_scenario("\0.json"), "no scenario file"),
    (lambda: find_scenario("no\nsuch\nscenario"), "unknown scenario"),
]
WRITTEN = [
    ((5, START, GOALS), "lengths is 5"),
    (("ab", START, GOALS), "lengths is 'ab'"),
    ((None, START, GOALS), "lengths is None"),
    (({1: 2}, START, GOALS), "lengths is {1: 2}"),
    (([4.0, 8.0], START, GOALS), "lengths[0] is 4.0"),
    (([["4", 8.0]], START, GOALS), "lengths[0][0] is '4'"),
    (([[True, 8.0]], START, GOALS), "lengths[0][0] is True"),
    (([[1e-100, 8.0]], START, GOALS), "HAV 0 has lengths"),
    (([[4.0, 1e9]], START, GOALS), "HAV 0 has lengths"),
    (([[4.0, 10**400]], START, GOALS), "lengths[0][1] is"),
    (([[4.0, 10**5000]], START, GOALS), "lengths[0][1] is"),
    (([[4.0, [8.0]]], START, GOALS), "lengths[0][1] is [8.0]"),
    (([[4.0, *[1.0] * 101]], START, GOALS), "max_trailers is 101"),
    ((UNITS, [["0", 0, 0]], GOALS), "start[0][0] is '0'"),
    ((UNITS, [[1e9, 0, 0]], GOALS), "x of the start of HAV 0 is 1000000000.0"),
    ((UNITS, [[0, -1e300, 0]], GOALS), "y of the start of HAV 0 is -1e+300"),
    ((UNITS, [[0, 0, 1e100]], GOALS), "heading of the start of HAV 0 is 1e+100"),
    ((UNITS, [[0, 0, 1j]], GOALS), "start[0][2] is 1j"),
    ((UNITS, [[0, 0, math.nan]], GOALS), "HAV 0 has a pose that is not finite"),
    ((UNITS, {0.0}, GOALS), "start is {0.0}"),
    ((UNITS, START, 5), "goals is 5"),
    ((UNITS, START, [[50, 0, 0]]), "goals[0][0] is 50"),
    ((UNITS, START, [[[50, 0, "0"]]]), "goals[0][0][2] is '0'"),
    ((UNITS, START, [[[1e9, 0, 0]]]), "x of the goal 1 of HAV 0 is 1000000000.0"),
    ((UNITS, START, [[[[50]]]]), "goals[0][0][0] is [50]"),
    ((UNITS, START, np.array("goals")), "goals is 'goals'"),
    ((UNITS, START, [[[1, 0, 0]] * 1001]), "num_goals is 1001"),
]


@pytest.mark.parametrize(("settings", "name"), ENVIRONMENT)
def test_an_environment_refuses_by_name(settings, name):
    refuses(lambda: parallel_env(**settings), name)


@pytest.mark.parametrize(("make", "name"), OTHERS)
def test_every_other_door_refuses_by_name(make, name):
    refuses(make, name)


@pytest.mark.parametrize(("columns", "name"), WRITTEN)
def test_what_is_written_down_is_refused_by_name(columns, name):
    refuses(lambda: explicit(*columns), name)


@pytest.mark.parametrize("field", ["speed_max", "steering_max", "articulation_max"])
@pytest.mark.parametrize("value", [None, "1", True, 1j, [1], 1e18, 1e-100, math.nan, 10**400])
def test_limits_that_are_written_down_are_refused_by_name(field, value):
    refuses(lambda: explicit(UNITS, START, GOALS, **{field: value}), f"scenario {field}")


def refuses(make, name):
    began = time.monotonic()
    with pytest.raises((TypeError, ValueError), match=re.escape(name)) as told:
        make()
    assert "\n" not in str(told.value)
    assert len(str(told.value)) < 500
    assert time.monotonic() - began < 5.0


def test_there_are_at_least_two_hundred_of_them():
    assert len(ENVIRONMENT) + len(OTHERS) + len(WRITTEN) >= 200
