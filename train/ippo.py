"""This module trains one policy for all HAVs by IPPO, in one file: ``python -m train.ippo``.

    python -m train.ippo --preset single
    python -m train.ippo --preset swarm --network pooled
    hav-env evaluate avoid_jack runs/ippo-single/best.policy

Read it from top to bottom. In independent PPO (de Witt et al. 2020) every HAV is a learner of its
own, and all of them share the actor and the critic. Both read the observation of one HAV.
``train.mappo`` differs in the critic. ``train/loops/`` has the worlds, the networks and the files.

The folder of a run holds ``run.json`` (arguments, versions), ``curve.json`` (all evaluations),
``best.policy`` (the best on the held-out episodes) and ``last.policy``. A run cannot be resumed;
after an interrupt the folder keeps the best policy so far.
"""

import logging
import sys
from typing import Any, NamedTuple

import numpy as np
import torch
from torch import nn

from baselines.policies.network_checks import check_network
from baselines.storage.locks import sole_user
from hav_env.cli.options import report_errors
from train.curriculum import reward_at
from train.loops.advantages import advantages_of
from train.loops.arguments import LoopArguments, read_loop_arguments
from train.loops.moments import Normalizer, RewardScale
from train.loops.networks import Actor, Body, linear, log_density
from train.loops.record import Record, policy_of
from train.loops.starts import start_actor
from train.loops.worlds import Worlds
from train.runs import begin_run, plain
from train.seeds import take_seeds, train_set

_VALUE_WEIGHT, _LARGEST_GRADIENT = 0.5, 0.5


class Rollout(NamedTuple):
    """T actions of each of R HAVs."""

    rows: torch.Tensor  # (T + 1, R, D) normalized observations before the actions, and at the end
    actions: torch.Tensor  # (T, R, 2)
    logs: torch.Tensor  # (T, R) logarithms of their densities
    acts: torch.Tensor  # (T, R) bool: the HAV did not wait
    rewards: torch.Tensor  # (T, R)
    ended: torch.Tensor  # (T, R) bool
    futures: list[tuple[int, np.ndarray, torch.Tensor]]
    # action, rows and last normalized observations of truncated episodes


