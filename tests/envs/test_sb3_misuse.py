"""Wrong use of the environment for Stable-Baselines3 is an error that changes nothing."""

import numpy as np
import pytest

from hav_env import PlacementError, RandomPoses
from hav_env.envs.stable_baselines3 import HAVVecEnv


def test_options_of_a_reset_are_refused():
    env = HAVVecEnv(2)
    for none in (None, {}, [{}] * 4):
        env.set_options(none)
    for some in ({"episode": 3}, [{}, {}, {}, {"episode": 3}]):
        with pytest.raises(ValueError, match=r"options is .*, but must be empty"):
            env.set_options(some)


@pytest.mark.parametrize("seed", [-1, 2**32, 2**32 - 3, 0.5, "1", {1}])
def test_what_is_no_seed_is_refused_and_changes_nothing(seed):
    env, twin = HAVVecEnv(2), HAVVecEnv(2)
    for one in (env, twin):
        one.seed(3)
    with pytest.raises((ValueError, TypeError), match="seed is"):
        env.seed(seed)
    assert np.array_equal(env.reset(), twin.reset())


def test_worlds_without_room_are_not_stepped():
    tight = RandomPoses(num_havs=4, area_factor=2.5, pose_attempts=4, world_attempts=1)
    env = HAVVecEnv(4, scenario=tight)
    env.seed(0)

    def reset_until_there_is_no_room():
        for _ in range(200):
            env.reset()

    with pytest.raises(PlacementError):
        reset_until_there_is_no_room()
    with pytest.raises(RuntimeError, match="call reset before step"):
        env.step(np.zeros((16, 2)))


def test_worlds_are_drawn():
    env = HAVVecEnv(2, render_mode="rgb_array")
    env.reset()
    frames = env.get_images()
    assert len(frames) == 2
    assert all(frame.dtype == np.uint8 and frame.ndim == 3 for frame in frames)
    assert env.render().ndim == 3  # tiled
    env.close()


@pytest.mark.parametrize(
    ("actions", "message"),
    [
        (np.zeros((3, 2)), r"shape \(3, 2\), but must have \(4, 2\)"),
        (np.full((4, 2), np.nan), "must be finite"),
    ],
)
def test_actions_that_make_no_sense_are_an_error(actions, message):
    env = HAVVecEnv(2)
    env.reset()
    with pytest.raises(ValueError, match=message):
        env.step(actions)


def test_a_step_before_the_first_reset_is_an_error():
    with pytest.raises(RuntimeError, match="call reset before step"):
        HAVVecEnv(1).step(np.zeros((2, 2)))
