"""The vector environments equal Gymnasium's own over single ones, step for step and bit for bit."""

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

from hav_env import Observation, PlacementError, RandomPoses, Task
from tests.support.budgets import budget
from tests.support.comparing import exactly, leaves
from tests.support.worlds import side_by_side

NUM_WORLDS, STEPS = budget(5, 3), budget(60, 12)
SWARM, SINGLE = "hav_env:HAVSwarm-v0", "hav_env:HAVSingle-v0"
SHORT = {"max_steps": 7}
# goals are hit at different times, so that worlds of one vector end one after the other
EASY = {"task": Task(max_steps=budget(25, 9), distance_tolerance=50.0, heading_tolerance=4.0)}
EASY_TO_HIT = {"task": Task(max_steps=20, distance_tolerance=1.5, heading_tolerance=4.0)}
CASES = {
    "swarm": (SWARM, SHORT),
    "swarm that arrives": (SWARM, EASY),
    "single": (SINGLE, SHORT),
    "single that arrives": (SINGLE, EASY),
    "flat": (SWARM, SHORT | {"flatten": True}),
    "sum": (SWARM, SHORT | {"team_reward": "sum", "num_havs": 5}),
    "mean": (SWARM, SHORT | {"team_reward": "mean", "num_havs": 5}),
    "min": (SWARM, SHORT | {"team_reward": "min", "num_havs": 5}),
    "driven others": (SINGLE, SHORT | {"others": "avoid_jack", "num_havs": 3}),
    "driven others, held": (
        SINGLE,
        SHORT | {"others": "avoid_jack", "num_havs": 3, "frame_skip": 2},
    ),
    "held": (SWARM, SHORT | {"frame_skip": 3}),
    "reported at ends": (SWARM, EASY | {"info": "ends"}),
    "single, reported at ends": (SINGLE, EASY | {"info": "ends"}),
    "crossing": (SWARM, SHORT | {"scenario": "crossing-8"}),
    "yard": (SWARM, SHORT | {"scenario": "yard-4"}),
    "column": (SWARM, SHORT | {"scenario": "column-5"}),
    "explicit": (SWARM, {"scenario": side_by_side(2.0, 3.0), "on_goal": "remove", **EASY_TO_HIT}),
    "chains": (SWARM, SHORT | {"observation": Observation(neighbors=3, chains=True)}),
}
LONG = ("yard", "column")  # code that few other tests compile
cases = pytest.mark.parametrize(
    ("name", "settings"),
    [
        pytest.param(*case, id=name, marks=[pytest.mark.exhaustive] if name in LONG else [])
        for name, case in CASES.items()
    ],
)


def single(name, settings):
    """Return a function that makes a single environment without wrappers."""
    return lambda: gym.make(name, **settings).unwrapped


def pair(name, settings, mode, num_worlds=NUM_WORLDS):
    """Return our own vector environment and Gymnasium's over single ones."""
    own = gym.make_vec(name, num_envs=num_worlds, autoreset_mode=mode, **settings)
    return own, SyncVectorEnv([single(name, settings)] * num_worlds, autoreset_mode=mode)


def assert_same(own, other):
    """Compare all results; Gymnasium leaves out infos that no world reported."""
    own, other = exactly(own), exactly(other)
    assert own.keys() == other.keys()
    for name, value in other.items():
        assert own[name] == value, name


@cases
@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_a_vector_is_its_worlds_one_by_one(name, settings, mode):
    own, other = pair(name, settings, mode)
    assert own.observation_space == other.observation_space
    assert own.action_space == other.action_space
    assert_same(own.reset(seed=4), other.reset(seed=4))
    rng, ends = np.random.default_rng(0), np.zeros(NUM_WORLDS)
    for _ in range(STEPS):
        actions = rng.uniform(-1, 1, own.action_space.shape).astype(np.float32)
        actions[..., 0 :: own.single_action_space.shape[-1]] = 1.0
        outcome = own.step(actions)
        assert_same(outcome, other.step(actions))
        ends += outcome[2] | outcome[3]
    assert (ends > 0).all()
    assert_same(own.reset(), other.reset())


