"""Actions are finite real numbers of one shape, in every interface."""

import copy
import decimal

import gymnasium as gym
import numpy as np
import pytest

from hav_env import parallel_env
from hav_env.envs.hav_swarm_v0 import env as one_by_one
from hav_env.envs.wrappers import PhysicalActions, PhysicalParallelActions
from hav_env.mdp.actions import read_action
from tests.support.comparing import exactly

SWARM, SINGLE = "hav_env:HAVSwarm-v0", "hav_env:HAVSingle-v0"


class Stubborn:
    """Cannot be converted to an array."""

    def __array__(self, *arguments, **keywords):
        """Refuse."""
        raise RuntimeError("I am\nno array")


NO_NUMBERS = [
    ["1", "0"],
    [b"1", b"0"],
    [1 + 0j, 0],
    np.array([1 + 0j, 0]),
    [None, 0.0],
    None,
    "fast",
    {"speed": 1},
    {0.5},
    [True, False],
    [True, 0.5],
    np.array([True, False]),
    np.array([0.5, 0.5], object),
    [decimal.Decimal(1), 0],
    [10**400, 0],
    np.array(["2020-01-01", "2020-01-02"], "M8[D]"),
    np.zeros(2, [("speed", float)]),
    [[1.0], [1.0, 2.0]],
    Stubborn(),
]
OTHER_SHAPES = [0.5, [], [0.5], [0.5] * 3, [[0.5, 0.5]], np.zeros((2, 1)), np.zeros((1, 2, 2))]
NOT_FINITE = [
    [np.nan, 0.0],
    [0.0, np.inf],
    np.array([-np.inf, 0.0]),
    np.array([np.nan, 0], np.float16),
]
WRONG = [
    *((action, TypeError, "must be real numbers") for action in NO_NUMBERS),
    *((action, ValueError, r"has shape .*, but must have \(2,\)") for action in OTHER_SHAPES),
    *((action, ValueError, "holds -?(nan|inf), but must be finite") for action in NOT_FINITE),
]
wrong = pytest.mark.parametrize(
    ("action", "error", "rule"), WRONG, ids=lambda part: repr(part)[:30]
)


def in_parallel(env, action):
    env.step({"hav_0": np.zeros(2), "hav_1": action})


def in_turn(env, action):
    env.step(np.zeros(2))
    env.step(action)


def alone(env, action):
    env.step(action)


@pytest.fixture(scope="module")
def faces():
    """Return one environment of each interface, begun."""
    pair, single = parallel_env(), gym.make(SINGLE).unwrapped
    made = {
        "parallel": (pair, in_parallel, "the action of hav_1"),
        "in m/s": (PhysicalParallelActions(parallel_env()), in_parallel, "the action of hav_1"),
        "in turn": (one_by_one(), in_turn, "the action of hav_1"),
        "single": (single, alone, "the action"),
        "single in m/s": (PhysicalActions(gym.make(SINGLE).unwrapped), alone, "the action"),
    }
    for env, _, _ in made.values():
        env.reset(seed=0)
    return made


@wrong
@pytest.mark.parametrize("face", ["parallel", "in m/s", "in turn", "single", "single in m/s"])
def test_what_is_no_action_is_refused_in_one_line(faces, face, action, error, rule):
    env, step, name = faces[face]
    if face == "in turn":
        env.reset(seed=0)
    with pytest.raises(error, match=rule) as told:
        step(env, action)
    assert str(told.value).startswith(f"{name} ")
    assert "\n" not in str(told.value)
    assert len(str(told.value)) < 250


def test_many_worlds_are_read_as_one():
    actions = np.zeros((50, 2, 2))
    actions[37, 1, 0] = np.inf
    with pytest.raises(ValueError, match="the actions holds inf, but must be finite"):
        read_action("the actions", actions, (50, 2, 2))
    with pytest.raises(ValueError, match=r"shape \(50, 2, 2\), but must have \(51, 2, 2\)"):
        read_action("the actions", actions, (51, 2, 2))


