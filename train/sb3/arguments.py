"""This module declares the arguments of ``train.ppo``, and their presets."""

import dataclasses
import pathlib
from typing import Any, Literal

from baselines.cli.run_options import Backup, Safety
from hav_env import Observation, SiteReward
from hav_env.models.quantities import Precision
from hav_env.vehicles import VEHICLES
from train import checks
from train.curriculum import Curriculum
from train.sb3.warm_start import ALONG_ROUTE
from train.training_task import CURRICULUM, OBSERVATION, REWARD, VEHICLE


@dataclasses.dataclass(frozen=True)
class Arguments:
    """The arguments of a training."""

    scenario: str = "paper-single"
    """Scenario: its name, a JSON file or module:Class."""
    output: pathlib.Path = pathlib.Path("runs/ppo")
    """Folder of the run."""
    seed: checks.Seed = 0
    """Seed; the same seed, machine and versions give the same weights. See also ``--seeds``."""
    begin_with: str = ""
    """Trained policy to begin with, by name or file; columns that it does not observe have no
    effect at first. ``route`` begins with a constant speed along the route."""
    begin_speed: checks.BeginSpeed = 1.0
    """Speed of the start ``route``, as a share of the full speed."""
    value_decisions: checks.ValueDecisions = 0
    """Number of actions of all HAVs at first in which only the value network learns. The first
    gradients of a value network without training would spoil a policy to begin with."""
    decisions: checks.Decisions = 30_000_000
    """Length of the training: number of actions of all HAVs together."""
    worlds: checks.Worlds = 512
    """Number of parallel worlds."""
    rollout_decisions: checks.Several = 64
    """Number of actions of each HAV between updates."""
    batch_size: checks.Several = 4_096
    """Number of actions in a minibatch."""
    epochs: checks.Epochs = 4
    """Number of times that PPO learns from each action."""
    learning_rate: checks.AboveZero = 5e-4
    """Initial learning rate; it falls linearly to 0."""
    discount: checks.Discount = 0.995
    """Discount factor for each action."""
    gae_lambda: checks.Discount = 0.95
    """Lambda of generalized advantage estimation."""
    clip_range: checks.AboveZero = 0.2
    """Clip range of the probability ratio of PPO."""
    target_divergence: checks.AboveZero = 0.02
    """Mean KL divergence from the policy of the rollout at which an update ends early."""
    entropy: checks.Factor = 0.0
    """Weight of the entropy bonus."""
    deviation: checks.AboveZero = 0.4
    """Initial standard deviation of actions. With ``hold_noise``, that of weights from the last
    hidden layer to the noise; that of actions is then several times as large."""
    least_deviation: checks.AboveZero = 0.08
    """Lower bound of the standard deviation. Exploration noise keeps a safety margin; without a
    bound the margin vanishes, and so does the step size of stable learning."""
    hold_noise: checks.Held = 0
    """Number of actions with one noise function of the state (gSDE, Raffin et al. 2021): HAVs then
    explore waiting for a while, not for an instant. 0 for independent noise."""
    reward_limit: checks.AboveZero = 100.0
    """Clip limit of normalized rewards; Stable-Baselines3's default of 10 makes accidents cheap."""
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
    curriculum: Curriculum = CURRICULUM
    """Growth of the penalty weights."""
    evaluate_every: checks.Decisions = 2_000_000
    """Number of actions of all HAVs between evaluations."""
    evaluation_episodes: checks.Episodes = 500
    """Number of held-out episodes of an evaluation."""
    scored_episodes: checks.Episodes = 4_500
    """Number of episodes of the final score of the best policy, used for nothing else."""
    checkpoint_every: checks.Decisions = 2_000_000
    """Number of actions of all HAVs between checkpoints."""
    threads: checks.Threads = 1
    """Number of threads of simulator and PyTorch; the rounding, so the weights, depend on it."""


PPO_PRESETS = {
    "single": Arguments(),
    "pair": Arguments(
        scenario="paper-pair",
        begin_with="ppo_beginner",
        decisions=25_000_000,
        worlds=256,
        gae_lambda=0.97,
        deviation=0.08,
        least_deviation=0.05,
        hold_noise=12,
        max_steps=6_000,
        reward=REWARD._replace(articulation=-1.0, actual_collision=-100.0, proximity=-1.0),
        curriculum=Curriculum(share=1.0),
        evaluate_every=1_000_000,
    ),
    "guided": Arguments(
        begin_with=ALONG_ROUTE,
        decisions=2_000_000,
        learning_rate=3e-4,
        deviation=0.2,
        safety="jackknife",
        guidance="feasible",
        reward=REWARD._replace(articulation=0.0, time=-0.2),
        curriculum=Curriculum(share=1.0),
        evaluate_every=500_000,
    ),
    "field": Arguments(
        scenario="field-1",
        begin_with=ALONG_ROUTE,
        begin_speed=0.3,
        value_decisions=200_000,
        decisions=1_000_000,
        rollout_decisions=128,
        batch_size=8_192,
        learning_rate=3e-4,
        target_divergence=0.01,
        deviation=0.05,
        least_deviation=0.02,
        hold_noise=6,
        frame_skip=2,
        max_steps=1_500,
        observation=OBSERVATION._replace(obstacles=4, motion=True),
        vehicle=VEHICLES.make("realistic"),
        guidance="witness",
        reward=SiteReward(jackknife=-30.0, articulation=0.0, time=-0.05, obstacle_collision=-30.0),
        curriculum=Curriculum(share=1.0),
        evaluate_every=200_000,
        evaluation_episodes=300,
        scored_episodes=1_000,
    ),
    "smoke": Arguments(
        decisions=20_000,
        worlds=32,
        batch_size=512,
        epochs=2,
        max_steps=500,
        evaluate_every=10_000,
        evaluation_episodes=20,
        scored_episodes=20,
        checkpoint_every=10_000,
    ),
}


PRESET_MEANINGS = {
    "single": "one HAV, a quarter of an hour on one core",
    "pair": "two HAVs, from ppo_beginner, about as long",
    "guided": "one HAV on routes that its chain can drive, with jackknife filter, about as long",
    "field": "one real vehicle among random walls, from a start along a free way, minutes",
    "smoke": "seconds, to try the commands; it learns almost nothing",
}
