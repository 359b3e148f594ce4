"""Episodes of a network equal those of its training, whatever runs them."""

import os
import subprocess
import sys

import gymnasium as gym
import numpy as np
import pytest

from baselines.policies.files import save_policy
from baselines.replay.trajectory import record_trajectory
from hav_env import Batch, RandomPoses, Task, find_scenario
from hav_env.envs.stable_baselines3 import HAVVecEnv
from hav_env.evaluation.rollout import rollout
from hav_env.policies.driver import PolicyDriver
from hav_env.policies.interface import allocate_memory, decide
from hav_env.world.arrays import SPEED, STEERING
from tests.support.budgets import COMPARED, COMPILED, budget
from tests.support.networks import actions_of, pursuing_network, random_network

STEPS = budget(300, 15)  # whole numbers of held actions
EASY = Task(max_steps=budget(6_000, 15), distance_tolerance=5.0, heading_tolerance=1.0)
TOTALS = ("goals_hit", "steps", "path_length", "largest_articulation", "jackknifed")


def seen_in(scenario):
    """Return the number of neighbours to observe."""
    return min(find_scenario(scenario).num_havs - 1, 4)


def by_rollout(policy, scenario, seed, task):
    scenario = find_scenario(scenario)
    rows = rollout(policy, scenario, seed, np.zeros(1, int), task).to_pylist()
    for row in rows:
        row["goals_hit"] = sum(row[f"goal_{g + 1}_hit"] for g in range(scenario.num_goals))
    return np.array([[row[name] for name in TOTALS] for row in rows], float)


def by_environment(policy, scenario, seed, task):
    """Run an episode as training does: rows in, actions out, one for ``frame_skip`` steps."""
    env = HAVVecEnv(1, scenario=scenario, frame_skip=policy.frame_skip, task=task)
    env._seeds = [seed] * env.num_envs
    rows, ends = env.reset(), np.zeros(1, bool)
    while not ends.any():
        rows, _, ends, infos = env.step(actions_of(policy, rows))
    return np.array([[info[name] for name in TOTALS] for info in infos])


@pytest.mark.parametrize("frame_skip", [1, 5])
@pytest.mark.parametrize("seed", range(budget(4, 1)))
@pytest.mark.parametrize("scenario", ["paper-single", "paper-pair", "crossing-8"])
def test_an_episode_goes_as_in_the_environment(scenario, seed, frame_skip):
    policy = random_network(seed, (8, 8), seen_in(scenario), frame_skip=frame_skip)
    task = Task(max_steps=STEPS)
    expected = by_environment(policy, scenario, seed, task)
    # the environment rounds rows to single precision
    assert by_rollout(policy, scenario, seed, task) == pytest.approx(expected, rel=1e-6, abs=1e-6)
    assert len(set(expected[:, 2])) == len(expected)  # every HAV drives its own path


@pytest.mark.parametrize(
    "scenario",
    [
        "paper-single",
        "paper-pair",
        "crossing-8",
        pytest.param("column-5", marks=pytest.mark.exhaustive),
    ],
)
@pytest.mark.parametrize("seed", range(budget(4, 1)))
def test_whole_episodes_with_goals_and_waiting_go_as_in_the_environment(scenario, seed):
    policy = pursuing_network(seen_in(scenario), frame_skip=1)
    expected = by_environment(policy, scenario, seed, EASY)
    assert by_rollout(policy, scenario, seed, EASY) == pytest.approx(expected, rel=1e-9)
    if budget(1, 0):
        assert expected[:, 0].min() > 0


