"""Proximal policy optimization with one policy for all HAVs: ``python -m train.ppo --preset pair``.

Read from top to bottom: the arguments, the presets, the learner, what happens between its
iterations (log, evaluate, checkpoint), the command line. The folder of a run holds

* ``run.json``: arguments, versions, git revision;
* ``best.policy``: the policy that did best on the held-out episodes, ``last.policy``: the latest;
* ``curve.json``: every evaluation;
* ``checkpoint.pt``: everything that it takes to go on as if nothing had happened;
* TensorBoard's files: ``tensorboard --logdir FOLDER``.
"""

import dataclasses
import json
import logging
import os
import pathlib
import sys
import time
from typing import Any

import numpy as np
import pyarrow as pa
import rich.progress
import torch
from rich.console import Console
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import configure
from stable_baselines3.common.vec_env import VecNormalize

from baselines.evaluate import figures_of, measure
from baselines.files import whole_file, write_text
from baselines.network import Network
from baselines.options import take_option
from baselines.policy_files import load_trained, save_policy
from baselines.rollout import rollout
from hav_env import Observation, Reward, Task
from hav_env.command_line import parse_options
from hav_env.scenarios.presets import scenario_of
from train.curriculum import Curriculum, check_curriculum, lengthen, reward_at
from train.export import network_of
from train.runs import begin_run, read_run, versions
from train.sb3_env import HAVVecEnv

# seeds of episodes: those that the best policy is scored on at the end, those that it is chosen by,
# and the first of those to train on
SCORED, HELD_OUT, TRAINING = 0, 1, 1_000_000
CHECKPOINT = "checkpoint.pt"
CURRICULUM, OBSERVATION = Curriculum(), Observation(neighbors=1, fronts=True)
REWARD = Reward(goal=20.0, jackknife=-200.0, articulation=-1.0, time=-0.05)


@dataclasses.dataclass(frozen=True)
class Arguments:
    """How to train."""

    scenario: str = "paper-single"
    """Its name, or a JSON file."""
    output: pathlib.Path = pathlib.Path("runs/ppo")
    """Folder of the run."""
    seed: int = 0
    """The same seed gives the same weights, on the same machine with the same versions."""
    decisions: int = 60_000_000
    """For how long to learn: actions of all HAVs together."""
    worlds: int = 512
    """How many run side by side."""
    rollout_decisions: int = 64
    """Actions of each HAV between updates."""
    batch_size: int = 4_096
    epochs: int = 4
    """How often each action is learned from."""
    learning_rate: float = 1e-3
    """At the beginning; it falls to nothing along a straight line."""
    discount: float = 0.995
    """For each action."""
    gae_lambda: float = 0.95
    clip_range: float = 0.2
    entropy: float = 0.0
    """Weight of the entropy bonus."""
    deviation: float = 0.4
    """Standard deviation of actions at the beginning."""
    layers: tuple[int, ...] = (64, 64)
    """Units of the hidden layers, of the policy and of the value."""
    frame_skip: int = 5
    """For how many steps of the simulator an action is held."""
    max_steps: int = 4_000
    """Of an episode to train on, in steps of the simulator; those of evaluations are the task's."""
    observation: Observation = OBSERVATION
    """What a HAV observes of others; of no more than there are."""
    trailer_sigma: float = 4.5
    """Of the trailer counts to train on, see ``RandomFleet``; evaluations have the scenario's."""
    reward: Reward = REWARD
    """Weights of its terms."""
    curriculum: Curriculum = CURRICULUM
    """How the weights of harm grow."""
    evaluate_every: int = 2_000_000
    """Decisions between evaluations."""
    evaluation_episodes: int = 500
    """Held-out episodes of an evaluation."""
    scored_episodes: int = 4_500
    """Episodes that the best policy is scored on at the end: others, used for nothing else."""
    checkpoint_every: int = 2_000_000
    """Decisions between checkpoints."""
    threads: int = 1
    """Of the simulator and of PyTorch. The weights depend on it, for PyTorch sums differently."""


