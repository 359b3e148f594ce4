"""What a training's arguments must be, beside what environments and learners check."""

from typing import Any

import numpy as np

from hav_env.batch import check_seed
from train.curriculum import check_curriculum

# of a single number there is no deviation, by which advantages are divided
_LEAST = {"rollout_decisions": 2, "batch_size": 2, "hold_noise": 0, "runners": 0}
_POSITIVE = (
    *("learning_rate", "deviation", "least_deviation", "clip_range", "target_divergence"),
    *("reward_limit", "reward_scale"),
)
_SHARES = ("discount", "gae_lambda")


def check_arguments(arguments: Any) -> None:
    """Check what neither an environment nor a learner would name.

    Args:
        arguments: a dataclass of some of the arguments of ``train.ppo`` and ``train.rllib``.

    Raises:
        ValueError: naming the argument, its value and what is allowed.
    """
    check_curriculum(arguments.curriculum)
    check_seed(arguments.seed)
    for name, kind in type(arguments).__annotations__.items():
        value = getattr(arguments, name)
        if kind is int and name != "seed" and value < _LEAST.get(name, 1):
            raise ValueError(f"{name} is {value}, but must be at least {_LEAST.get(name, 1)}")
        if name in _POSITIVE and not 0 < value < np.inf:
            raise ValueError(f"{name} is {value}, but must be above 0")
        if name in _SHARES and not 0 < value <= 1:
            raise ValueError(f"{name} is {value}, but must be in (0, 1]")
    if not arguments.layers or min(arguments.layers) < 1:
        raise ValueError(f"layers is {arguments.layers}, but must name at least one unit each")
    if not 0 <= arguments.entropy < np.inf:
        raise ValueError(f"entropy is {arguments.entropy}, but must be at least 0")
