"""An episode has the same bits whatever runs it: threads, batches, Python or a compiled loop."""

import os
import subprocess
import sys

import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.dubins_pursuit import DubinsPursuit
from baselines.policies.random import Random
from baselines.policies.reserve import Reserve
from hav_env import Batch, Limited, OnAxle, RandomPoses, Task, explicit
from hav_env.compiled import default_threads
from hav_env.evaluation.episode_table import tabulate
from hav_env.evaluation.rollout import rollout
from hav_env.policies.interface import allocate_memory, decide
from tests.support.budgets import COMPARED, COMPILED, budget
from tests.support.policies import Weaving

# a test below compares Reserve with plain Python
RESERVE = pytest.param(Reserve(), marks=pytest.mark.exhaustive)
POLICIES = [AvoidJack(), DubinsPursuit(), Random(), Weaving(), *[RESERVE] * COMPILED]
SWARMS = {1: (400, 12), 2: (400, 12), 20: (60, 2)}  # HAVs: steps, compiled and not


def named(policy):
    return type(policy).__name__


def text(table) -> str:
    """Return all numbers of a table with all their digits, nulls and not-a-numbers."""
    return repr(table.to_pydict())


def short(policy, num_havs, episodes, **options):
    task = Task(max_steps=budget(*SWARMS[num_havs]))
    return rollout(policy, RandomPoses(num_havs=num_havs), 11, np.array(episodes), task, **options)


@pytest.mark.parametrize("policy", POLICIES, ids=named)
@pytest.mark.parametrize("num_havs", SWARMS)
def test_one_thread_equals_many(policy, num_havs):
    episodes = np.arange(budget(50, 20))  # more than one chunk
    alone = short(policy, num_havs, episodes, threads=1)
    for threads in budget((2, 5), (2,)):
        assert text(short(policy, num_havs, episodes, threads=threads)) == text(alone)


@pytest.mark.parametrize("policy", POLICIES, ids=named)
@pytest.mark.parametrize("num_havs", SWARMS)
def test_an_episode_is_the_same_alone_and_among_others_in_any_order(policy, num_havs):
    together = short(policy, num_havs, [4, 0, 7, 2])
    for position, episode in enumerate([4, 0, 7, 2]):
        alone = short(policy, num_havs, [episode])
        assert text(alone) == text(together.slice(position * num_havs, num_havs))


TOGETHER = explicit(  # goals are hit at different times, then all go on; the neighbours are close
    [[3.0, 4.0], [4.0, 2.0, 3.0], [5.0, 3.0]],
    [[0.0, 0.0, 0.0], [0.0, 12.0, 0.0], [-4.0, -12.0, 0.0]],
    [
        [[4.0, 0.0, 0.0], [30.0, 0.0, 0.0]],
        [[16.0, 12.0, 0.0], [40.0, 12.0, 0.0]],
        [[20.0, -12.0, 0.0], [26.0, -20.0, 0.0]],
    ],
)


def python_loop(policy, scenario, seed, episode, task, vehicle=OnAxle()):
    """Run an episode as a caller of the public functions would."""
    batch = Batch(scenario, 1, task, vehicle)
    batch.reset(seed, np.array([episode]))
    state = batch.worlds.state
    start = np.stack([state.x, state.y, state.heading[:, 0]], axis=1)
    memory = allocate_memory(policy, scenario.num_havs, 1)
    while not batch.ended[0]:
        batch.step(*decide(policy, memory, batch))
    return tabulate(batch.worlds, start, policy)


@pytest.mark.parametrize("policy", POLICIES, ids=named)
@pytest.mark.parametrize("num_havs", SWARMS)
def test_a_rollout_is_a_loop_of_decisions_and_steps(policy, num_havs):
    scenario, task = RandomPoses(num_havs=num_havs), Task(max_steps=budget(*SWARMS[num_havs]))
    for episode in (0, 3):
        table = rollout(policy, scenario, 5, np.array([episode]), task)
        assert text(table) == text(python_loop(policy, scenario, 5, episode, task))


@pytest.mark.parametrize(
    "policy", [AvoidJack(evasion_release=1.5), Weaving(gain=0.02), RESERVE], ids=named
)
def test_a_rollout_is_that_loop_when_somebody_waits(policy):
    task = Task(max_steps=300)
    table = rollout(policy, TOGETHER, 5, np.array([0]), task)
    moving, steps = table["moving_steps"].to_pylist(), table["steps"].to_pylist()
    assert min(moving) < min(steps)  # some HAV has waited
    assert text(table) == text(python_loop(policy, TOGETHER, 5, 0, task))


@pytest.mark.exhaustive
@pytest.mark.parametrize("rules", [{}, {"next_goal": "alone"}, {"on_goal": "remove"}], ids=str)
@pytest.mark.parametrize("threads", [1, 2])
def test_a_rollout_is_that_loop_when_havs_brake_at_their_goals(rules, threads):
    task, braking = Task(max_steps=budget(600, 200), **rules), OnAxle(actuators=Limited(0.5, 0.2))
    policy = Weaving(gain=0.02)
    episodes = np.arange(budget(40, 3))
    table = rollout(policy, TOGETHER, 5, episodes, task, braking, threads)
    alone = python_loop(policy, TOGETHER, 5, 0, task, braking)
    assert text(table.slice(0, 3)) == text(alone)
    assert max(table["goal_1_hit"].to_pylist())
    at_once = python_loop(policy, TOGETHER, 5, 0, task)
    assert text(alone.select(["path_length"])) != text(at_once.select(["path_length"]))