@pytest.mark.parametrize("scenario", ["paper-single", "paper-pair", "crossing-8"])
@pytest.mark.parametrize("seed", range(budget(4, 1)))
def test_held_actions_lead_to_the_states_of_the_environment_until_somebody_waits(scenario, seed):
    """The environment requires actions of waiting HAVs; the network continues with its last."""
    policy = pursuing_network(seen_in(scenario), frame_skip=5)
    found = record_trajectory(policy, find_scenario(scenario), seed, 0, EASY)
    waits = found.waiting.any(axis=1) | (found.step == found.step[-1])
    until = found.step[np.argmax(waits)] // 5
    env = HAVVecEnv(1, scenario=scenario, frame_skip=5, task=EASY)
    env._seeds = [seed] * env.num_envs
    rows, state = env.reset(), env.process.batch.worlds.state
    for action in range(until):
        assert state.x[:, 0] == pytest.approx(found.x[5 * action], abs=1e-9)
        assert state.heading[..., 0] == pytest.approx(found.heading[5 * action], abs=1e-9)
        rows, *_ = env.step(actions_of(policy, rows))
    assert until >= budget(30, EASY.max_steps // 5)


@pytest.mark.parametrize("scenario", ["paper-single", "paper-pair"])
@pytest.mark.parametrize("frame_skip", [1, 3, 5])
def test_an_action_is_held_between_multiples_of_frame_skip(scenario, frame_skip):
    policy = random_network(3, (8,), seen_in(scenario), frame_skip=frame_skip)
    steps = budget(100, 20)
    found = record_trajectory(policy, find_scenario(scenario), 2, 1, Task(max_steps=steps))
    commands = np.concatenate([found.speed, found.steering], axis=1)[:-1]
    changed = 1 + np.flatnonzero((np.diff(commands, axis=0) != 0.0).any(axis=1))
    assert (changed % frame_skip == 0).all()
    assert len(changed) > 0.9 * (steps // frame_skip - 1)


def test_who_waits_goes_on_with_the_action_from_before_until_the_next_is_due():
    """Goals change when the last HAV hits its own, which is no multiple of anything."""
    policy = pursuing_network(1, frame_skip=7)
    found = record_trajectory(policy, find_scenario("paper-pair"), 0, 0, EASY)
    commands, waits = np.stack([found.speed, found.steering])[:, :-1], found.waiting[:-1]
    if budget(1, 0):
        assert waits.any()
    assert (commands[:, waits] == 0.0).all()
    goes_on = ~(waits[1:] | waits[:-1])
    held = found.step[1:-1] % 7 != 0
    assert (np.diff(commands, axis=1)[:, held[:, None] & goes_on] == 0.0).all()


# any place of execution


@pytest.mark.parametrize("num_havs", [2, 10])
def test_a_table_is_the_same_for_threads_batches_and_any_episodes(num_havs):
    """A policy trained in pairs drives swarms of any size: it observes the nearest HAVs."""
    policy, task = random_network(4, (8, 5), 1), Task(max_steps=budget(200, 6))
    scenario, episodes = RandomPoses(num_havs), np.arange(budget(40, 9))

    def table(chosen, threads):
        return rollout(policy, scenario, 6, np.array(chosen), task, threads=threads).to_pylist()

    whole = table(episodes, 1)
    for threads in (2, 5):
        assert repr(table(episodes, threads)) == repr(whole)
    few = table([7, 0, 3], 2)
    of_episode = {k: [row for row in whole if row["episode"] == k] for k in (7, 0, 3)}
    assert repr(few) == repr([row for k in (7, 0, 3) for row in of_episode[k]])


@pytest.mark.parametrize("threads", [1, 2])
def test_a_batch_is_its_worlds_one_by_one(threads):
    policy, worlds, scenario = random_network(5, (6,), 1), budget(70, 10), RandomPoses(2)
    batch = Batch(scenario, worlds, threads=threads)
    batch.reset(9)
    driver = PolicyDriver(policy, batch)
    for _ in range(budget(50, 11)):
        batch.step(*driver.decide())
    for w in (0, worlds // 2, worlds - 1):
        alone = Batch(scenario, 1)
        alone.reset(9, np.array([w]))
        memory = allocate_memory(policy, 2, 1)
        for _ in range(budget(50, 11)):
            alone.step(*decide(policy, memory, alone))
        together, own = batch.world(w).state, alone.world(0).state
        for name in ("x", "y", "heading", "speed", "steering", "waiting", "goal", "clock"):
            assert np.array_equal(getattr(together, name), getattr(own, name)), name


def test_forgotten_worlds_begin_anew():
    """After a reset the first action is due at once, whatever was held before."""
    policy, batch = random_network(6, (6,), frame_skip=1_000), Batch(RandomPoses(), 3)
    driver = PolicyDriver(policy, batch)
    batch.reset(1)
    first = driver.decide()
    for _ in range(3):
        batch.step(*driver.decide())
    assert np.array_equal(driver.decide(), first)
    batch.reset(2)
    driver.forget(np.ones(3, bool))
    fresh = PolicyDriver(policy, batch).decide()
    assert np.array_equal(driver.decide(), fresh)
    assert not np.array_equal(fresh, first)


@pytest.mark.parametrize("frame_skip", [1, 5])
def test_others_are_driven_as_in_a_rollout(frame_skip):
    """The first HAV is driven by the same network from outside, step after step."""
    policy, steps = random_network(7, (8,), 1, frame_skip=frame_skip), STEPS
    env = gym.make("hav_env:HAVSingle-v0", scenario="paper-pair", others=policy, max_steps=steps)
    env.reset(seed=5)
    batch = env.unwrapped._world.process.batch
    driver, limit, over = PolicyDriver(policy, batch), batch.worlds.fleet.limit[0, :, 0], False
    while not over:
        speed, steering = (values[0, 0] for values in driver.decide())
        action = 2.0 * speed / limit[SPEED] - 1.0, steering / limit[STEERING]
        *_, over, info = env.step(np.array(action))
    last = record_trajectory(policy, find_scenario("paper-pair"), 5, 0, Task(max_steps=steps))
    state = batch.worlds.state
    for name in ("x", "y", "heading"):
        assert getattr(state, name)[..., 0] == pytest.approx(getattr(last, name)[-1], abs=1e-9)
    assert info["steps"] == steps


SCRIPT = """
import sys
import numpy as np
from baselines.policies.files import load_policy
from hav_env.evaluation.rollout import rollout
from hav_env import RandomPoses, Task

for num_havs, episodes, steps in ((2, 3, 400), (20, 1, 30)):
    policy, task = load_policy(sys.argv[1]), Task(max_steps=steps)
    table = rollout(policy, RandomPoses(num_havs), 21, np.arange(episodes), task)
    print(repr(table.to_pydict()))
"""


@pytest.mark.skipif(not COMPILED, reason=COMPARED)
def test_compiled_code_and_pure_python_give_the_same_bits(tmp_path, capsys, monkeypatch):
    path = tmp_path / "chance.policy"
    save_policy(random_network(9, (7, 5), 1), path, {})
    pure = subprocess.run(
        [sys.executable, "-c", SCRIPT, str(path)],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1", "HAV_THREADS": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    monkeypatch.setattr(sys, "argv", ["-c", str(path)])
    exec(SCRIPT, {})
    own = capsys.readouterr().out
    assert len(own) > 10_000
    assert own == pure.stdout


def test_what_is_recorded_is_what_a_rollout_says():
    policy, scenario, task = random_network(8, (8,), 1), RandomPoses(2), Task(max_steps=STEPS)
    trajectory = record_trajectory(policy, scenario, 1, 2, task)
    rows = rollout(policy, scenario, 1, np.array([2]), task).to_pylist()
    for hav, row in enumerate(rows):
        driven = np.hypot(*np.diff([trajectory.x[:, hav], trajectory.y[:, hav]], axis=1)).sum()
        assert row["steps"] == trajectory.step[-1] == STEPS
        assert driven == pytest.approx(row["path_length"], rel=1e-3)
    assert (trajectory.evaded == -1).all()  # it does not report the evaded HAV