@cases
def test_worlds_that_ended_are_reset_by_hand_where_that_is_wanted(name, settings):
    own, other = pair(name, settings, AutoresetMode.DISABLED)
    assert_same(own.reset(seed=4), other.reset(seed=4))
    rng, resets = np.random.default_rng(0), 0
    for _ in range(STEPS):
        actions = rng.uniform(-1, 1, own.action_space.shape).astype(np.float32)
        outcome = own.step(actions)
        assert_same(outcome, other.step(actions))
        mask = outcome[2] | outcome[3]
        if mask.any():
            resets += 1
            begun = own.reset(options={"reset_mask": mask.copy()})
            assert_same(begun, other.reset(options={"reset_mask": mask.copy()}))
    assert resets > 0


def test_worlds_that_go_on_are_left_alone_by_a_reset_of_others():
    masked, plain = (
        gym.make_vec(SWARM, num_envs=3, autoreset_mode="Disabled", max_steps=50) for _ in range(2)
    )
    for env in (masked, plain):
        env.reset(seed=1)
    actions = np.random.default_rng(0).uniform(-1, 1, (10, *plain.action_space.shape))
    for step, action in enumerate(actions):
        seen, reward, *_, info = masked.step(action)
        seen_then, reward_then, *_, info_then = plain.step(action)
        for w in (0, 2):
            assert np.array_equal(seen[w], seen_then[w])
            assert reward[w] == reward_then[w]
            assert all(np.array_equal(info[k][w], info_then[k][w]) for k in info)
        if step == 4:
            mask = np.array([False, True, False])
            begun, _ = masked.reset(seed=[7, 9, 7], options={"reset_mask": mask})
            assert np.array_equal(begun[[0, 2]], seen[[0, 2]])
    assert info["seed"][:, 0].tolist() == [1, 9, 3]


def test_the_first_reset_begins_all_worlds():
    env, twin = (gym.make_vec(SWARM, num_envs=3) for _ in range(2))
    mask = np.array([True, False, True])
    with pytest.raises(ValueError, match="reset_mask is false for world 1, but must be true for"):
        env.reset(seed=4, options={"reset_mask": mask})
    with pytest.raises(RuntimeError, match="call reset before step: there is no episode yet"):
        env.step(np.zeros(env.action_space.shape))
    _, info = env.reset(seed=4, options={"reset_mask": np.ones(3, np.bool_)})
    assert info["episode_number"].tolist() == [[0.0, 0.0]] * 3
    assert exactly(twin.reset(seed=4)[1]) == exactly(info)


def test_each_world_has_its_own_seed_and_goes_on_with_it():
    env = gym.make_vec(SWARM, num_envs=3, max_steps=1)
    _, info = env.reset(seed=5)
    assert info["seed"][:, 0].tolist() == [5, 6, 7]
    _, info = env.reset(seed=[3, None, 4])
    assert info["seed"][:, 0].tolist() == [3, 6, 4]
    assert info["episode_number"][:, 0].tolist() == [0, 1, 0]
    for _ in range(2):  # an end and the step after it
        *_, info = env.step(env.action_space.sample())
    assert info["episode_number"][:, 0].tolist() == [1, 2, 1]


def test_one_thread_equals_two_when_there_are_many_worlds():
    worlds = budget(600, 40)
    made = [
        gym.make_vec(SWARM, num_envs=worlds, num_havs=4, threads=t, max_steps=20) for t in (1, 2)
    ]
    assert [env.unwrapped._process._threads for env in made] == [1, 2 if worlds >= 512 else 1]
    one, two = made
    assert exactly(one.reset(seed=0)) == exactly(two.reset(seed=0))
    rng = np.random.default_rng(0)
    for _ in range(budget(60, 3)):
        actions = rng.uniform(-1, 1, one.action_space.shape)
        assert exactly(one.step(actions)) == exactly(two.step(actions))


def test_final_numbers_are_told_of_the_worlds_that_ended_only():
    env = gym.make_vec(SWARM, num_envs=4, autoreset_mode="SameStep", **EASY)
    env.reset(seed=2)
    ended_one_by_one = False
    for _ in range(40):
        _, _, terminated, truncated, info = env.step(np.tile([1.0, 0.0], (4, 2, 1)))
        ended = terminated | truncated
        assert ("final_info" in info) == ("final_obs" in info) == ended.any()
        if ended.any():
            ended_one_by_one |= not ended.all()
            assert np.array_equal(info["_final_obs"], ended)
            assert [seen is not None for seen in info["final_obs"]] == ended.tolist()
            assert (info["final_info"]["steps"][ended] > 0).all()
            assert (info["final_info"]["steps"][~ended] == 0).all()
            assert (info["steps"][ended] == 0).all()
    assert ended_one_by_one


