"""This module trains one policy for all HAVs by PPO: ``python -m train.ppo --preset pair``.

It learns by Stable-Baselines3; train/sb3/callback.py acts between iterations. A run's folder holds

* ``run.json``: arguments, versions, git revision;
* ``best.policy``: the best policy on the held-out episodes, ``last.policy``: the latest;
* ``curve.json``: every evaluation;
* ``checkpoint.pt``: everything that a resumed run needs to go on bit for bit;
* TensorBoard's files: ``tensorboard --logdir FOLDER``.
"""

import dataclasses
import logging
import pathlib
import sys
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.logger import configure
from stable_baselines3.common.vec_env import VecNormalize

from baselines.cli.options import take_option
from baselines.policies.files import save_policy
from baselines.policies.network import Network
from baselines.policies.shipped import find_trained
from baselines.storage.locks import sole_user
from hav_env import Observation
from hav_env.cli.options import parse_options, report_errors
from hav_env.envs.stable_baselines3 import HAVVecEnv
from hav_env.maths.random_numbers import SEED_LIMIT
from hav_env.models.text import visible
from train import checks
from train.curriculum import Curriculum
from train.export import network_of
from train.runs import about_of, begin_run, plain, read_run, restore, versions
from train.sb3.callback import TrainingCallback
from train.sb3.checkpoints import read_checkpoint, write_checkpoint
from train.sb3.warm_start import start_from
from train.scores import TRAINING, conclude
from train.training_task import CURRICULUM, OBSERVATION, REWARD, VEHICLE, settings_of

CHECKPOINT = "checkpoint.pt"


@dataclasses.dataclass(frozen=True)
class Arguments:
    """The arguments of a training."""

    scenario: str = "paper-single"
    """Scenario: its name, a JSON file or module:Class."""
    output: pathlib.Path = pathlib.Path("runs/ppo")
    """Folder of the run."""
    seed: checks.Seed = 0
    """The same seed gives the same weights, on the same machine with the same versions."""
    begin_with: str = ""
    """A trained policy to begin with, by name or file; what it does not observe is ignored at
    first."""
    decisions: checks.Decisions = 30_000_000
    """For how long to learn: actions of all HAVs together."""
    worlds: checks.Worlds = 512
    """Number of worlds side by side."""
    rollout_decisions: checks.Several = 64
    """Actions of each HAV between updates."""
    batch_size: checks.Several = 4_096
    epochs: checks.Epochs = 4
    """Number of times that PPO learns from each action."""
    learning_rate: checks.AboveZero = 5e-4
    """At the beginning; it falls to nothing along a straight line."""
    discount: checks.Discount = 0.995
    """For each action."""
    gae_lambda: checks.Discount = 0.95
    clip_range: checks.AboveZero = 0.2
    target_divergence: checks.AboveZero = 0.02
    """Mean KL divergence from the policy that drove, from which on an update ends early."""
    entropy: checks.Factor = 0.0
    """Weight of the entropy bonus."""
    deviation: checks.AboveZero = 0.4
    """Standard deviation of actions at the beginning; with ``hold_noise`` of the weights that make
    it of the last hidden layer, so that of actions is several times as large."""
    least_deviation: checks.AboveZero = 0.08
    """Below which it does not fall. A HAV that learns with noise keeps away from its consequences;
    without it, margins shrink to nothing, and so do the steps that are safe to learn with."""
    hold_noise: checks.Held = 0
    """For how many actions the noise that explores is the same function of the state (gSDE, Raffin
    et al. 2021): so HAVs try to wait for a while, not for an instant. 0 for independent noise."""
    reward_limit: checks.AboveZero = 100.0
    """To which rewards are cut once they are normalized; Stable-Baselines3's 10 makes accidents
    cheap."""
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
    reward: Any = REWARD
    """Weights of its terms."""
    curriculum: Curriculum = CURRICULUM
    """Growth of the weights of harm."""
    evaluate_every: checks.Decisions = 2_000_000
    """Decisions between evaluations."""
    evaluation_episodes: checks.Episodes = 500
    """Held-out episodes of an evaluation."""
    scored_episodes: checks.Episodes = 4_500
    """Episodes that the best policy is scored on at the end: others, used for nothing else."""
    checkpoint_every: checks.Decisions = 2_000_000
    """Decisions between checkpoints."""
    threads: checks.Threads = 1
    """Of the simulator and of PyTorch. The weights depend on it, for PyTorch sums differently."""


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
    # is done in seconds, and learns nothing to speak of
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


def make_worlds(arguments: Arguments) -> HAVVecEnv:
    """Return the worlds to train on."""
    return HAVVecEnv(arguments.worlds, **settings_of(arguments, arguments.threads))


def make_learner(arguments: Arguments, env: VecNormalize) -> PPO:
    """Return a learner that has learned nothing yet."""
    return PPO(
        "MlpPolicy",
        env,
        learning_rate=lambda remaining: arguments.learning_rate * remaining,
        n_steps=arguments.rollout_decisions,
        batch_size=arguments.batch_size,
        n_epochs=arguments.epochs,
        gamma=arguments.discount,
        gae_lambda=arguments.gae_lambda,
        clip_range=arguments.clip_range,
        target_kl=arguments.target_divergence,
        ent_coef=arguments.entropy,
        policy_kwargs={
            "net_arch": list(arguments.layers),
            "log_std_init": float(np.log(arguments.deviation)),
        },
        use_sde=arguments.hold_noise > 0,
        sde_sample_freq=max(arguments.hold_noise, 1),
        seed=arguments.seed,
        device="cpu",
    )


