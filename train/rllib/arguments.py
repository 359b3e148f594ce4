"""This module declares the arguments of ``train.rllib`` and their presets."""

import dataclasses
import pathlib
from typing import Any

from hav_env import Observation
from train import checks
from train.curriculum import Curriculum
from train.training_task import CURRICULUM, OBSERVATION, REWARD, VEHICLE


@dataclasses.dataclass(frozen=True)
class Arguments:
    """The arguments of a training; words as in train.ppo."""

    scenario: str = "paper-single"
    """Scenario: its name, a JSON file or module:Class."""
    output: pathlib.Path = pathlib.Path("runs/rllib-single")
    """Folder of the run."""
    address: str | None = None
    """Address of a Ray cluster, HOST:PORT or auto; by default one is started on this machine."""
    seed: checks.Seed = 0
    """Seed of the episodes and the weights."""
    decisions: checks.Decisions = 5_000_000
    """For how long to learn: actions of all HAVs together."""
    runners: checks.Runners = 0
    """Processes that drive, on a core each; with 0 the one that learns drives too."""
    worlds: checks.Worlds = 32
    """Number of worlds that each process has side by side."""
    rollout_decisions: checks.Several = 128
    """Actions of each HAV between updates."""
    batch_size: checks.Several = 1_024
    epochs: checks.Epochs = 8
    """Number of times that PPO learns from each action."""
    learning_rate: checks.AboveZero = 5e-4
    """At the beginning; it falls to nothing along a straight line."""
    discount: checks.Discount = 0.995
    """For each action."""
    gae_lambda: checks.Discount = 0.95
    clip_range: checks.AboveZero = 0.2
    entropy: checks.Factor = 0.0
    """Weight of the entropy bonus."""
    deviation: checks.AboveZero = 0.4
    """Standard deviation of actions at the beginning."""
    layers: checks.Layers = (64, 64)
    """Units of the hidden layers, of the policy and of the value."""
    frame_skip: checks.Skipped = 5
    """For how many steps of the simulator an action is held."""
    max_steps: checks.Steps = 4_000
    """Most simulator steps of a training episode; those of evaluations are the task's."""
    observation: Observation = OBSERVATION
    """The observation of others; of no more than there are."""
    trailer_sigma: checks.Spread = 4.5
    """Sigma of trailer counts in training (``RandomFleet``); evaluations have the scenario's."""
    vehicle: Any = VEHICLE
    """The kinematics."""
    reward: Any = REWARD
    """Weights of its terms."""
    reward_scale: checks.AboveZero = 0.1
    """Times which the reward is learned from: RLlib does not normalize it."""
    curriculum: Curriculum = CURRICULUM
    """Growth of the weights of harm."""
    evaluate_every: checks.Decisions = 200_000
    """Decisions between evaluations."""
    evaluation_episodes: checks.Episodes = 500
    """Held-out episodes of an evaluation."""


RLLIB_PRESETS = {
    "single": Arguments(),
    "pair": Arguments(scenario="paper-pair", worlds=16, max_steps=6_000),
    # is done in seconds, and learns nothing to speak of
    "smoke": Arguments(
        decisions=2_000,
        worlds=4,
        rollout_decisions=128,
        batch_size=128,
        epochs=2,
        max_steps=500,
        evaluate_every=1_000,
        evaluation_episodes=10,
    ),
}


def check_batch(arguments: Arguments) -> None:
    """Raise ValueError when a batch is larger than what is learned from at a time."""
    least = max(arguments.runners, 1) * arguments.worlds * arguments.rollout_decisions
    if arguments.batch_size > least:
        told = f"at most runners x worlds x rollout_decisions, {least}"
        raise ValueError(f"batch_size is {arguments.batch_size}, but must be {told}")
