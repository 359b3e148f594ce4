"""This module trains one policy for all HAVs by PPO: ``hav-env train --preset pair``.

Stable-Baselines3 learns; train/sb3/callback.py acts between iterations. A run's folder holds

* ``run.json``: arguments, versions, git revision; ``curve.json``: all evaluations;
* ``best.policy``: the best policy on the held-out episodes, ``last.policy``: the latest one;
* ``checkpoint.pt``: the whole state, from which a run resumes bit for bit;
* TensorBoard's files: ``tensorboard --logdir FOLDER``.
"""

import dataclasses
import logging
import pathlib
import sys
from typing import Any

import torch
from stable_baselines3.common.logger import configure
from stable_baselines3.common.vec_env import VecNormalize

from baselines.cli.options import take_option
from baselines.policies.files import save_policy
from baselines.policies.network import Network
from baselines.policies.shipped import find_trained
from baselines.storage.locks import sole_user
from hav_env.cli.options import parse_options, report_errors
from hav_env.maths.random_numbers import SEED_LIMIT
from hav_env.models.text import visible
from train import checks
from train.export import network_of
from train.runs import about_of, begin_run, plain, restore, versions
from train.sb3.arguments import PPO_PRESETS, PRESET_MEANINGS, Arguments
from train.sb3.callback import TrainingCallback
from train.sb3.checkpoints import read_checkpoint, write_checkpoint
from train.sb3.learner import make_learner, make_worlds
from train.sb3.warm_start import ALONG_ROUTE, start_from, start_on_route
from train.scores import TRAINING, conclude, show_figures
from train.seeds import read_begun, seeds_of, take_seeds, train_set

CHECKPOINT = "checkpoint.pt"


class Run:
    """One training: the learner, and its state."""

    def __init__(self, arguments: Arguments) -> None:
        """Set up the worlds and the learner; write no file."""
        torch.set_num_threads(arguments.threads)
        self.arguments = arguments
        worlds, limit = make_worlds(arguments), arguments.reward_limit
        self.process = worlds.process
        self.env = VecNormalize(worlds, gamma=arguments.discount, clip_reward=limit)
        self.learner = make_learner(arguments, self.env)
        rows = self.env.num_envs  # trainings with different seeds share no episodes
        first = (TRAINING + arguments.seed * rows) % (SEED_LIMIT - rows)
        self.env.seed(first)
        if arguments.begin_with:
            if arguments.begin_with == ALONG_ROUTE:
                start_on_route(self.learner, self.env, self.process, arguments.begin_speed)
            else:
                begun = find_trained(arguments.begin_with, "begin_with", (ALONG_ROUTE,))
                start_from(begun, self.learner, self.env, self.process)
            self.env.seed(first)  # again: the warm start reset the worlds
        self.curve: list[dict[str, float]] = []
        self.seconds = 0.0  # of learning, over all resumed parts
        self.restore_random_numbers: Any = lambda: None  # at the start of the next rollout

    def policy(self) -> Network:
        """Return the current policy, without noise."""
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
        behind = self.arguments.safety, self.arguments.backup
        save_policy(self.policy(), self.arguments.output / name, about, *behind)

    def write_checkpoint(self) -> None:
        """Write the checkpoint of the current state."""
        path = self.arguments.output / CHECKPOINT
        write_checkpoint(path, self.learner, self.env, self.curve, self.seconds)

    def go_on(self) -> None:
        """Restore the state of the checkpoint.

        Raises:
            ValueError: If the checkpoint is broken, or from another version.
        """
        told = read_checkpoint(self.arguments.output / CHECKPOINT, self.learner, self.env)
        self.curve, self.seconds, self.restore_random_numbers = told

    def learn(self) -> None:
        """Learn from the current state until the end."""
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
        ValueError: If there is no such preset, option or run.
    """
    resumed, others = take_option(words, "--resume", "")
    if len(others) < len(words):
        if not resumed:
            raise ValueError("--resume needs the folder of a run")
        if others:
            raise ValueError(f"--resume goes on as the run began, and knows no {others[0]}")
        told = restore(Arguments, read_begun(pathlib.Path(resumed), CHECKPOINT))
        return dataclasses.replace(told, output=pathlib.Path(resumed)), True
    preset, words = checks.take_preset(words, PPO_PRESETS)
    usual = dataclasses.replace(PPO_PRESETS[preset], output=pathlib.Path("runs") / preset)
    usual, words = checks.take_models(words, usual)
    options = f"[--preset NAME] {checks.OPTIONS} [--seeds A B ...]"
    usage = f"hav-env train {options} | --resume FOLDER"
    names = checks.names_for_help(PRESET_MEANINGS)
    return parse_options(Arguments, usage, "Train HAVs with PPO.", words, usual, names), False


def main(words: list[str] | None = None) -> int:
    """Train one policy for all HAVs by PPO."""
    logging.basicConfig(format="%(message)s")
    return report_errors(train, words, "--resume FOLDER goes on from the last checkpoint")


def train(words: list[str]) -> None:
    """Train one run, or one for each seed, by a command line; print the final figures."""
    seeds, words = take_seeds(words)
    arguments, resumed = read_arguments(words)
    checks.check_arguments(arguments)
    checks.check_value_decisions(arguments.value_decisions, arguments.decisions)
    seeds = seeds_of(arguments.output) if resumed else seeds
    if seeds:
        train_set(arguments, seeds, resumed, CHECKPOINT, train_run)
    else:
        train_run(arguments, resumed)


def train_run(arguments: Arguments, resumed: bool) -> None:
    """Train one run; print the final figures."""
    run = Run(arguments)
    with sole_user(arguments.output):
        if resumed:
            run.go_on()
        else:
            begin_run(arguments.output, plain(arguments))
        run.learn()
        best = arguments.output / "best.policy"
        found = conclude(best, arguments, arguments.scored_episodes)
    print(f"{show_figures(found)}\npolicy: {visible(str(best))}")


if __name__ == "__main__":
    sys.exit(main())
