"""One world, stepped with the same arrays every time, has the bits of a decision process."""

import copy

import numpy as np
import pytest

from hav_env import Reward, Task
from hav_env.envs.single_world import SingleWorld
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.mdp.one_world import OneWorld
from tests.support.budgets import budget
from tests.support.comparing import exactly
from tests.support.worlds import side_by_side

STEPS = budget(400, 8)
ARRIVING = {
    "scenario": side_by_side(2.0, 3.0, 4.0),
    "task": Task(max_steps=20, distance_tolerance=1.5, heading_tolerance=4.0),
}
CASES = {
    "pair": ({"max_steps": 150}, ()),
    "held": ({"max_steps": 150, "frame_skip": 3}, ()),
    "arriving": (ARRIVING, ()),
    "among others": ({"num_havs": 3, "frame_skip": 2, "max_steps": 60}, (1, "avoid_jack")),
    "single precision": ({"precision": "single", "max_steps": 150}, ()),
}
MARKED = {"single precision": pytest.mark.exhaustive}
cases = pytest.mark.parametrize(
    ("settings", "others"),
    [pytest.param(*case, id=name, marks=MARKED.get(name, ())) for name, case in CASES.items()],
)


def begun(settings, others):
    process = DecisionProcess(1, *others, **settings)
    one = OneWorld(process)
    begin(process, one.outcome, 0)
    one.begin()
    return process, one


def begin(process, outcome, number):
    process.begin(np.array([5]), np.array([number]), np.ones(1, np.bool_), outcome)


def named(process, outcome):
    return [dict(zip(process.info, own, strict=True)) for own in outcome.info[..., 0].T.tolist()]


@cases
def test_one_world_is_a_decision_process(settings, others):
    (process, one), (process_too, _) = begun(settings, others), begun(settings, others)
    outcome, rng, number = process_too.outcome(), np.random.default_rng(0), 0
    for _ in range(STEPS):
        actions = rng.uniform((-0.2, -1.0), (1.0, 1.0), (1, process.num_controlled, 2))
        one.step(actions.ravel().tolist())
        process_too.step(actions, outcome)
        assert exactly(one.outcome) == exactly(outcome)
        infos = one.infos()
        assert exactly(infos) == exactly(named(process_too, outcome))
        assert [list(info) for info in infos] == [list(process.info)] * process.num_controlled
        if outcome.terminated[0] or outcome.truncated[0]:
            number += 1
            begin(process, one.outcome, number)
            one.begin()
            begin(process_too, outcome, number)
            assert exactly(one.infos()) == exactly(named(process_too, outcome))
    assert number > 0 or budget(0, 1)


def test_a_changed_reward_counts_from_the_next_step_on():
    process, one = begun({}, ())
    one.step([0.5] * 4)
    process.set_reward(Reward(time=-1_000.0))
    one.step([0.5] * 4)
    assert (one.outcome.reward < -100.0).all()


def test_infos_of_one_step_outlive_the_next():
    _, one = begun({}, ())
    one.step([0.5] * 4)
    infos = one.infos()
    before = copy.deepcopy(infos)
    infos_too = one.infos()
    infos_too[0]["steps"] = -1.0  # the caller owns its dictionaries
    one.step([0.5] * 4)
    assert exactly(infos) == exactly(before)
    assert one.infos()[0]["steps"] == 2.0


def test_a_copy_within_an_episode_has_the_same_infos():
    world = SingleWorld(None)
    world.begin(world.plan(3, None, np.random.default_rng(0)))
    for k in range(budget(30, 3)):
        twin = copy.deepcopy(world)
        for one in (world, twin):
            one.step([0.8, 0.1, 0.6, -0.2])
        assert exactly(twin.infos()) == exactly(world.infos())
        if k % 2:
            world = twin
