"""This module trains on the task of ``train.ppo`` by Ray RLlib, one policy for all HAVs.

    python -m train.rllib --preset pair --runners 2
    python -m train.rllib --preset pair --runners 64 --worlds 16 --address auto
    python -m baselines evaluate runs/rllib-pair/best.policy --scenario paper-pair

Ray starts on this machine unless ``--address`` names a cluster (``ray start --head`` begins one;
its machines need the same version of the project and ``pip install 'hav_env[ray]'``). The reward
is that of ``train.ppo``, and so is the network. Observations are not normalized: RLlib keeps
statistics for each agent, not for a policy. On one machine, ``train.ppo`` is many times faster.

The folder of a run holds ``run.json`` (arguments, versions), ``curve.json`` (every evaluation),
``best.policy`` (the best on the held-out episodes), ``last.policy``. It cannot be resumed.
"""

import dataclasses
import json
import logging
import pathlib
import time
from typing import Any

import numpy as np
import torch

from baselines.cli.options import take_option
from baselines.cli.progress import new_bar
from baselines.evaluation.ray_cluster import connect
from baselines.policies.files import save_policy
from baselines.policies.network import Network
from baselines.storage.atomic_files import write_text
from baselines.storage.locks import sole_user
from hav_env.cli.options import parse_options, report_errors
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.models.text import visible
from train.checks import OPTIONS, check_arguments, take_models
from train.curriculum import reward_at
from train.export import network_of
from train.rllib.arguments import RLLIB_PRESETS, Arguments, check_batch
from train.rllib.setup import SHARED, configure, mean_layers
from train.runs import begin_run, plain, versions
from train.scores import evaluate, score
from train.training_task import settings_of


class Run:
    """One training, from its beginning to its end; Ray is connected all the while."""

    def __init__(self, arguments: Arguments) -> None:
        """Set up the processes, their worlds and the learner; nothing is written."""
        self.arguments = arguments
        settings = settings_of(arguments, threads=1)
        self.process = DecisionProcess(**settings)
        self.algorithm = configure(arguments, dict(settings), self.process.num_havs).build_algo()
        self.curve: list[dict[str, float]] = []
        self.decisions, self.seconds = 0, 0.0

    def learn(self) -> None:
        """Learn until the end, and evaluate on the way."""
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
        """Return what has been learned so far, as it would act: without noise."""
        return network_of(mean_layers(self.algorithm.get_module(SHARED)), self.process)

    def _weigh_harm(self, progress: float) -> None:
        reward = reward_at(self.arguments.curriculum, self.arguments.reward, progress)

        def set_reward(runner: Any) -> None:
            if runner.env is not None:  # the learner's own drives nothing where there are others
                runner.env.unwrapped.call("set_reward", reward)

        self.algorithm.env_runner_group.foreach_env_runner(set_reward)

    def _evaluate(self) -> None:
        """Score the policy on the held-out episodes, keep it, and keep it as the best if it is."""
        policy, told = self.policy(), self.arguments
        figures = evaluate(policy, told.scenario, told.evaluation_episodes, told.vehicle)
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
        save_policy(policy, told.output / "last.policy", about)
        if self.curve[-1]["score"] > best:
            save_policy(policy, told.output / "best.policy", about)


def read_arguments(words: list[str]) -> Arguments:
    """Return the arguments of a command line.

    Raises:
        ValueError: when there is no such preset or option.
    """
    preset, words = take_option(words, "--preset", "single")
    if preset not in RLLIB_PRESETS:
        raise ValueError(f"unknown preset {preset!r}; known: {', '.join(RLLIB_PRESETS)}")
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
    """Train as a command line says; print what came of it."""
    arguments = read_arguments(words)
    check_arguments(arguments)
    check_batch(arguments)
    with connect(arguments.address):
        logging.getLogger("ray").setLevel(logging.ERROR)  # it warns of its own old ways
        run = Run(arguments)
        with sole_user(arguments.output):
            begin_run(arguments.output, plain(arguments))
            run.learn()
        run.algorithm.stop()
    print(", ".join(f"{name} {value:.4g}" for name, value in run.curve[-1].items()))
    print(f"policy: {visible(str(arguments.output / 'best.policy'))}")