@pytest.mark.exhaustive
def test_a_rollout_is_that_loop_over_many_worlds():
    """Blocks of lanes, and HAVs that wait in the first of them, so that loops begin later."""
    scenario, worlds = RandomPoses(num_havs=2, num_goals=1), budget(150, 10)
    task = Task(max_steps=budget(600, 10), distance_tolerance=8.0, heading_tolerance=1.0)
    policy = Reserve(distance_tolerance=8.0, heading_tolerance=1.0)
    tried = rollout(policy, scenario, 6, np.arange(worlds), task)
    episodes = np.argsort(tried["steps"].to_numpy()[::2], kind="stable")  # the quick ones first
    batch = Batch(scenario, worlds, task)
    batch.reset(6, episodes)
    state = batch.worlds.state
    start = np.stack([state.x, state.y, state.heading[:, 0]], axis=1)
    memory, begun_late = allocate_memory(policy, 2, worlds), False
    while not batch.ended.all():
        begun_late = begun_late or (state.waiting[0, :8].all() and not state.waiting[0].all())
        batch.step(*decide(policy, memory, batch))
    table = rollout(policy, scenario, 6, episodes, task)
    assert begun_late or not COMPILED
    goals = [name for name in table.column_names if name.endswith(("_hit", "goal_1_step", "path"))]
    assert text(table.select(goals)) == text(tabulate(batch.worlds, start, policy).select(goals))


@pytest.mark.parametrize("policy", POLICIES[:3], ids=named)
def test_running_again_gives_the_same_table(policy):
    assert text(short(policy, 2, [3, 4])) == text(short(policy, 2, [3, 4]))


IMPORTS = """
import numpy as np
from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.dubins_pursuit import DubinsPursuit
from baselines.policies.random import Random
from baselines.policies.reserve import Reserve
from hav_env.evaluation.rollout import rollout
from hav_env import (
    Limited, OffAxle, OnAxle, RandomPoses, Rectangles, Task, catalogue_fleet
)
"""
RESERVE_ALONE = """
for num_havs, episodes, steps in ((1, 2, 400), (2, 1, 100), (5, 1, 20)):
    scenario, task = RandomPoses(num_havs=num_havs, area_factor=2.0), Task(max_steps=steps)
    print(repr(rollout(Reserve(), scenario, 21, np.arange(episodes), task).to_pydict()))
"""
POLICIES_ALONE = """
for policy in (AvoidJack(), DubinsPursuit(), Random()):
    for num_havs, episodes, steps in ((1, 3, 400), (2, 2, 400), (20, 1, 30)):
        scenario, task = RandomPoses(num_havs=num_havs), Task(max_steps=steps)
        print(repr(rollout(policy, scenario, 21, np.arange(episodes), task).to_pydict()))
"""
OTHER_MODELS = """
fleet = catalogue_fleet(["wb-67d", "baggage-train", "b-double"])
for vehicle in (OffAxle(bodies=Rectangles(), actuators=Limited()), OffAxle(2, "euler")):
    scenario = RandomPoses(num_havs=3, fleet=fleet)
    task = Task(max_steps=100)
    policy = AvoidJack(beta=1.0)
    print(repr(rollout(policy, scenario, 21, np.arange(2), task, vehicle).to_pydict()))
limited = OnAxle(actuators=Limited())
for num_havs, episodes, steps in ((1, 2, 300), (3, 1, 150)):
    scenario, task = RandomPoses(num_havs=num_havs, area_factor=2.0), Task(max_steps=steps)
    table = rollout(AvoidJack(), scenario, 21, np.arange(episodes), task, limited)
    print(repr(table.to_pydict()))
other = AvoidJack(evasion_truck_share=0.5, evasion_center=0.5, evasion_clipped=True)
task = Task(max_steps=150, order="in_turn", record_every=4, potential_center=0.5)
for policy in (other, other._replace(evasion_from_center=True)):
    table = rollout(policy, RandomPoses(num_havs=3), 21, np.arange(2), task)
    print(repr(table.to_pydict()))
"""


@pytest.mark.skipif(not COMPILED, reason=COMPARED)
@pytest.mark.parametrize(
    "models",
    [
        pytest.param(POLICIES_ALONE, id="policies"),
        pytest.param(RESERVE_ALONE, id="Reserve", marks=pytest.mark.exhaustive),
        pytest.param(OTHER_MODELS, id="other models", marks=pytest.mark.exhaustive),
    ],
)
def test_compiled_code_and_pure_python_give_the_same_bits(models, capsys):
    script = IMPORTS + models
    other_mode = os.environ | {"NUMBA_DISABLE_JIT": "1", "HAV_THREADS": "1"}
    command = [sys.executable, "-c", script]
    other = subprocess.run(command, env=other_mode, capture_output=True, text=True, check=True)
    exec(script, {})
    own = capsys.readouterr().out
    assert len(own) > 5_000
    assert own == other.stdout


def test_the_environment_sets_the_number_of_threads(monkeypatch):
    monkeypatch.setenv("HAV_THREADS", "3")
    assert default_threads() == 3
    monkeypatch.delenv("HAV_THREADS")
    assert default_threads() >= 1


@pytest.mark.parametrize("wish", ["0", "-1", "two", "1.5"])
def test_a_number_of_threads_that_is_none_is_an_error(monkeypatch, wish):
    monkeypatch.setenv("HAV_THREADS", wish)
    with pytest.raises(ValueError, match=f"HAV_THREADS is '{wish}'"):
        default_threads()
