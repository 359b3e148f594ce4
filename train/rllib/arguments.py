"""This module declares the arguments of ``train.rllib`` and their presets."""

import dataclasses
import pathlib
from typing import Any, Literal

from baselines.cli.run_options import Backup, Safety
from hav_env import Observation
from hav_env.models.quantities import Precision
from train import checks
from train.curriculum import Curriculum
from train.training_task import CURRICULUM, OBSERVATION, REWARD, VEHICLE


@dataclasses.dataclass(frozen=True)
class Arguments:
    """The arguments of a training, named as in train.ppo."""

    scenario: str = "paper-single"
    """Scenario: its name, a JSON file or module:Class."""
    output: pathlib.Path = pathlib.Path("runs/rllib-single")
    """Folder of the run."""
    address: str | None = None
    """Address of a Ray cluster, HOST:PORT or auto; by default Ray starts on this machine."""
    seed: checks.Seed = 0
    """Seed of the episodes and the weights."""
    decisions: checks.Decisions = 5_000_000
    """Length of the training: number of actions of all HAVs together."""
    runners: checks.Runners = 0
    """Number of processes for rollouts, one core each; with 0 the learner's process does them."""
    worlds: checks.Worlds = 32
    """Number of parallel worlds in each process."""
    rollout_decisions: checks.Several = 128
    """Number of actions of each HAV between updates."""
    batch_size: checks.Several = 1_024
    """Number of actions in a minibatch."""
    epochs: checks.Epochs = 8
    """Number of times that PPO learns from each action."""
    learning_rate: checks.AboveZero = 5e-4
    """Initial learning rate; it falls linearly to 0."""
    discount: checks.Discount = 0.995
    """Discount factor for each action."""
    gae_lambda: checks.Discount = 0.95
    """Lambda of generalized advantage estimation."""
    clip_range: checks.AboveZero = 0.2
    """Clip range of the probability ratio of PPO."""
    entropy: checks.Factor = 0.0
    """Weight of the entropy bonus."""
    deviation: checks.AboveZero = 0.4
    """Initial standard deviation of actions."""
    layers: checks.Layers = (64, 64)
    """Units of the hidden layers, of the policy and of the value network."""
    frame_skip: checks.Skipped = 5
    """Number of simulator steps that an action is held."""
    max_steps: checks.Steps = 4_000
    """Step limit of a training episode, in simulator steps; evaluations have the task's limit."""
    observation: Observation = OBSERVATION
    """Observation of the HAVs."""
    trailer_sigma: checks.Spread = 4.5
    """Sigma of trailer counts in training (``RandomFleet``); evaluations use the scenario's."""
    vehicle: Any = VEHICLE
    """Kinematics of the HAVs."""
    safety: Safety = None
    """Events that the safety filter prevents, in training and in evaluations."""
    backup: Backup = None
    """Policy that drives where an action would leave it no safe way on: reserve."""
    guidance: str = "dubins"
    """Guidance to the goals: dubins, witness, lattice, roads or feasible."""
    precision: Precision = "double"
    """Precision of the worlds in training: single is faster. Evaluations are in double."""
    on_collision: Literal["record", "end"] = "end"
    """Rule of training episodes for a collision of HAVs: whether the episode ends."""
    reward: Any = REWARD
    """Reward with the weights of its terms."""
    reward_scale: checks.AboveZero = 0.1
    """Scale factor of rewards, because RLlib does not normalize them."""
    curriculum: Curriculum = CURRICULUM
    """Growth of the penalty weights."""
    evaluate_every: checks.Decisions = 200_000
    """Number of actions of all HAVs between evaluations."""
    evaluation_episodes: checks.Episodes = 500
    """Number of held-out episodes of an evaluation."""


RLLIB_PRESETS = {
    "single": Arguments(),
    "pair": Arguments(scenario="paper-pair", worlds=16, max_steps=6_000),
    # ends within seconds, and learns almost nothing
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
    """Check that a minibatch has at most the actions between updates; else raise ValueError."""
    least = max(arguments.runners, 1) * arguments.worlds * arguments.rollout_decisions
    if arguments.batch_size > least:
        told = f"at most runners x worlds x rollout_decisions, {least}"
        raise ValueError(f"batch_size is {arguments.batch_size}, but must be {told}")