def test_no_array_of_a_return_is_an_array_that_the_environment_goes_on_to_use():
    """Writing into flags and masks changes nothing."""
    for mode in AutoresetMode:
        one, other = (
            gym.make_vec(SWARM, num_envs=3, autoreset_mode=mode, max_steps=3) for _ in "ab"
        )
        for env in (one, other):
            env.reset(seed=0)
        for _ in range(6):
            actions = np.ones(one.action_space.shape)
            outcomes = one.step(actions), other.step(actions)
            assert exactly(outcomes[0]) == exactly(outcomes[1])
            over = (outcomes[0][2] | outcomes[0][3]).copy()
            for part in leaves(outcomes[0]).values():
                if isinstance(part, np.ndarray):
                    part[...] = 1
            if mode == AutoresetMode.DISABLED and over.any():
                for env in (one, other):
                    env.reset(options={"reset_mask": over.copy()})


TIGHT = RandomPoses(num_havs=4, area_factor=2.5, pose_attempts=4, world_attempts=1)


def without_room(env):
    """Return a seed for which the scenario cannot place HAVs in some worlds, but not all."""
    for seed in range(0, 400, 10):
        try:
            env.reset(seed=seed)
        except PlacementError:
            return seed
    raise AssertionError("make the scenario tighter")


def test_worlds_without_room_are_not_stepped_until_they_begin():
    env = gym.make_vec(SWARM, num_envs=2, scenario=TIGHT)
    without_room(env)
    still = np.zeros(env.action_space.shape)
    with pytest.raises(RuntimeError, match="call reset before step"):
        env.step(still)
    for seed in range(5, 400, 10):
        try:
            env.reset(seed=seed)
            break
        except PlacementError:
            continue
    env.step(still)


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_an_autoreset_without_room_asks_for_a_reset(mode):
    env = gym.make_vec(SWARM, num_envs=4, scenario=TIGHT, max_steps=1, autoreset_mode=mode)
    for seed in range(0, 4_000, 10):
        try:
            env.reset(seed=seed)
            break
        except PlacementError:
            continue
    still = np.zeros(env.action_space.shape)

    def step_on():
        for _ in range(300):
            env.step(still)

    with pytest.raises(PlacementError):
        step_on()
    with pytest.raises(RuntimeError, match="call reset before step"):
        env.step(still)


@pytest.mark.parametrize(
    ("arguments", "kind", "message"),
    [
        ({"options": 1}, TypeError, "options is 1, but must be a dict or None"),
        ({"options": ["reset_mask"]}, TypeError, "options is"),
        ({"options": {"reset_mask": [True] * 3}}, TypeError, "must be an array of bool"),
        ({"options": {"reset_mask": np.ones(3)}}, TypeError, "must be an array of bool"),
        ({"options": {"reset_mask": np.ones(4, bool)}}, ValueError, "reset_mask has shape"),
        ({"options": {"reset_mask": np.zeros(3, bool)}}, ValueError, "reset_mask is all false"),
        ({"seed": -1}, ValueError, "seed is -1"),
        ({"seed": 2**32 - 2}, ValueError, "seed is 4294967294, but must be at most"),
        ({"seed": [1, 2]}, ValueError, "2 seeds were given for 3 worlds"),
        ({"seed": [1, 2, -3]}, ValueError, "seed is -3"),
        ({"seed": {1, 2, 3}}, (TypeError, ValueError), "seed is"),
        ({"seed": 1.5}, (TypeError, ValueError), "seed is 1.5"),
        ({"seed": "123"}, (TypeError, ValueError), "seed is"),
        ({"seed": np.array(3)}, TypeError, "seed is 3, a ndarray and not a whole number"),
    ],
)
def test_a_refused_reset_changes_nothing(arguments, kind, message):
    env, twin = (gym.make_vec(SWARM, num_envs=3) for _ in range(2))
    for one in (env, twin):
        one.reset(seed=7)
    with pytest.raises(kind, match=message):
        env.reset(**arguments)
    assert np.array_equal(env.reset()[0], twin.reset()[0])


def test_nothing_is_drawn_before_the_first_reset():
    env = gym.make_vec(SWARM, num_envs=2, render_mode="ansi")
    with pytest.raises(RuntimeError, match="call reset before render"):
        env.render()
