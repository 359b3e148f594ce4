"""This module is PPO in one file, in the style of CleanRL, on the native vector environment.

    python examples/ppo_cleanrl.py --steps 2000000 --output reacher.policy
    python -m baselines evaluate reacher.policy

Read it from top to bottom. One HAV drives, in ``HAVSingle-v0``. The loop needs PyTorch and nothing
else. Two things are easy to get wrong and are right here:

* With next-step autoreset, the step after the end of an episode only begins the next one. Its
  action had no effect, so the learner ignores it.
* A truncated episode goes on without us: its advantages start from the value of the last
  observation, while those of a terminated one start from zero.
"""

import dataclasses
import pathlib
import time
from typing import Any

import gymnasium as gym
import numpy as np
import torch
import tyro
from torch import nn
from torch.distributions import Normal

from baselines.policies.files import save_policy
from hav_env import Reward
from hav_env.mdp.decision_process import DecisionProcess
from train.export import network_of


@dataclasses.dataclass
class Arguments:
    """How to train."""

    output: pathlib.Path = pathlib.Path("ppo_cleanrl.policy")
    """The policy file."""
    steps: int = 2_000_000
    """Actions of all worlds together."""
    scenario: str = "paper-single"
    """Its name, or a JSON file."""
    worlds: int = 64
    rollout: int = 128
    """Actions of each world between updates."""
    minibatches: int = 8
    epochs: int = 8
    learning_rate: float = 5e-4
    """At the beginning; it falls to nothing along a straight line."""
    discount: float = 0.995
    gae_lambda: float = 0.95
    clip_range: float = 0.2
    value_weight: float = 0.5
    gradient_norm: float = 0.5
    reward_scale: float = 0.1
    frame_skip: int = 5
    max_steps: int = 4_000
    """Of an episode, in steps of the simulator."""
    seed: int = 1


def layer(inputs: int, outputs: int, gain: float) -> nn.Linear:
    """Return a layer with orthogonal weights."""
    made = nn.Linear(inputs, outputs)
    nn.init.orthogonal_(made.weight, gain)
    nn.init.zeros_(made.bias)
    return made


class Agent(nn.Module):
    """Actor and critic, two layers of 64 tanh units each."""

    def __init__(self, columns: int) -> None:
        """Take observations of so many columns."""
        super().__init__()

        def tower(outputs: int, gain: float) -> nn.Sequential:
            first, second = layer(columns, 64, 2**0.5), layer(64, 64, 2**0.5)
            return nn.Sequential(first, nn.Tanh(), second, nn.Tanh(), layer(64, outputs, gain))

        self.actor, self.critic = tower(2, 0.01), tower(1, 1.0)
        self.log_deviation = nn.Parameter(torch.full((2,), float(np.log(0.4))))

    def act(self, seen: torch.Tensor) -> Normal:
        """Return how actions are distributed; the environment cuts them to [-1, 1]."""
        return Normal(self.actor(seen), self.log_deviation.exp())

    def value(self, seen: torch.Tensor) -> torch.Tensor:
        """Return what is still to be gained."""
        return self.critic(seen).squeeze(-1)


def advantages_of(
    rewards: torch.Tensor,
    values: torch.Tensor,
    after: torch.Tensor,
    terminated: torch.Tensor,
    ended: torch.Tensor,
    discount: float,
    gae_lambda: float,
) -> torch.Tensor:
    """Return generalized advantages, all arrays (T, W).

    Args:
        rewards: of the actions.
        values: of the observations before the actions.
        after: values of the observations after the actions, in the same episode.
        terminated: true where nothing is gained any more.
        ended: true where the episode was terminated or truncated.
        discount: for each action.
        gae_lambda: for each action.
    """
    advantages, later = torch.zeros_like(rewards), torch.zeros(rewards.shape[1])
    for t in reversed(range(len(rewards))):
        surprise = rewards[t] + discount * after[t] * ~terminated[t] - values[t]
        later = surprise + discount * gae_lambda * later * ~ended[t]
        advantages[t] = later
    return advantages


