"""Arguments of trainings are checked by their annotations, as all models are."""

import dataclasses
import math

import pytest

from hav_env import Observation, Reward
from train import ppo
from train.checks import check_arguments
from train.curriculum import Curriculum
from train.rllib import arguments as rllib_arguments

BOTH = (ppo, rllib_arguments)
ALL_PRESETS = (ppo.PPO_PRESETS, rllib_arguments.RLLIB_PRESETS)
HUGE = 10**30
BAD = [
    *(("decisions", value) for value in (0, HUGE, 1.5, "1", True, None)),
    *(("worlds", value) for value in (0, 10**9, 2.0, "512")),
    *(("rollout_decisions", value) for value in (1, HUGE, 1.5)),
    *(("batch_size", value) for value in (1, HUGE, None)),
    *(("epochs", value) for value in (0, 10**9, True)),
    *(("seed", value) for value in (-1, 2**32, 1.5, True, {1}, "0")),
    *(("learning_rate", value) for value in (0.0, -1.0, math.nan, math.inf, 1e300, "fast")),
    *(("discount", value) for value in (0.0, 1.1, math.nan, None)),
    *(("entropy", value) for value in (-1.0, math.nan, 1j)),
    *(("layers", value) for value in ((), (0,), (64, 1_000_000_000), (8,) * 17, (1.5,), 64, "64")),
    *(("frame_skip", value) for value in (0, HUGE, 1.5)),
    *(("max_steps", value) for value in (0, HUGE, "long")),
    *(("trailer_sigma", value) for value in (0.0, 1e300, math.nan)),
    *(("evaluate_every", value) for value in (0, HUGE)),
    *(("evaluation_episodes", value) for value in (-1, HUGE, 0.5)),
    ("observation", 3),
    ("observation", Observation(-1)),
    ("reward", None),
    ("reward", Reward(goal="10")),
    ("curriculum", None),
    ("curriculum", Curriculum(share=2.0)),
    ("curriculum", Curriculum(begin=0.6)),
]


@pytest.mark.parametrize("stack", BOTH)
@pytest.mark.parametrize(("field", "value"), BAD)
def test_an_argument_of_a_training_is_refused_by_name(stack, field, value):
    arguments = dataclasses.replace(stack.Arguments(), **{field: value})
    with pytest.raises((TypeError, ValueError), match=field) as told:
        check_arguments(arguments)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("presets", ALL_PRESETS)
def test_all_presets_pass(presets):
    for arguments in presets.values():
        check_arguments(arguments)
