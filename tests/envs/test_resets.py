"""An invalid reset changes nothing; before the first there is no episode."""

import copy

import gymnasium as gym
import numpy as np
import pytest

import hav_env
from hav_env import parallel_env
from hav_env.envs.hav_swarm_v0 import env as one_by_one
from tests.support.comparing import exactly

SWARM, SINGLE = "hav_env:HAVSwarm-v0", "hav_env:HAVSingle-v0"
FACES = {
    "parallel": parallel_env,
    "in turn": one_by_one,
    "swarm": lambda **settings: gym.make(SWARM, **settings),
    "bare": lambda **settings: gym.make(SWARM, **settings).unwrapped,
    "single": lambda **settings: gym.make(SINGLE, **settings).unwrapped,
}
faces = pytest.mark.parametrize("face", list(FACES.values()), ids=FACES)
BARE = {name: FACES[name] for name in ("parallel", "bare", "single")}
bare = pytest.mark.parametrize("face", list(BARE.values()), ids=BARE)

WORDS = [{1, 2}, "5", b"5", True, False, 1j, [1], (1,), {"seed": 1}, np.array([1]), np.True_]
SEEDS = [*WORDS, 1.0, 0.5, np.nan, np.float32(3), -1, -(2**70), 2**32, 2**70, 10**400]
OPTIONS = [1, True, "episode", ["episode"], [], {1, 2}, np.zeros(2)]
OPTIONS += [{1: 2}, {None: 1}, {b"episode": 1}]
VALUES = [
    *({"episode": word} for word in WORDS),
    *({"episode": number} for number in (-1, 1.5, np.nan, 2**32, 10**400)),
    {"start": [[0, 0]]},
    {"lengths": [[3.0, -4.0]] * 2},
    {"goals": [[[np.nan, 0, 0]] * 2] * 2},
]


def refuse(env, **asked):
    with pytest.raises((TypeError, ValueError)) as told:
        env.reset(**asked)
    assert "task" not in str(told.value)  # it is about the user's argument
    return str(told.value)


def seen(env, **asked):
    """Return the results of a reset of an environment."""
    told = env.reset(**asked)
    return exactly(told if told is not None else [env.observe(a) for a in env.agents])


@faces
@pytest.mark.parametrize("seed", SEEDS, ids=lambda seed: repr(seed)[:20])
def test_a_seed_is_a_whole_number_of_32_bits(face, seed):
    said = refuse(face(), seed=seed)
    assert "\n" not in said
    assert "seed" in said.lower()


@bare
@pytest.mark.parametrize("seed", [np.int64(7), np.uint8(7), np.int32(7)])
def test_whole_numbers_of_numpy_are_seeds(face, seed):
    assert seen(face(), seed=seed) == seen(face(), seed=7)


@faces
@pytest.mark.parametrize("options", OPTIONS, ids=repr)
def test_options_are_a_mapping_with_words_as_keys(face, options):
    assert refuse(face(), seed=0, options=options).startswith("options ")


@bare
@pytest.mark.parametrize("begun", ["seeded", "not seeded", "not begun"])
def test_a_refused_reset_changes_nothing(face, begun):
    env = face()
    if begun != "not begun":
        env.reset(seed=11 if begun == "seeded" else None)
    assert env.np_random is not None  # Gymnasium makes it at first access
    twin = copy.deepcopy(env)
    asked = [
        *({"seed": seed} for seed in SEEDS),
        *({"options": options} for options in (*OPTIONS, *VALUES)),
        *({"seed": 5, "options": options} for options in (*OPTIONS, *VALUES)),
    ]
    for wrong in asked:
        refuse(env, **wrong)
    if begun == "not begun":
        act = {"hav_0": np.zeros(2)} if face is parallel_env else np.zeros(env.action_space.shape)
        with pytest.raises(RuntimeError, match="call reset before step"):
            env.step(act)
    else:  # the present episode continues
        held = getattr(env, "agents", None)
        act = np.ones(env.action_space.shape) if held is None else dict.fromkeys(held, np.ones(2))
        assert exactly(env.step(act)) == exactly(twin.step(act))
    assert seen(env) == seen(twin)
    assert seen(env) == seen(twin)
    assert env.np_random.random() == twin.np_random.random()


