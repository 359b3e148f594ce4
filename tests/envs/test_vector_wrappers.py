"""Gymnasium's wrappers take the vector environments; senseless combinations are an error."""

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers import vector as wrappers

SWARM, SINGLE = "hav_env:HAVSwarm-v0", "hav_env:HAVSingle-v0"


def made(name=SWARM, mode="NextStep", **settings):
    return gym.make_vec(name, num_envs=4, autoreset_mode=mode, max_steps=6, **settings)


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
@pytest.mark.parametrize("name", [SWARM, SINGLE])
def test_episodes_are_counted_with_their_returns_and_lengths(name, mode):
    env = wrappers.RecordEpisodeStatistics(made(name, mode))
    env.reset(seed=0)
    total = np.zeros(4)
    for _ in range(6):
        _, reward, _, truncated, info = env.step(np.full(env.action_space.shape, 0.5, np.float32))
        total += reward
    assert truncated.all()
    assert info["episode"]["l"].tolist() == [6] * 4
    assert info["episode"]["r"] == pytest.approx(total)


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_rewards_are_normalised(mode):
    env = wrappers.NormalizeReward(made(mode=mode))
    env.reset(seed=0)
    for _ in range(20):
        _, reward, *_ = env.step(env.action_space.sample())
        assert np.isfinite(reward).all()
    assert env.return_rms.var > 0.0


def test_observations_are_flattened_and_normalised():
    env = wrappers.NormalizeObservation(wrappers.FlattenObservation(made()))
    plain = made(flatten=True)
    assert env.single_observation_space.shape == plain.single_observation_space.shape
    flat, _ = wrappers.FlattenObservation(made()).reset(seed=1)
    assert np.array_equal(flat, plain.reset(seed=1)[0])
    env.reset(seed=1)
    for _ in range(20):
        observation, *_ = env.step(np.ones(env.action_space.shape, np.float32))
        assert np.isfinite(observation).all()
    assert env.obs_rms.var.max() > 0.0


def test_numbers_become_one_dictionary_for_each_world():
    env = wrappers.DictInfoToList(made(SINGLE))
    _, infos = env.reset(seed=3)
    assert [info["seed"] for info in infos] == [3, 4, 5, 6]


@pytest.mark.parametrize("mode", AutoresetMode)
def test_the_mode_of_going_on_is_told(mode):
    assert made(mode=mode).metadata["autoreset_mode"] is mode
    assert made(mode=mode.value).metadata["autoreset_mode"] is mode
    assert "autoreset_mode" not in type(made().unwrapped).metadata


MASK = "reset_mask"


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (
            {"options": {MASK: [True] * 4}},
            TypeError,
            "reset_mask is .* array of bool",
        ),
        (
            {"options": {MASK: np.ones(4)}},
            TypeError,
            "reset_mask is .* array of bool",
        ),
        ({"options": {MASK: np.ones(3, bool)}}, ValueError, r"\(3,\), but must have \(4,\)"),
        ({"options": {MASK: np.zeros(4, bool)}}, ValueError, "true for at least one world"),
        ({"seed": [1, 2]}, ValueError, "2 seeds were given for 4 worlds"),
        ({"seed": [1, 2, 3, -4]}, ValueError, "seed is -4"),
        ({"seed": -1}, ValueError, "seed is -1, but must be from 0"),
        ({"seed": 2**32 - 2}, ValueError, f"seed is {2**32 - 2}, but must be at most"),
        ({"seed": [1, 2, 3, "four"]}, TypeError, "seed is four"),
    ],
)
def test_a_reset_that_makes_no_sense_is_an_error_and_changes_nothing(arguments, error, message):
    env, other = made(), made()
    for fresh in (env, other):
        fresh.reset(seed=2)
    with pytest.raises(error, match=message):
        env.reset(**arguments)
    actions = np.ones(env.action_space.shape)
    assert np.array_equal(env.step(actions)[0], other.step(actions)[0])


@pytest.mark.parametrize(
    ("actions", "message"),
    [
        (np.zeros((4, 2)), r"shape \(4, 2\), but must have \(4, 2, 2\)"),
        (np.zeros((3, 2, 2)), r"shape \(3, 2, 2\)"),
        (np.full((4, 2, 2), np.nan), "must be finite"),
        (np.full((4, 2, 2), np.inf), "must be finite"),
    ],
)
def test_actions_that_make_no_sense_are_an_error(actions, message):
    env = made()
    env.reset(seed=0)
    with pytest.raises(ValueError, match=message):
        env.step(actions)


def test_a_step_is_an_error_before_the_first_reset_and_after_an_end_that_nobody_reset():
    env = made(mode="Disabled")
    with pytest.raises(RuntimeError, match="call reset before step"):
        env.step(np.zeros(env.action_space.shape))
    env.reset(seed=0)
    for _ in range(6):
        env.step(np.zeros(env.action_space.shape))
    with pytest.raises(RuntimeError, match=r"reset the worlds \[0, 1, 2, 3\] first"):
        env.step(np.zeros(env.action_space.shape))


@pytest.mark.parametrize("mode", ["human", "video"])
def test_a_mode_that_a_vector_cannot_show_is_an_error(mode):
    with pytest.raises(ValueError, match=f"render_mode is '{mode}', but must be None or one of"):
        made(render_mode=mode)


def test_worlds_are_drawn_side_by_side():
    env = made(render_mode="rgb_array")
    with pytest.raises(RuntimeError, match="call reset before render"):
        env.render()
    env.reset(seed=0)
    frames = env.render()
    assert len(frames) == 4
    for frame in frames:
        assert (frame.dtype, frame.ndim, frame.shape[2]) == (np.uint8, 3, 3)
    text = made(render_mode="ansi")
    text.reset(seed=0)
    assert len(set(text.render())) == 4
    env.close()
