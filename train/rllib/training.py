"""This module trains one policy for all HAVs by Ray RLlib, on the task of ``train.ppo``.

    python -m train.rllib --preset pair --runners 2
    python -m train.rllib --preset pair --runners 64 --worlds 16 --address auto
    hav-env evaluate runs/rllib-pair/best.policy --scenario paper-pair

Ray starts on this machine unless ``--address`` names a cluster. ``ray start --head`` starts a
cluster; its machines need the same version of the project and ``pip install 'hav_env[ray]'``. The
reward and the network are those of ``train.ppo``. The module does not normalize observations:
RLlib keeps statistics for each agent, not for a policy. On one machine, ``train.ppo`` is many times
faster.

The folder of a run holds ``run.json`` (arguments, versions), ``curve.json`` (all evaluations),
``best.policy`` (the best on the held-out episodes) and ``last.policy``. A run cannot be resumed.
"""

import dataclasses
import json
import logging
import pathlib
import time
from typing import Any

import numpy as np
import torch

from baselines.cli.progress import new_bar
from baselines.evaluation.ray_cluster import connect
from baselines.policies.files import save_policy
from baselines.policies.network import Network
from baselines.storage.atomic_files import write_text
from baselines.storage.locks import sole_user
from hav_env.cli.options import parse_options, report_errors
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.models.text import visible
from train.checks import OPTIONS, check_arguments, take_models, take_preset
from train.curriculum import reward_at
from train.export import network_of
from train.rllib.arguments import RLLIB_PRESETS, Arguments, check_batch
from train.rllib.setup import SHARED, configure, mean_layers
from train.runs import begin_run, plain, versions
from train.scores import evaluate, score, show_figures
from train.training_task import settings_of


class Run:
    """One training, from start to end, with a connection to Ray."""

    def __init__(self, arguments: Arguments) -> None:
        """Set up the processes, their worlds and the learner; write no file."""
        self.arguments = arguments
        settings = settings_of(arguments, threads=1)
        self.process = DecisionProcess(**settings)
        self.algorithm = configure(arguments, dict(settings), self.process.num_havs).build_algo()
        self.curve: list[dict[str, float]] = []
        self.decisions, self.seconds = 0, 0.0

    def learn(self) -> None:
        """Learn until the end, with evaluations in between."""
        arguments, begun, evaluated = self.arguments, time.monotonic(), 0
        bar = new_bar("decisions")
        with bar:
            task = bar.add_task("", total=arguments.decisions, rate="")
            while self.decisions < arguments.decisions:
                self._weigh_harm(self.decisions / arguments.decisions)
                told = self.algorithm.train()["env_runners"]
                steps = int(told["num_env_steps_sampled_lifetime"])
                self.decisions = steps * self.process.num_havs
                self.seconds = time.monotonic() - begun
                if self.decisions - evaluated >= arguments.evaluate_every:
                    evaluated = self.decisions
                    self._evaluate()
                gained = told.get("episode_return_mean", np.nan) / arguments.reward_scale
                rate = self.decisions / self.seconds
                said = f"{rate:,.0f}/s, return {gained:.1f}"
                bar.update(task, completed=self.decisions, rate=said)
            if self.decisions != evaluated:
                self._evaluate()

    def policy(self) -> Network:
        """Return the current policy, without noise."""
        return network_of(mean_layers(self.algorithm.get_module(SHARED)), self.process)

    def _weigh_harm(self, progress: float) -> None:
        reward = reward_at(self.arguments.curriculum, self.arguments.reward, progress)

        def set_reward(runner: Any) -> None:
            if runner.env is not None:  # the local runner has no worlds if there are others
                runner.env.unwrapped.call("set_reward", reward)

        self.algorithm.env_runner_group.foreach_env_runner(set_reward)

    def _evaluate(self) -> None:
        """Score the policy on the held-out episodes; save it as last, and as best if it is."""
        policy, told = self.policy(), self.arguments
        figures = evaluate(policy, told, told.evaluation_episodes)
        best = max((row["score"] for row in self.curve), default=-np.inf)
        row = {"decisions": self.decisions, "hours": self.seconds / 3_600, **figures}
        self.curve.append(row | {"score": score(figures)})
        write_text(json.dumps(self.curve, indent=1) + "\n", told.output / "curve.json")
        about = {
            "algorithm": "PPO (Ray RLlib)",
            "arguments": plain(told),
            "decisions": self.decisions,
            "hours": self.seconds / 3_600,
            "curve": self.curve,
            **versions(),
        }
        save_policy(policy, told.output / "last.policy", about, told.safety, told.backup)
        if self.curve[-1]["score"] > best:
            save_policy(policy, told.output / "best.policy", about, told.safety, told.backup)


def read_arguments(words: list[str]) -> Arguments:
    """Return the arguments of a command line.

    Raises:
        ValueError: If there is no such preset or option.
    """
    preset, words = take_preset(words, RLLIB_PRESETS)
    usual = dataclasses.replace(
        RLLIB_PRESETS[preset], output=pathlib.Path("runs") / f"rllib-{preset}"
    )
    usual, words = take_models(words, usual)
    usage = f"python -m train.rllib [--preset {'|'.join(RLLIB_PRESETS)}] {OPTIONS}"
    return parse_options(Arguments, usage, "Train HAVs with PPO on Ray RLlib.", words, usual)


def main(words: list[str] | None = None) -> int:
    """Train, report an error in one line, and return the exit code."""
    logging.basicConfig(format="%(message)s")
    torch.set_num_threads(1)
    hint = "the folder of the run keeps the policies so far"
    return report_errors(train, words, hint)


def train(words: list[str]) -> None:
    """Train by a command line; print the final figures."""
    arguments = read_arguments(words)
    check_arguments(arguments)
    check_batch(arguments)
    with connect(arguments.address):
        logging.getLogger("ray").setLevel(logging.ERROR)  # Ray warns of its own deprecations
        run = Run(arguments)
        with sole_user(arguments.output):
            begin_run(arguments.output, plain(arguments))
            run.learn()
        run.algorithm.stop()
    print(show_figures(run.curve[-1]))
    print(f"policy: {visible(str(arguments.output / 'best.policy'))}")