class Run:
    """One training: the learner, and all that changes while it learns."""

    def __init__(self, arguments: Arguments) -> None:
        """Set up the worlds and the learner; nothing is written."""
        torch.set_num_threads(arguments.threads)
        self.arguments = arguments
        worlds = make_worlds(arguments)
        self.process = worlds.process
        self.env = VecNormalize(
            worlds, gamma=arguments.discount, clip_reward=arguments.reward_limit
        )
        self.learner = make_learner(arguments, self.env)
        rows = self.env.num_envs  # trainings of other seeds share no episodes
        first = (TRAINING + arguments.seed * rows) % (SEED_LIMIT - rows)
        self.env.seed(first)
        if arguments.begin_with:
            begun = find_trained(arguments.begin_with)
            start_from(begun, self.learner, self.env, self.process)
            self.env.seed(first)  # once more: the beginning of episodes was looked at
        self.curve: list[dict[str, float]] = []
        self.seconds = 0.0  # of learning, over all sittings
        self.restore_random_numbers: Any = lambda: None  # when the next rollout begins

    def policy(self) -> Network:
        """Return what has been learned so far, as it would act: without noise."""
        network = self.learner.policy
        modules = [*network.mlp_extractor.policy_net, network.action_net]
        layers = [module for module in modules if isinstance(module, torch.nn.Linear)]
        seen: Any = self.env.obs_rms
        variance = seen.var + self.env.epsilon
        return network_of(layers, self.process, seen.mean, variance, self.env.clip_obs)

    def save(self, name: str) -> None:
        """Write the policy to the run's folder."""
        about = {
            "algorithm": "PPO (stable-baselines3)",
            "arguments": plain(self.arguments),
            "decisions": self.learner.num_timesteps,
            "began_with": about_of(self.arguments.begin_with),
            "hours": self.seconds / 3_600,
            "curve": self.curve,
            **versions(),
        }
        save_policy(self.policy(), self.arguments.output / name, about)

    def write_checkpoint(self) -> None:
        """Write down where it is."""
        path = self.arguments.output / CHECKPOINT
        write_checkpoint(path, self.learner, self.env, self.curve, self.seconds)

    def go_on(self) -> None:
        """Go back to where the checkpoint was written.

        Raises:
            ValueError: when it is broken, or was written by another version.
        """
        told = read_checkpoint(self.arguments.output / CHECKPOINT, self.learner, self.env)
        self.curve, self.seconds, self.restore_random_numbers = told

    def learn(self) -> None:
        """Learn until the end, from wherever it is."""
        arguments, learner = self.arguments, self.learner
        left = arguments.decisions - learner.num_timesteps
        if left <= 0:
            return
        learner.set_logger(configure(str(arguments.output), ["tensorboard"]))
        with TrainingCallback(self) as callback:
            learner.learn(left, callback=callback, reset_num_timesteps=False)


def read_arguments(words: list[str]) -> tuple[Arguments, bool]:
    """Return the arguments of a command line, and whether they are those of a run to resume.

    Raises:
        ValueError: when there is no such preset, option or run.
    """
    resumed, others = take_option(words, "--resume", "")
    if len(others) < len(words):
        if not resumed:
            raise ValueError("--resume needs the folder of a run")
        if others:
            raise ValueError(f"--resume goes on as the run began, and knows no {others[0]}")
        folder = pathlib.Path(resumed)
        told = restore(Arguments, read_run(folder, CHECKPOINT))
        return dataclasses.replace(told, output=folder), True
    preset, words = take_option(words, "--preset", "single")
    if preset not in PPO_PRESETS:
        raise ValueError(f"unknown preset {preset!r}; known: {', '.join(PPO_PRESETS)}")
    usual = dataclasses.replace(PPO_PRESETS[preset], output=pathlib.Path("runs") / preset)
    usual, words = checks.take_models(words, usual)
    presets = "|".join(PPO_PRESETS)
    usage = f"python -m train.ppo [--preset {presets}] {checks.OPTIONS} | --resume FOLDER"
    return parse_options(Arguments, usage, "Train HAVs with PPO.", words, usual), False


def main(words: list[str] | None = None) -> int:
    """Train, report an error in one line, and return the exit code."""
    logging.basicConfig(format="%(message)s")
    return report_errors(train, words, "--resume FOLDER goes on from the last checkpoint")


def train(words: list[str]) -> None:
    """Train as a command line says; print what came of it."""
    arguments, resumed = read_arguments(words)
    checks.check_arguments(arguments)
    run = Run(arguments)
    with sole_user(arguments.output):
        if resumed:
            run.go_on()
        else:
            begin_run(arguments.output, plain(arguments))
        run.learn()
        best = arguments.output / "best.policy"
        found = conclude(best, arguments.scenario, arguments.scored_episodes, arguments.vehicle)
    told = ", ".join(f"{name} {value:.4g}" for name, value in found.items())
    print(f"{told}\npolicy: {visible(str(best))}")


if __name__ == "__main__":
    sys.exit(main())
