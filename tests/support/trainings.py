"""Trainings small enough for a test."""

import numpy as np

from hav_env import Task
from tests.support.budgets import budget
from train import ppo

EVALUATED = Task(max_steps=budget(400, 10))
SIZES = {
    "decisions": 768,
    "worlds": 8,
    "rollout-decisions": 16,
    "batch-size": 64,
    "frame-skip": budget(5, 1),
    "max-steps": budget(40, 8),  # episodes of eight decisions
    "evaluate-every": 256,
    "checkpoint-every": 256,
    "evaluation-episodes": budget(10, 2),
    "scored-episodes": budget(10, 2),
    "layers": (8, 6),
}


def words(folder, **changes):
    """Return the arguments of a training into a folder."""
    sizes = SIZES | {name.replace("_", "-"): value for name, value in changes.items()}
    told = ["--preset", "smoke", "--output", str(folder)]
    for name, value in sizes.items():
        told += [f"--{name}", *map(str, np.atleast_1d(value))]
    return told


def train(folder, **changes):
    """Train into a folder and return it."""
    assert ppo.main(words(folder, **changes)) == 0
    return folder