ALIKE = [
    np.array([1.0, -1.0]),
    np.array([1, -1], np.float32),
    np.array([1, -1], np.int8),
    np.array([1, 7, -1])[::2],
    [1, -1],
    (1.0, np.float16(-1)),
]


@pytest.mark.parametrize("action", ALIKE, ids=repr)
def test_all_ways_to_write_a_number_are_the_same_action(action):
    made = parallel_env(), gym.make(SINGLE).unwrapped, one_by_one()
    for env in made:
        env.reset(seed=0)
    together, single, turns = made
    one = together.step(dict.fromkeys(together.agents, action))[0]
    for _ in range(2):
        turns.step(action)
    assert exactly(one["hav_0"]) == exactly(turns.observe("hav_0"))
    twin = gym.make(SINGLE).unwrapped
    twin.reset(seed=0)
    assert exactly(single.step(action)) == exactly(twin.step(np.array(ALIKE[0])))


def test_the_order_of_memory_is_no_part_of_an_action():
    action = np.array([[1.0, -0.5], [0.25, 0.5]])
    outcomes = []
    for order in (np.ascontiguousarray, np.asfortranarray):
        env = gym.make(SWARM).unwrapped
        env.reset(seed=0)
        outcomes.append(exactly(env.step(order(action))))
    assert outcomes[0] == outcomes[1]


@pytest.mark.parametrize("actions", [None, 1, [np.zeros(2)] * 2, "hav_0", np.zeros((2, 2))])
def test_actions_of_agents_are_a_mapping(actions):
    for env in (parallel_env(), PhysicalParallelActions(parallel_env())):
        env.reset(seed=0)
        with pytest.raises(TypeError, match=r"^actions is .*, but must be a dictionary"):
            env.step(actions)


@pytest.mark.parametrize("stranger", ["hav_2", "hav_01", 0, None, ("hav_0",), b"hav_0"])
def test_an_agent_that_does_not_exist_is_named(stranger):
    env = parallel_env()
    env.reset(seed=0)
    actions = dict.fromkeys(env.agents, np.zeros(2))
    with pytest.raises(ValueError, match=r"there is no agent .* to act; agents: hav_0, hav_1"):
        env.step(actions | {stranger: np.zeros(2)})


def test_an_action_that_was_refused_changes_nothing():
    env = parallel_env()
    env.reset(seed=0)
    twin, proper = copy.deepcopy(env), dict.fromkeys(env.agents, np.ones(2))
    for action, error, _ in WRONG:
        with pytest.raises(error):
            env.step({"hav_0": np.ones(2), "hav_1": action})
    assert exactly(env.step(proper)) == exactly(twin.step(proper))


def test_in_turn_an_array_may_be_used_again():
    apart, reused = one_by_one(), one_by_one()
    buffer = np.zeros(2)
    for env in (apart, reused):
        env.reset(seed=0)
    for speed in (1.0, -1.0):
        apart.step(np.array([speed, 0.3]))
        buffer[:] = speed, 0.3
        reused.step(buffer)
    for agent in apart.agents:
        assert np.array_equal(apart.observe(agent), reused.observe(agent))


def test_in_turn_a_refused_action_can_be_given_again():
    env, twin = one_by_one(), one_by_one()
    for one in (env, twin):
        one.reset(seed=0)
    with pytest.raises(TypeError, match="the action of hav_0"):
        env.step(["1", "0"])
    assert env.agent_selection == "hav_0"
    for one in (env, twin):
        one.step(np.ones(2))
        one.step(np.ones(2))
    assert np.array_equal(env.observe("hav_1"), twin.observe("hav_1"))


def test_in_turn_who_has_left_passes_none():
    env = one_by_one(max_cycles=1)
    env.reset(seed=0)
    for _ in env.agents.copy():
        env.step(np.zeros(2))
    assert all(env.truncations.values())
    with pytest.raises(ValueError, match=r"the action of hav_0 is .*, but must be None"):
        env.step(np.zeros(2))
    for _ in env.agents.copy():
        env.step(None)
    assert env.agents == []