def test_an_episode_without_room_is_none_and_the_next_reset_takes_the_next_number():
    tight = hav_env.RandomPoses(num_havs=4, area_factor=2.5, pose_attempts=4, world_attempts=1)
    env = parallel_env(scenario=tight, render_mode="ansi")
    seed = next(seed for seed in range(400) if not reset_if_room(env, seed=seed))
    number, told = 0, None
    while told is None and number < 200:
        for what in (env.render, env.state, lambda: env.step({})):
            with pytest.raises(RuntimeError, match="call reset before"):
                what()
        number, told = number + 1, reset_if_room(env)
    assert "HAV 0 " in env.render()
    info = told[1]["hav_0"]
    assert (info["seed"], info["episode_number"]) == (seed, number)


def reset_if_room(env, **asked):
    try:
        return env.reset(**asked)
    except hav_env.PlacementError:
        return None


@bare
@pytest.mark.parametrize("render_mode", [None, "ansi", "rgb_array"])
def test_before_the_first_reset_there_is_no_episode(face, render_mode):
    env = face(render_mode=render_mode)
    asked = [env.render, *([env.state] if hasattr(env, "state") else [])]
    for what in asked:
        with pytest.raises(RuntimeError, match=r"call reset before .*: there is no episode yet"):
            what()
    env.reset(seed=0)
    for what in asked:
        what()


@pytest.mark.parametrize("name", ["bare", "single"])
@pytest.mark.parametrize("end", ["truncated", "terminated"])
def test_a_step_after_the_end_is_warned_of_once(name, end):
    rules = {"max_steps": 2}
    if end == "terminated":
        many = 1 if name == "single" else 2
        start = [[0.0, 40.0 * k, 0.0] for k in range(many)]
        goals = [[[0.3, 40.0 * k, 0.0]] for k in range(many)]
        scenario = hav_env.explicit([[3.0, 4.0]] * many, start, goals)
        rules = {"scenario": scenario, "distance_tolerance": 0.25}
    env = FACES[name](**rules)
    drive = np.zeros(env.action_space.shape)
    drive[..., 0] = 1.0
    for _ in range(2):
        env.reset(seed=0)
        for _ in range(10):
            _, _, *ends, _ = env.step(drive)
            if any(ends):
                break
        assert ends == [end == "terminated", end == "truncated"]
        with pytest.warns(UserWarning, match="the episode has ended: call reset") as told:
            env.step(drive)
        assert told[0].filename == __file__
        for _ in range(4):
            env.step(drive)  # a second warning would be an error


@pytest.mark.parametrize("make", [parallel_env, one_by_one])
def test_the_generator_of_pettingzoo_is_seeded(make):
    env, twin = make(), make()
    assert isinstance(env.np_random, np.random.Generator)
    for one in (env, twin):
        one.reset(seed=3)
    assert env.np_random.random() == twin.np_random.random()
    twin.reset(seed=4)
    assert env.np_random.random() != twin.np_random.random()


@pytest.mark.parametrize("make", [parallel_env, one_by_one])
@pytest.mark.parametrize("cycles", [0, -3, True, 1.5, 2.0, "5", None, [3]])
def test_cycles_are_a_whole_number_and_not_beside_steps(make, cycles):
    if cycles is not None:
        with pytest.raises((TypeError, ValueError), match="max_cycles is"):
            make(max_cycles=cycles)
    with pytest.raises(TypeError, match="max_cycles and max_steps"):
        make(max_cycles=5, max_steps=5)


@pytest.mark.parametrize("skip", ["2", None, 1.5, 0])
def test_the_argument_that_is_wrong_is_the_one_that_is_named(skip):
    with pytest.raises((TypeError, ValueError), match="frame_skip is"):
        parallel_env(max_cycles=5, frame_skip=skip)


@bare
def test_the_last_episode_of_a_seed_needs_a_new_seed(face):
    env = face()
    seen(env, seed=2, options={"episode": 2**32 - 1})
    with pytest.raises(ValueError, match="reset needs a seed: the last episode of seed 2 was"):
        env.reset()
    assert seen(env, seed=3) == seen(face(), seed=3)