PRESETS = {
    "single": Arguments(),
    "pair": Arguments(scenario="paper-pair", worlds=256, max_steps=6_000),
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
    return HAVVecEnv(
        arguments.worlds,
        scenario=lengthen(scenario_of(arguments.scenario), arguments.trailer_sigma),
        observation=arguments.observation,
        reward=arguments.reward,
        frame_skip=arguments.frame_skip,
        threads=arguments.threads,
        task=Task(max_steps=arguments.max_steps, on_jackknife="end", on_collision="end"),
    )


def make_learner(arguments: Arguments, env: VecNormalize) -> PPO:
    """Return a learner that has learned nothing yet."""
    return PPO(
        "MlpPolicy",
        env,
        learning_rate=_falling(arguments.learning_rate),
        n_steps=arguments.rollout_decisions,
        batch_size=arguments.batch_size,
        n_epochs=arguments.epochs,
        gamma=arguments.discount,
        gae_lambda=arguments.gae_lambda,
        clip_range=arguments.clip_range,
        ent_coef=arguments.entropy,
        policy_kwargs={
            "net_arch": list(arguments.layers),
            "log_std_init": float(np.log(arguments.deviation)),
        },
        seed=arguments.seed,
        device="cpu",
    )


def _falling(rate: float) -> Any:
    return lambda remaining: rate * remaining


class Run:
    """One training: the learner, and all that changes while it learns."""

    def __init__(self, arguments: Arguments) -> None:
        """Set up the worlds and the learner; nothing is written."""
        torch.set_num_threads(arguments.threads)
        self.arguments = arguments
        worlds = make_worlds(arguments)
        self.process = worlds.process
        self.env = VecNormalize(worlds, gamma=arguments.discount)
        self.learner = make_learner(arguments, self.env)
        self.env.seed(TRAINING + arguments.seed * arguments.worlds)
        self.curve: list[dict[str, float]] = []
        self.seconds = 0.0  # of learning, over all sittings

    def policy(self) -> Network:
        """Return what has been learned so far, as it would act: without noise."""
        network = self.learner.policy
        modules = [*network.mlp_extractor.policy_net, network.action_net]
        layers = [module for module in modules if isinstance(module, torch.nn.Linear)]
        seen: Any = self.env.obs_rms
        variance = seen.var + self.env.epsilon
        return network_of(layers, self.process, seen.mean, variance, self.env.clip_obs)

    def evaluate(self, episodes: int) -> dict[str, float]:
        """Return the evaluator's figures of the policy on the first of the held-out episodes."""
        scenario = scenario_of(self.arguments.scenario)
        return figures(rollout(self.policy(), scenario, HELD_OUT, np.arange(episodes)))

    def save(self, name: str) -> None:
        """Write the policy to the run's folder."""
        about = {
            "algorithm": "PPO (stable-baselines3)",
            "arguments": plain(self.arguments),
            "decisions": self.learner.num_timesteps,
            "hours": self.seconds / 3_600,
            "curve": self.curve,
            **versions(),
        }
        save_policy(self.policy(), self.arguments.output / name, about)

    def write_checkpoint(self) -> None:
        """Write down everything that changes: learner, normalizer, worlds, random numbers."""
        learner, env = self.learner, self.env
        state = {
            "policy": learner.policy.state_dict(),
            "optimizer": learner.policy.optimizer.state_dict(),
            "decisions": learner.num_timesteps,
            "updates": learner._n_updates,
            "observation": learner._last_obs,
            "starts": learner._last_episode_starts,
            "normalizer": (env.obs_rms, env.ret_rms, env.returns),
            "worlds": env.unwrapped,
            "torch": torch.get_rng_state(),
            "numpy": np.random.get_state(),  # noqa: NPY002 (SB3 shuffles with it)
            "curve": self.curve,
            "seconds": self.seconds,
        }
        with whole_file(self.arguments.output / CHECKPOINT) as unfinished:
            torch.save(state, unfinished)

    def read_checkpoint(self) -> None:
        """Go back to where the checkpoint was written.

        Raises:
            ValueError: when it is broken, or was written by another version.
        """
        path, learner, env = self.arguments.output / CHECKPOINT, self.learner, self.env
        try:
            state = torch.load(path, weights_only=False)
            learner.policy.load_state_dict(state["policy"])
            learner.policy.optimizer.load_state_dict(state["optimizer"])
            learner.num_timesteps, learner._n_updates = state["decisions"], state["updates"]
            learner._last_obs, learner._last_episode_starts = state["observation"], state["starts"]
            env.obs_rms, env.ret_rms, env.returns = state["normalizer"]
            env.venv = state["worlds"]
            self.process = state["worlds"].process
            torch.set_rng_state(state["torch"])
            np.random.set_state(state["numpy"])  # noqa: NPY002
            self.curve, self.seconds = state["curve"], state["seconds"]
        except Exception as error:  # a broken pickle can raise anything
            raise ValueError(f"cannot go on from {path}: {error!r}") from None

    def learn(self) -> None:
        """Learn until the end, from wherever it is."""
        arguments, learner = self.arguments, self.learner
        left = arguments.decisions - learner.num_timesteps
        if left <= 0:
            return
        learner.set_logger(configure(str(arguments.output), ["tensorboard"]))
        with Between(self) as between:
            learner.learn(left, callback=between, reset_num_timesteps=False)


def conclude(arguments: Arguments) -> dict[str, float]:
    """Score the best policy on episodes that nothing was chosen by; write it into its file."""
    path, episodes = arguments.output / "best.policy", arguments.scored_episodes
    policy, about = load_trained(path)
    table = rollout(policy, scenario_of(arguments.scenario), SCORED, np.arange(episodes))
    found = figures(table)
    first = table.select(["episode", "hav", "path_length", "largest_articulation"]).slice(0, 4)
    told = {"seed": SCORED, "episodes": episodes, "figures": found, "first": first.to_pylist()}
    save_policy(policy, path, about | {"evaluation": told})
    return found


def figures(table: pa.Table) -> dict[str, float]:
    """Return the evaluator's figures of a table; those that it lacks are left out."""
    values = {figure.name: measure(table, figure).value for figure in figures_of(table)}
    return {name: value for name, value in values.items() if np.isfinite(value)}


def score(found: dict[str, float]) -> float:
    """Return by which number the best policy is chosen: goals, less what went wrong, twice."""
    goals = [value for name, value in found.items() if name.endswith(" hit")]
    harm = found["jackknifed"] + found.get("actual collision", 0.0)
    return float(np.mean(goals)) - 2.0 * harm


class Between(BaseCallback):
    """What happens between iterations: the log, the bar, evaluations and checkpoints."""

    def __init__(self, run: Run) -> None:
        super().__init__()
        self.run = run
        self.begun, self.spent = time.monotonic(), run.seconds
        self.first = run.learner.num_timesteps
        self.ended: list[dict[str, Any]] = []  # infos of episodes since the last log
        self.bar = rich.progress.Progress(
            rich.progress.TextColumn("{task.completed:,}/{task.total:,} decisions"),
            rich.progress.BarColumn(),
            rich.progress.TextColumn("{task.fields[told]}"),
            rich.progress.TimeElapsedColumn(),
            rich.progress.TimeRemainingColumn(),
            console=Console(stderr=True),
        )
        total = run.arguments.decisions
        self.task = self.bar.add_task("", total=total, completed=self.first, told="")

    def __enter__(self) -> "Between":
        self.bar.start()
        return self

    def __exit__(self, *error: object) -> None:
        self.bar.stop()

    def _on_step(self) -> bool:
        infos = self.locals["infos"]
        self.ended += [infos[row] for row in np.flatnonzero(self.locals["dones"])]
        return True

    def _on_rollout_start(self) -> None:
        """Log, evaluate, write the checkpoint: after an update, before the next rollout."""
        run, done = self.run, self.num_timesteps
        arguments = run.arguments
        progress = done / arguments.decisions
        run.process.set_reward(reward_at(arguments.curriculum, arguments.reward, progress))
        run.seconds = self.spent + time.monotonic() - self.begun
        self._log()
        each = arguments.worlds * run.process.num_havs * arguments.rollout_decisions
        if done > self.first:
            if done % arguments.evaluate_every < each:
                self._evaluate()
            if done % arguments.checkpoint_every < each:
                run.write_checkpoint()
        rate = (done - self.first) / max(time.monotonic() - self.begun, 1e-9)
        last = run.curve[-1] if run.curve else {}
        told = f"{rate:,.0f}/s" + "".join(
            f", {name} {100 * last[name]:.1f} %" for name in ("goal 1 hit", "goal 2 hit") if last
        )
        self.bar.update(self.task, completed=done, told=told)

    def _on_training_end(self) -> None:
        self.run.seconds = self.spent + time.monotonic() - self.begun
        self._evaluate()
        self.run.write_checkpoint()

    def _log(self) -> None:
        """Record the means of what episodes came to: every term of the reward, every event."""
        ended, self.ended = self.ended, []
        for name in ended[0] if ended else ():
            if isinstance(ended[0][name], float) and name not in ("seed", "episode_number"):
                self.logger.record(f"episodes/{name}", np.mean([info[name] for info in ended]))
        self.logger.record("episodes/count", len(ended))

    def _evaluate(self) -> None:
        """Score the policy on the held-out episodes, keep it, and keep it as the best if it is."""
        run = self.run
        found = run.evaluate(run.arguments.evaluation_episodes)
        for name, value in found.items():
            self.logger.record(f"held_out/{name.replace(' / ', '_per_').replace(' ', '_')}", value)
        best = max((row["score"] for row in run.curve), default=-np.inf)
        row = {"decisions": self.num_timesteps, "hours": run.seconds / 3_600, **found}
        run.curve.append(row | {"score": score(found)})
        write_text(json.dumps(run.curve, indent=1) + "\n", run.arguments.output / "curve.json")
        run.save("last.policy")
        if run.curve[-1]["score"] > best:
            run.save("best.policy")


def plain(arguments: Arguments) -> dict[str, Any]:
    """Return arguments as JSON knows them."""
    told = dataclasses.asdict(arguments)
    return told | {
        "output": str(arguments.output),
        "observation": arguments.observation._asdict(),
        "reward": arguments.reward._asdict(),
        "curriculum": arguments.curriculum._asdict(),
    }


def arguments_of(told: dict[str, Any]) -> Arguments:
    """Return the arguments that ``plain`` has written down."""
    changed = {
        "output": pathlib.Path(told["output"]),
        "layers": tuple(told["layers"]),
        "observation": Observation(**told["observation"]),
        "reward": Reward(**told["reward"]),
        "curriculum": Curriculum(**told["curriculum"]),
    }
    return Arguments(**(told | changed))


def check_arguments(arguments: Arguments) -> None:
    """Check what neither the environment nor the learner would name.

    Raises:
        ValueError: naming the argument, its value and what is allowed.
    """
    check_curriculum(arguments.curriculum)
    least = 1
    for name, kind in Arguments.__annotations__.items():
        if kind is int and name != "seed" and getattr(arguments, name) < least:
            raise ValueError(f"{name} is {getattr(arguments, name)}, but must be at least {least}")
    if not arguments.layers or min(arguments.layers) < 1:
        raise ValueError(f"layers is {arguments.layers}, but must name at least one unit each")
    for name in ("learning_rate", "deviation", "clip_range"):
        if not 0 < getattr(arguments, name) < np.inf:
            raise ValueError(f"{name} is {getattr(arguments, name)}, but must be above 0")
    for name in ("discount", "gae_lambda"):
        if not 0 < getattr(arguments, name) <= 1:
            raise ValueError(f"{name} is {getattr(arguments, name)}, but must be in (0, 1]")


def read_arguments(words: list[str]) -> tuple[Arguments, bool]:
    """Return the arguments of a command line, and whether they are those of a run to resume.

    Raises:
        ValueError: when there is no such preset, option or run.
    """
    resumed, words = take_option(words, "--resume", "")
    if resumed:
        if words:
            raise ValueError(f"--resume goes on as the run began, and knows no {words[0]}")
        folder = pathlib.Path(resumed)
        told = arguments_of(read_run(folder, CHECKPOINT))
        return dataclasses.replace(told, output=folder), True
    preset, words = take_option(words, "--preset", "single")
    if preset not in PRESETS:
        raise ValueError(f"unknown preset {preset!r}; known: {', '.join(PRESETS)}")
    usual = dataclasses.replace(PRESETS[preset], output=pathlib.Path("runs") / preset)
    usage = f"python -m train.ppo [--preset {'|'.join(PRESETS)}] | --resume FOLDER"
    return parse_options(Arguments, usage, "Train HAVs with PPO.", words, usual), False


def main(words: list[str] | None = None) -> int:
    """Train; return the exit code. What is wrong is said in one line."""
    logging.basicConfig(format="%(message)s")
    try:
        arguments, resumed = read_arguments(sys.argv[1:] if words is None else words)
        check_arguments(arguments)
        run = Run(arguments)
        if resumed:
            run.read_checkpoint()
        else:
            begin_run(arguments.output, plain(arguments))
        run.learn()
        found = conclude(arguments)
    except (ValueError, TypeError, OSError) as error:
        print(f"error: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted: --resume FOLDER goes on from the last checkpoint", file=sys.stderr)
        return 130
    print(", ".join(f"{name} {value:.4g}" for name, value in found.items()))
    print(f"policy: {os.path.join(arguments.output, 'best.policy')}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
