"""What a training's arguments must be, beside what environments and learners check."""

from typing import Any

import numpy as np

from hav_env.batch import check_seed
from train.curriculum import check_curriculum


def check_arguments(arguments: Any) -> None:
    """Check what neither the environment nor the learner would name.

    Raises:
        ValueError: naming the argument, its value and what is allowed.
    """
    check_curriculum(arguments.curriculum)
    check_seed(arguments.seed)
    # of a single number there is no deviation, by which advantages are divided
    least = {"rollout_decisions": 2, "batch_size": 2, "hold_noise": 0}
    for name, kind in type(arguments).__annotations__.items():
        if kind is int and name != "seed" and getattr(arguments, name) < least.get(name, 1):
            value = getattr(arguments, name)
            raise ValueError(f"{name} is {value}, but must be at least {least.get(name, 1)}")
    if not arguments.layers or min(arguments.layers) < 1:
        raise ValueError(f"layers is {arguments.layers}, but must name at least one unit each")
    for name in ("learning_rate", "deviation", "clip_range", "reward_limit"):
        if not 0 < getattr(arguments, name) < np.inf:
            raise ValueError(f"{name} is {getattr(arguments, name)}, but must be above 0")
    if not 0 <= arguments.entropy < np.inf:
        raise ValueError(f"entropy is {arguments.entropy}, but must be at least 0")
    for name in ("discount", "gae_lambda"):
        if not 0 < getattr(arguments, name) <= 1:
            raise ValueError(f"{name} is {getattr(arguments, name)}, but must be in (0, 1]")
