"""A mistake in a user's code is one line with file and line, before anything is compiled."""

import importlib
import re
import sys
import textwrap

import numpy as np
import pytest

from baselines.replay.trajectory import record_trajectory
from hav_env import (
    Batch,
    PolicyDriver,
    RandomPoses,
    Task,
    act,
    act_lanes,
    find_scenario,
    move,
    parallel_env,
    populate,
    rollout,
)
from hav_env.policies import check_policy
from tests.support.budgets import COMPILED, budget

MODULE = """
    from __future__ import annotations

    from typing import NamedTuple

    import numpy as np

    from hav_env import RandomFleet, act, act_lanes, move, populate, sensing


    class Mine(NamedTuple):
        gain: float = 1.0
        fleet: RandomFleet = RandomFleet()
        num_havs: int = 2
        num_goals: int = 1
        max_trailers: int = 3
        articulation_max: float = 1.5


    @{register}.register(Mine)
    def mine({arguments}):
        {body}
"""
NAMES = "written_here", "w1", "w2"
ACT = "policy, memory, world, agent, lane"
LANES = "policy, memory, world, agent, speed, steering"


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """Return a function that writes and imports a module, and returns its model."""
    monkeypatch.syspath_prepend(tmp_path)

    def make(register, arguments, body, template=MODULE, name=NAMES[0]):
        text = template.format(register=register, arguments=arguments, body=body)
        (tmp_path / f"{name}.py").write_text(textwrap.dedent(text))
        sys.modules.pop(name, None)
        importlib.invalidate_caches()
        return importlib.import_module(name).Mine()

    yield make
    for name in NAMES:
        sys.modules.pop(name, None)
    for table in (act.table, act_lanes.table, move.table, populate.table):
        for model in [model for model in table if model.__module__ in NAMES]:
            del table[model]  # other tests count the registered models


@pytest.mark.parametrize(
    ("register", "arguments", "body", "told"),
    [
        ("act", ACT, "return sensing.goal_posee(world, agent, lane)", "has no attribute 'goal_p"),
        ("act", ACT, "return undefined, 0.0", "name 'undefined' is not defined"),
        ("act", ACT, "return 1.0", "returns 1.0, but must return speed and steering"),
        ("act", ACT, "pass", "returns None, but must return speed and steering"),
        ("act", ACT, "return 1.0, None", r"returns \(1.0, None\), but must return"),
        ("act", ACT, "return 1.0, np.nan", r"returns \(1.0, nan\), but must return"),
        ("act", "policy, memory, world", "return 1.0, 0.0", "TypeError: mine\\(\\) takes 3"),
        ("act_lanes", LANES, "speed[agent] = 1.0", "must write finite speeds and steering"),
        ("act_lanes", LANES, "spead[agent] = 1.0", "name 'spead' is not defined"),
    ],
)
def test_a_wrong_policy_is_one_line(register, arguments, body, told, mine):
    policy = mine(register, arguments, body)
    with pytest.raises(ValueError, match=told) as error:
        check_policy(policy, RandomPoses())
    assert re.search(r"written_here.py, line (19|2\d)\)$", str(error.value))
    assert "\n" not in str(error.value)
    with pytest.raises(ValueError, match=told):  # and again: a failed trial does not count as tried
        rollout(policy, RandomPoses(), 0, np.arange(1))


@pytest.mark.parametrize(
    ("register", "arguments", "body", "told"),
    [
        ("populate", "scenario, world, lane", "world.state.xx[0] = 1.0", "no attribute 'xx'"),
        ("populate", "scenario, world, lane", "pass", "returns None, but must return whether"),
        ("move", "vehicle, dt, world, agent", "wrong()", "name 'wrong' is not defined"),
        ("move", "vehicle, dt, world, agent", "world.state.x[agent] = np.nan", "is not finite"),
    ],
)
def test_a_wrong_scenario_or_vehicle_is_one_line(register, arguments, body, told, mine):
    model = mine(register, arguments, body)
    with pytest.raises(ValueError, match=told) as error:
        Batch(model) if register == "populate" else Batch(RandomPoses(), vehicle=model)
    assert re.search(r"written_here.py, line (19|2\d)\)$", str(error.value))


NEIGHBORS = "for k in range(sensing.num_neighbors(world, agent, lane)):\n            "


@pytest.mark.parametrize(
    ("body", "told"),
    [
        (f"{NEIGHBORS}sensing.neighbour_distance(world, agent, k, lane)", "no attribute 'neighb"),
        ("return undefined if policy.gain < 0.0 else 1.0, 0.0", "name 'undefined' is not defined"),
        ("return helper(policy.gain), 0.0", "name 'missing' is not defined"),
        (f"{NEIGHBORS}return 1.0, None", r"returns \(1.0, None\), but must return"),
    ],
)
def test_mistakes_in_branches_loops_and_helpers_are_found_before_compiling(body, told, mine):
    helper = "@kernel\n    def helper(x):\n        return x if x > 0.0 else missing\n\n\n    @act."
    text = MODULE.replace(
        "    @{register}.", f"    from hav_env.compiled import kernel\n\n\n    {helper}"
    )
    policy = mine("act", ACT, body, text)
    with pytest.raises(ValueError, match=told) as error:
        check_policy(policy, RandomPoses(num_havs=2))
    assert re.search(r"written_here.py, line \d+\)$", str(error.value))