def learn(agent: Agent, optimizer: torch.optim.Optimizer, kept: dict, told: Arguments) -> None:
    """Improve the agent by what was seen in a rollout, each entry (B, ...)."""
    size = len(kept["actions"])
    for _ in range(told.epochs):
        for rows in torch.randperm(size).chunk(told.minibatches):
            seen, advantages = kept["seen"][rows], kept["advantages"][rows]
            distribution = agent.act(seen)
            ratio = (
                distribution.log_prob(kept["actions"][rows]).sum(-1) - kept["logs"][rows]
            ).exp()
            weighed = (advantages - advantages.mean()) / (advantages.std() + 1e-8)
            cut = ratio.clamp(1 - told.clip_range, 1 + told.clip_range)
            policy_loss = -torch.min(ratio * weighed, cut * weighed).mean()
            value_loss = (agent.value(seen) - kept["returns"][rows]).square().mean()
            optimizer.zero_grad()
            (policy_loss + told.value_weight * value_loss).backward()
            nn.utils.clip_grad_norm_(agent.parameters(), told.gradient_norm)
            optimizer.step()


def train(told: Arguments) -> list[float]:
    """Train, write the policy; return the mean returns of episodes, update by update."""
    torch.manual_seed(told.seed)
    torch.set_num_threads(1)
    settings: dict[str, Any] = {
        "scenario": told.scenario,
        "frame_skip": told.frame_skip,
        "max_steps": told.max_steps,
        "on_jackknife": "end",
        "reward": Reward(jackknife=-50.0),
    }
    envs = gym.make_vec("hav_env:HAVSingle-v0", num_envs=told.worlds, **settings)
    agent = Agent(envs.single_observation_space.shape[0])
    optimizer = torch.optim.Adam(agent.parameters(), told.learning_rate, eps=1e-5)
    # the evaluator's episodes have small seeds: not trained on
    observation, _ = envs.reset(seed=1_000_000 * told.seed)
    over, gained = np.zeros(told.worlds, bool), np.zeros(told.worlds)
    shape, begun, curve = (told.rollout, told.worlds), time.monotonic(), []
    updates = max(1, told.steps // (told.rollout * told.worlds))
    for update in range(updates):
        optimizer.param_groups[0]["lr"] = told.learning_rate * (1 - update / updates)
        seen = torch.zeros(told.rollout + 1, *observation.shape)
        actions, logs, rewards = torch.zeros(*shape, 2), torch.zeros(shape), torch.zeros(shape)
        begins, terminated, ended = (torch.zeros(shape, dtype=torch.bool) for _ in range(3))
        finished = []
        for t in range(told.rollout):
            seen[t], begins[t] = torch.from_numpy(observation), torch.from_numpy(over)
            with torch.no_grad():
                distribution = agent.act(seen[t])
                actions[t] = distribution.sample()
                logs[t] = distribution.log_prob(actions[t]).sum(-1)
            observation, reward, ends, cuts, _ = envs.step(actions[t].numpy())
            over = ends | cuts
            rewards[t] = torch.from_numpy(told.reward_scale * reward)
            terminated[t], ended[t] = torch.from_numpy(ends), torch.from_numpy(over)
            gained += reward
            finished += gained[over].tolist()
            gained[over] = 0.0
        seen[-1] = torch.from_numpy(observation)
        with torch.no_grad():
            values = agent.value(seen)
        advantages = advantages_of(
            rewards, values[:-1], values[1:], terminated, ended, told.discount, told.gae_lambda
        )
        rollout = {"seen": seen[:-1], "actions": actions, "logs": logs, "advantages": advantages}
        rollout["returns"] = advantages + values[:-1]
        learn(agent, optimizer, {name: kept[~begins] for name, kept in rollout.items()}, told)
        curve.append(float(np.mean(finished)) if finished else float("nan"))
        steps = (update + 1) * told.rollout * told.worlds
        rate = steps / (time.monotonic() - begun)
        print(f"{steps:10,} steps, {rate:6,.0f}/s, return {curve[-1]:7.2f}", flush=True)
    layers = [part for part in agent.actor if isinstance(part, nn.Linear)]
    about = {"algorithm": "PPO (examples/ppo_cleanrl.py)", "steps": told.steps, "returns": curve}
    save_policy(network_of(layers, DecisionProcess(**settings)), told.output, about)
    return curve


if __name__ == "__main__":
    train(tyro.cli(Arguments))
