"""This module has the arguments of the own loops, and their presets."""

import dataclasses
import pathlib
from typing import Any, Literal

from baselines.cli.run_options import Backup, Safety
from hav_env import Observation
from hav_env.cli.options import parse_options
from hav_env.models.quantities import Precision
from train import checks
from train.curriculum import Curriculum
from train.loops.networks import Kind
from train.loops.starts import ALONG_ROUTE
from train.training_task import CURRICULUM, OBSERVATION, REWARD, VEHICLE


@dataclasses.dataclass(frozen=True)
class LoopArguments:
    """The arguments of a training by ``train.ippo`` or ``train.mappo``."""

    scenario: str = "paper-single"
    """Scenario: its name, a JSON file or module:Class."""
    output: pathlib.Path = pathlib.Path("runs/loop")
    """Folder of the run."""
    seed: checks.Seed = 0
    """Seed; see also ``--seeds``."""
    begin_with: str = ""
    """Trained policy to begin with, by name or file; columns that it does not observe have no
    effect at first. ``route`` begins with full speed along the route."""
    network: Kind = "plain"
    """``plain`` reads the columns of K neighbours; ``pooled`` drives among any number of them."""
    encoder: checks.Layers = (32,)
    """Units of each layer that encodes a neighbour; a plain network has none."""
    layers: checks.Layers = (64, 64)
    """Units of the hidden layers, of the actor and of the critic."""
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
    """Mean KL divergence from the policy of the rollout; an update ends early at 1.5 times it."""
    entropy: checks.Factor = 0.0
    """Weight of the entropy bonus."""
    deviation: checks.AboveZero = 0.4
    """Initial standard deviation of actions; with ``hold_noise``, that of weights from the last
    hidden layer to the noise."""
    least_deviation: checks.AboveZero = 0.08
    """Lower bound of the standard deviation."""
    hold_noise: checks.Held = 0
    """Number of actions with one noise function of the state (gSDE, Raffin et al. 2021); 0 for
    independent noise."""
    reward_limit: checks.AboveZero = 100.0
    """Clip limit of normalized rewards."""
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
    threads: checks.Threads = 1
    """Number of threads of simulator and PyTorch."""


LOOP_PRESETS = {
    "single": LoopArguments(),
    "swarm": LoopArguments(
        scenario="swarm-5",
        begin_with=ALONG_ROUTE,
        network="pooled",
        decisions=3_000_000,
        worlds=128,
        learning_rate=3e-4,
        gae_lambda=0.97,
        deviation=0.1,
        least_deviation=0.03,
        hold_noise=4,
        max_steps=3_000,
        observation=OBSERVATION._replace(neighbors=4),
        safety="jackknife",
        backup="reserve",
        guidance="feasible",
        reward=REWARD._replace(
            articulation=0.0, time=-0.2, actual_collision=0.0, potential_collision=0.0
        ),
        curriculum=Curriculum(share=1.0),
        evaluate_every=500_000,
        evaluation_episodes=60,
        scored_episodes=60,
    ),
    "smoke": LoopArguments(
        decisions=20_000,
        worlds=32,
        batch_size=512,
        epochs=2,
        max_steps=500,
        evaluate_every=10_000,
        evaluation_episodes=20,
        scored_episodes=20,
    ),
}

LOOP_MEANINGS = {
    "single": "one HAV",
    "swarm": "five HAVs, with Reserve behind their actions, on routes of their own",
    "smoke": "seconds, to try the commands; it learns almost nothing",
}


def read_loop_arguments(program: str, about: str, words: list[str]) -> LoopArguments:
    """Return the checked arguments of a command line.

    Args:
        program: Name of the module, such as ``ippo``; part of the folder of the run.
        about: Purpose of the program, for the help.
        words: Words of the command line.

    Raises:
        ValueError: If there is no such preset or option, or a value is out of range.
    """
    preset, words = checks.take_preset(words, LOOP_PRESETS)
    folder = pathlib.Path("runs") / f"{program}-{preset}"
    usual = dataclasses.replace(LOOP_PRESETS[preset], output=folder)
    usual, words = checks.take_models(words, usual)
    options = f"[--preset NAME] {checks.OPTIONS} [--seeds A B ...]"
    usage = f"python -m train.{program} {options}"
    names = checks.names_for_help(LOOP_MEANINGS)
    arguments = parse_options(LoopArguments, usage, about, words, usual, names)
    checks.check_arguments(arguments)
    checks.check_layers("encoder", arguments.encoder)
    return arguments
