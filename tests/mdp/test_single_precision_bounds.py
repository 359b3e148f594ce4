"""Single precision is refused where it is too coarse, and keeps its promise where it is not."""

import gymnasium as gym
import numpy as np
import pytest

from hav_env import build_site, explicit, parallel_env
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.simulator.batch import Batch
from hav_env.simulator.single_precision import FARTHEST_SINGLE, SHORTEST_SINGLE
from tests.mdp.test_precision import STEPS, WORLDS, actions, begun
from tests.support.comparing import exactly

SWARM = "hav_env:HAVSwarm-v0"
LONE = [[3.0, 4.0]]
WAY_OUT = 'or use precision="double"'


def drive_apart(offset=0.0, dt=0.2):
    """Return how far [m] HAVs are from those of double precision after 24 s, at an offset [m]."""
    processes = [begun(precision=precision, dt=dt)[0] for precision in ("single", "double")]
    single, double = (process.batch.worlds for process in processes)
    for axis, name in enumerate(("x", "y")):
        getattr(double.state, name)[:] = getattr(single.state, name) + np.float32(offset)
        getattr(single.state, name)[:] = getattr(double.state, name)
        for worlds in (single, double):
            worlds.goals[:, :, axis] += worlds.goals.dtype.type(offset)
            worlds.state.goal[:, axis] += worlds.goals.dtype.type(offset)
    for action in np.repeat(actions(WORLDS), round(0.2 / dt), axis=0):
        for process in processes:
            process.step(action)
    return np.hypot(single.state.x - double.state.x, single.state.y - double.state.y).max()


@pytest.mark.parametrize(
    ("settings", "most"),
    [
        ({}, 0.5e-3),
        ({"dt": SHORTEST_SINGLE}, 2e-3),
        ({"offset": 900.0}, 2e-3),
        ({"offset": FARTHEST_SINGLE - 100.0}, 6e-3),
    ],
    ids=str,
)
def test_havs_drive_nearly_as_in_double_precision_within_the_bounds(settings, most):
    assert drive_apart(**settings) < most * STEPS / 120 + 1e-4


def far(x=0.0, goal_x=40.0):
    return explicit(LONE, [[x, 20, 0]], [[[goal_x, 40, 0]]])


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"scenario": far(500_000.0)}, "HAV 0 starts at x = 500000 m, but must be within 2,048 m"),
        ({"scenario": far(0.0, -2_100.0)}, "HAV 0 has a goal at x = -2100 m, but must be within"),
        (
            {"site": build_site([[0, 5_400_000], [90, 5_400_000], [90, 5_400_090]])},
            "the site has a segment at y = 5400000 m, but must be within 2,048 m",
        ),
        ({"dt": 0.01}, "task dt is 0.01 s, but must be at least 0.05 s"),
    ],
    ids=["start", "goal", "site", "dt"],
)
def test_what_it_is_too_coarse_for_is_refused(settings, message):
    with pytest.raises(ValueError, match=message) as told:
        parallel_env(**{"precision": "single"} | settings)
    assert WAY_OUT in str(told.value)
    parallel_env(**settings)


def test_a_reset_to_a_place_far_away_is_refused_and_changes_nothing():
    env, twin = (gym.make(SWARM, precision="single").unwrapped for _ in range(2))
    for one in (env, twin):
        one.reset(seed=3)
    for options in ({"start": [[1e7, 0, 0], [1e7, 90, 0]]}, {"goals": [[[9e3, 0, 0]] * 2] * 2}):
        if "goals" in options:
            options["goals"][1] = [[9e3, 90, 0]] * 2
        with pytest.raises(ValueError, match="must be within 2,048 m of the origin"):
            env.reset(options=options)
    assert exactly(env.reset()) == exactly(twin.reset())


def test_options_of_a_reset_leave_the_other_poses_as_they_are_drawn():
    worlds = []
    for precision in ("double", "single"):
        env = gym.make(SWARM, precision=precision).unwrapped
        env.reset(seed=3, options={"goals": [[[90, 0, 0]] * 2, [[90, 90, 0]] * 2]})
        worlds.append(env._world.process.batch.worlds)
    assert exactly(worlds[0].state.x.astype(np.float32)) == exactly(worlds[1].state.x)


def test_a_scenario_that_puts_havs_far_away_is_refused_at_its_first_episode():
    batch, placed = Batch(far(), precision="single"), np.ones(1, np.bool_)
    batch.worlds.state.x[:] = 5_000.0
    with pytest.raises(ValueError, match="the scenario has put a HAV at x = 5000 m"):
        batch.check_places(np.zeros(1, np.int64), placed)
    assert not placed.any()


def test_returns_are_the_sums_of_the_rewards():
    """A sum of 10,000 rewards in float32 lost more than 1e-5 of it."""
    process, _ = begun(precision="single")
    returns = [k for k, name in enumerate(process.info) if name.startswith("return_")]
    total = np.zeros((2, WORLDS))
    for action in actions(WORLDS):
        seen = process.step(action)
        total += seen.reward
    assert seen.info[returns].sum(axis=0) == pytest.approx(total, rel=1e-12, abs=1e-12)


def test_the_arrays_of_a_process_name_worlds_that_have_an_episode():
    process = DecisionProcess(3)
    assert process.begun.tolist() == [False] * 3