class Learner:
    """Actor, critic and their optimizer."""

    def __init__(self, arguments: LoopArguments, worlds: Worlds) -> None:
        """Build the networks, and begin with the start that the arguments name."""
        self.arguments, self.worlds = arguments, worlds

        def body() -> Body:
            return Body(arguments.network, worlds.row, arguments.encoder, arguments.layers)

        self.actor = Actor(body(), arguments.deviation, arguments.hold_noise > 0)
        self.critic = nn.Sequential(body(), linear(arguments.layers[-1], 1, 1.0))
        self.parameters = [*self.actor.parameters(), *self.critic.parameters()]
        self.optimizer = torch.optim.Adam(self.parameters, eps=1e-5, fused=True)
        self.seen = Normalizer(worlds.row, arguments.network == "pooled")
        self.seen.update(worlds.seen)
        if arguments.begin_with:
            start_actor(arguments.begin_with, self.actor, self.seen, worlds.process)
        rows = len(worlds.seen)
        self.scale = RewardScale(rows, arguments.discount, arguments.reward_limit)

    @torch.no_grad()
    def collect(self) -> Rollout:
        """Let all HAVs act in all worlds; the normalization stays the same in the meantime."""
        arguments, worlds = self.arguments, self.worlds
        steps, (rows, columns) = arguments.rollout_decisions, worlds.seen.shape
        seen = torch.empty(steps + 1, rows, columns)
        normalized = torch.empty(steps + 1, rows, columns)
        actions, logs = torch.empty(steps, rows, 2), torch.empty(steps, rows)
        rewards = torch.empty(steps, rows)
        acts, ended = (torch.empty(steps, rows, dtype=torch.bool) for _ in range(2))
        futures = []
        for t in range(steps):
            if arguments.hold_noise and t % arguments.hold_noise == 0:
                self.actor.draw(rows)
            seen[t], normalized[t] = worlds.seen, self.seen(worlds.seen)
            acts[t] = ~worlds.waits()
            actions[t], logs[t] = self.actor.act(normalized[t])
            step = worlds.step(actions[t])
            rewards[t], ended[t] = step.reward, step.ended
            if step.cut.size:
                havs = (step.cut[:, None] * worlds.havs + np.arange(worlds.havs)).ravel()
                futures.append((t, havs, self.seen(step.last)))
        seen[-1], normalized[-1] = worlds.seen, self.seen(worlds.seen)
        scaled = self.scale(rewards, ended)
        self.seen.update(seen[:-1].reshape(-1, columns))
        return Rollout(normalized, actions, logs, acts, scaled, ended, futures)

    @torch.no_grad()
    def advantages(self, rollout: Rollout) -> tuple[torch.Tensor, torch.Tensor]:
        """Return normalized advantages and returns, each (T, R)."""
        arguments, rewards = self.arguments, rollout.rewards.clone()
        steps = rollout.rows.shape[:2]
        values = self.critic(rollout.rows.flatten(0, 1)).reshape(steps)
        for t, havs, last in rollout.futures:  # a truncated episode has a future
            rewards[t, havs] += arguments.discount * self.critic(last)[:, 0]
        discounts = arguments.discount, arguments.gae_lambda
        advantages = advantages_of(rewards, values, rollout.ended, *discounts)
        returns = advantages + values[:-1]
        chosen = advantages[rollout.acts]
        centred = (advantages - chosen.mean()) / (chosen.std() + 1e-8)
        return centred * rollout.acts, returns  # a HAV that waits takes no action

    def learn(self, rollout: Rollout) -> dict[str, float]:
        """Improve actor and critic by the clipped objective; return the figures of the update."""
        arguments, divergence = self.arguments, 0.0
        advantages, returns = (array.flatten() for array in self.advantages(rollout))
        rows, actions = rollout.rows[:-1].flatten(0, 1), rollout.actions.flatten(0, 1)
        logs = rollout.logs.flatten()
        losses = []
        for _ in range(arguments.epochs):
            for chosen in torch.randperm(len(rows)).split(arguments.batch_size):
                seen = rows[chosen]
                mean, deviation = self.actor.distribution(seen)
                change = log_density(actions[chosen], mean, deviation) - logs[chosen]
                ratio, weight = change.exp(), advantages[chosen]
                clipped = ratio.clamp(1.0 - arguments.clip_range, 1.0 + arguments.clip_range)
                policy_loss = -torch.min(ratio * weight, clipped * weight).mean()
                value_loss = (self.critic(seen)[:, 0] - returns[chosen]).square().mean()
                loss = policy_loss + _VALUE_WEIGHT * value_loss
                if arguments.entropy:
                    loss = loss - arguments.entropy * deviation.log().sum(1).mean()
                divergence = float((ratio - 1.0 - change).mean().detach())
                if divergence > 1.5 * arguments.target_divergence:
                    break
                self.optimizer.zero_grad()
                loss.backward()
                nn.utils.clip_grad_norm_(self.parameters, _LARGEST_GRADIENT)
                self.optimizer.step()
                losses.append(float(value_loss.detach()))
            else:
                continue
            break
        told = {"divergence": divergence, "minibatches": len(losses)}
        return told | ({"value loss": float(np.mean(losses))} if losses else {})

    def update(self, progress: float) -> dict[str, float]:
        """Collect a rollout and learn from it; return figures.

        Args:
            progress: Part of the training that is over, from 0 to 1.
        """
        arguments = self.arguments
        self.worlds.process.set_reward(reward_at(arguments.curriculum, arguments.reward, progress))
        self.optimizer.param_groups[0]["lr"] = arguments.learning_rate * (1.0 - progress)
        with torch.no_grad():
            self.actor.log_deviation.clamp_(min=float(np.log(arguments.least_deviation)))
        found = self.learn(self.collect())
        return found | self.worlds.take_means()


def train_run(arguments: Any, resumed: bool = False) -> None:
    """Train one run; print the final figures.

    Args:
        arguments: The arguments of the run.
        resumed: Whether the run is already over: no run is resumed in the middle.
    """
    if resumed:
        return
    torch.set_num_threads(arguments.threads)
    torch.manual_seed(arguments.seed)
    learner = Learner(arguments, Worlds(arguments))
    check_network(policy_of(learner.actor, learner.seen, learner.worlds.process))
    each = arguments.rollout_decisions * len(learner.worlds.seen)
    with sole_user(arguments.output):
        begin_run(arguments.output, plain(arguments))
        with Record("IPPO (train/ippo.py)", arguments) as record:
            for done in range(0, arguments.decisions, each):
                figures = learner.update(done / arguments.decisions)
                policy = policy_of(learner.actor, learner.seen, learner.worlds.process)
                record.note(done + each, policy, figures)
        print(record.conclude())


def train(words: list[str]) -> None:
    """Train one run, or one for each seed, by a command line."""
    seeds, words = take_seeds(words)
    arguments = read_loop_arguments("ippo", "Train HAVs with independent PPO.", words)
    if seeds:
        train_set(arguments, seeds, False, "best.policy", train_run)
    else:
        train_run(arguments)


def main(words: list[str] | None = None) -> int:
    """Train one policy for all HAVs by IPPO."""
    logging.basicConfig(format="%(message)s")
    return report_errors(train, words, "the folder of the run keeps the best policy so far")


if __name__ == "__main__":
    sys.exit(main())