@pytest.mark.parametrize(
    ("body", "missing"),
    [
        (
            "return sensing.neighbor_distance(world, agent, 0, lane), 0.0",
            "neighbour 0 of a HAV that",
        ),
        ("return sensing.neighbor_distance(world, agent, -1, lane), 0.0", "neighbour -1 of a HAV"),
        (
            "if sensing.num_neighbors(world, agent, lane) > 0:\n"
            "            return sensing.neighbor_distance(world, agent, 1, lane), 0.0\n"
            "        return 0.0, 0.0",
            "neighbour 1 of a HAV that has 1",
        ),
        (
            f"if sensing.num_neighbors(world, agent, lane) == 0:\n"
            f"            memory[agent, 0, lane] = 1.0\n        {NEIGHBORS}pass\n"
            f"        return 0.0, 0.0",
            "its memory has 0 numbers for each HAV, by memory_size: register memory_size",
        ),
    ],
)
@pytest.mark.parametrize("num_havs", [2, 50])
def test_what_compiled_code_would_read_beyond_an_array_is_an_error(body, missing, num_havs, mine):
    """In some states a HAV has no neighbours; the policy must not count on any."""
    with pytest.raises(ValueError, match=re.escape(missing)) as error:
        check_policy(mine("act", ACT, body), RandomPoses(num_havs=num_havs))
    assert re.search(r"written_here.py, line (19|2\d)\)$", str(error.value))


def test_neighbours_that_exist_may_be_read(mine):
    body = f"{NEIGHBORS}sensing.neighbor_distance(world, agent, k, lane)\n        return 1.0, 0.0"
    check_policy(mine("act", ACT, body), RandomPoses(num_havs=5))


def test_a_command_that_is_no_number_is_an_error_wherever_it_drives(mine):
    late = "sensing.episode_key(world, lane)[2] > 3 and agent == 1"
    policy = mine("act", ACT, f"return 1.0, (np.nan if {late} else 0.0)")
    told = "policy Mine returned a speed or steering that is not finite: hav_1 in episode 7 of"
    task = Task(max_steps=6)
    with pytest.raises(ValueError, match=told):
        rollout(policy, "paper-pair", 5, [7], task, threads=1)
    with pytest.raises(ValueError, match=told):
        record_trajectory(policy, find_scenario("paper-pair"), 5, 7, task)
    batch = Batch(find_scenario("paper-pair"))
    driver = PolicyDriver(policy, batch)
    batch.reset(5, np.array([7]))
    for _ in range(4):
        batch.step(*driver.decide())
    with pytest.raises(ValueError, match=told):
        driver.decide()


@pytest.mark.skipif(not COMPILED, reason="plain Python has nothing against it")
@pytest.mark.parametrize(
    ("body", "told"),
    [
        ("best = None if agent > 5 else [1.0]\n        return best[0], 0.0", "allocates memory"),
        pytest.param(
            "return np.interp(0.5, [0.0, 1.0], [0.0, policy.gain]), 0.0",
            "cannot compile",
            marks=pytest.mark.exhaustive,
        ),
    ],
)
def test_what_numba_refuses_is_the_users_line(body, told, mine, monkeypatch):
    """The place is the user's, from any folder and even where Numba states no file of its own."""
    monkeypatch.chdir("/")
    policy = mine("act", ACT, body)
    with pytest.raises(TypeError, match=told) as error:
        rollout(policy, RandomPoses(), 0, np.arange(1), threads=1)
    assert re.search(r"written_here.py, line (19|2\d)\)$", str(error.value))


@pytest.mark.skipif(not COMPILED, reason="plain Python has nothing against it")
def test_what_numba_refuses_is_one_line(mine):
    policy = mine("act", ACT, "return (1.0 if agent == 0 else [1.0][lane]), max(policy, key=abs)")
    with pytest.raises((TypeError, ValueError)) as error:
        rollout(policy, RandomPoses(), 0, np.arange(1), threads=1)
    assert len(str(error.value).splitlines()) == 1


def test_what_only_plain_python_refuses_is_no_mistake(mine):
    check_policy(mine("act", ACT, "return 1.0 / float(agent * 0), 0.0"), RandomPoses())


POLICY = """
    from typing import NamedTuple

    from hav_env import act


    class Mine(NamedTuple):
        gain: float = 1.0


    @act.register(Mine)
    def mine(policy, memory, world, agent, lane):
        {body}
"""


def test_classes_of_one_name_keep_their_own_code(mine):
    """Modules may call their policies the same."""
    batch = Batch(RandomPoses(), 1)
    batch.reset(0)
    for name, speed in zip(NAMES[1:], (0.25, 0.5), strict=True):
        driver = PolicyDriver(mine("", "", f"return {speed}, 0.0", POLICY, name), batch)
        assert np.all(driver.decide()[0] == speed)


REWARD = """
    from typing import NamedTuple

    from hav_env import reward_terms


    class Mine(NamedTuple):
        first: float = 1.0
        second: float = 1.0


    @reward_terms.register(Mine)
    def mine(reward, duration, world, agent, before, remaining, terms):
        {body}
"""


@pytest.mark.parametrize(
    ("body", "told"),
    [
        ("terms[0, agent] = 1.0", "mine does not write the term 'second'"),
        ("terms[:, agent] = undefined", "name 'undefined' is not defined"),
        ("terms[5, agent] = 1.0", "raises IndexError: index 5 is out of bounds"),
    ],
)
def test_a_wrong_reward_is_one_line(body, told, mine):
    reward = mine("", "", body, REWARD)
    with pytest.raises(ValueError, match=told) as error:
        parallel_env(reward=reward)
    assert re.search(r"written_here.py, line 1\d\)$", str(error.value))


def test_a_right_policy_under_future_annotations_runs(mine):
    policy = mine("act", ACT, "return policy.gain, 0.0")
    task = Task(max_steps=budget(Task().max_steps, 20))
    table = rollout(policy, "paper-pair", 0, np.arange(2), task, threads=1)
    assert table.num_rows == 4
    with pytest.raises(TypeError, match="policy gain is one, a str and not a number"):
        check_policy(policy._replace(gain="one"), RandomPoses())
