"""This module is PPO in one file, in the style of CleanRL, on the native vector environment.

    python examples/ppo_cleanrl.py --steps 2000000 --output reacher.policy
    python -m baselines evaluate reacher.policy

Read it from top to bottom. One HAV drives, in ``HAVSingle-v0``. The loop needs only PyTorch. Two
details are easy to get wrong and are right here:

* With next-step autoreset, the step after the end of an episode only begins the next one. Its
  action had no effect, so the learner ignores it.
* A truncated episode has a future: its advantages start from the value of the last observation,
  while those of a terminated one start from zero.
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
    """Options of the training."""

    output: pathlib.Path = pathlib.Path("ppo_cleanrl.policy")
    """Policy file to write."""
    steps: int = 2_000_000
    """Number of actions of all worlds together."""
    scenario: str = "paper-single"
    """Scenario: its name, or a JSON file."""
    worlds: int = 64
    rollout: int = 128
    """Actions of each world between updates."""
    minibatches: int = 8
    epochs: int = 8
    learning_rate: float = 5e-4
    """Learning rate at the beginning; it decreases linearly to zero."""
    discount: float = 0.995
    gae_lambda: float = 0.95
    clip_range: float = 0.2
    value_weight: float = 0.5
    gradient_norm: float = 0.5
    reward_scale: float = 0.1
    frame_skip: int = 5
    max_steps: int = 4_000
    """Length of an episode in steps of the simulator."""
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
        """Build networks for a number of observation columns."""
        super().__init__()

        def tower(outputs: int, gain: float) -> nn.Sequential:
            first, second = layer(columns, 64, 2**0.5), layer(64, 64, 2**0.5)
            return nn.Sequential(first, nn.Tanh(), second, nn.Tanh(), layer(64, outputs, gain))

        self.actor, self.critic = tower(2, 0.01), tower(1, 1.0)
        self.log_deviation = nn.Parameter(torch.full((2,), float(np.log(0.4))))

    def act(self, seen: torch.Tensor) -> Normal:
        """Return the distribution of actions; the environment clips them to [-1, 1]."""
        return Normal(self.actor(seen), self.log_deviation.exp())

    def value(self, seen: torch.Tensor) -> torch.Tensor:
        """Return the value: the expected return from here on."""
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
        rewards: Rewards of the actions.
        values: Values of the observations before the actions.
        after: Values of the observations after the actions, in the same episode.
        terminated: True where the episode was terminated: its future value is zero.
        ended: True where the episode was terminated or truncated.
        discount: For each action.
        gae_lambda: For each action.
    """
    advantages, later = torch.zeros_like(rewards), torch.zeros(rewards.shape[1])
    for t in reversed(range(len(rewards))):
        surprise = rewards[t] + discount * after[t] * ~terminated[t] - values[t]
        later = surprise + discount * gae_lambda * later * ~ended[t]
        advantages[t] = later
    return advantages


def learn(agent: Agent, optimizer: torch.optim.Optimizer, kept: dict, arguments: Arguments) -> None:
    """Improve the agent with the data of a rollout, each entry (B, ...)."""
    size = len(kept["actions"])
    for _ in range(arguments.epochs):
        for rows in torch.randperm(size).chunk(arguments.minibatches):
            seen, advantages = kept["seen"][rows], kept["advantages"][rows]
            distribution = agent.act(seen)
            ratio = (
                distribution.log_prob(kept["actions"][rows]).sum(-1) - kept["logs"][rows]
            ).exp()
            weighed = (advantages - advantages.mean()) / (advantages.std() + 1e-8)
            cut = ratio.clamp(1 - arguments.clip_range, 1 + arguments.clip_range)
            policy_loss = -torch.min(ratio * weighed, cut * weighed).mean()
            value_loss = (agent.value(seen) - kept["returns"][rows]).square().mean()
            optimizer.zero_grad()
            (policy_loss + arguments.value_weight * value_loss).backward()
            nn.utils.clip_grad_norm_(agent.parameters(), arguments.gradient_norm)
            optimizer.step()


def train(arguments: Arguments) -> list[float]:
    """Train, write the policy; return the mean returns of episodes, update by update."""
    torch.manual_seed(arguments.seed)
    torch.set_num_threads(1)
    settings: dict[str, Any] = {
        "scenario": arguments.scenario,
        "frame_skip": arguments.frame_skip,
        "max_steps": arguments.max_steps,
        "on_jackknife": "end",
        "reward": Reward(jackknife=-50.0),
    }
    envs = gym.make_vec("hav_env:HAVSingle-v0", num_envs=arguments.worlds, **settings)
    agent = Agent(envs.single_observation_space.shape[0])
    optimizer = torch.optim.Adam(agent.parameters(), arguments.learning_rate, eps=1e-5)
    # the evaluator's episodes have small seeds, so training does not use them
    observation, _ = envs.reset(seed=1_000_000 * arguments.seed)
    over, gained = np.zeros(arguments.worlds, bool), np.zeros(arguments.worlds)
    shape, begun, curve = (arguments.rollout, arguments.worlds), time.monotonic(), []
    updates = max(1, arguments.steps // (arguments.rollout * arguments.worlds))
    for update in range(updates):
        optimizer.param_groups[0]["lr"] = arguments.learning_rate * (1 - update / updates)
        seen = torch.zeros(arguments.rollout + 1, *observation.shape)
        actions, logs, rewards = torch.zeros(*shape, 2), torch.zeros(shape), torch.zeros(shape)
        begins, terminated, ended = (torch.zeros(shape, dtype=torch.bool) for _ in range(3))
        finished = []
        for t in range(arguments.rollout):
            seen[t], begins[t] = torch.from_numpy(observation), torch.from_numpy(over)
            with torch.no_grad():
                distribution = agent.act(seen[t])
                actions[t] = distribution.sample()
                logs[t] = distribution.log_prob(actions[t]).sum(-1)
            observation, reward, ends, cuts, _ = envs.step(actions[t].numpy())
            over = ends | cuts
            rewards[t] = torch.from_numpy(arguments.reward_scale * reward)
            terminated[t], ended[t] = torch.from_numpy(ends), torch.from_numpy(over)
            gained += reward
            finished += gained[over].tolist()
            gained[over] = 0.0
        seen[-1] = torch.from_numpy(observation)
        with torch.no_grad():
            values = agent.value(seen)
        advantages = advantages_of(
            rewards,
            values[:-1],
            values[1:],
            terminated,
            ended,
            arguments.discount,
            arguments.gae_lambda,
        )
        rollout = {"seen": seen[:-1], "actions": actions, "logs": logs, "advantages": advantages}
        rollout["returns"] = advantages + values[:-1]
        learn(agent, optimizer, {name: kept[~begins] for name, kept in rollout.items()}, arguments)
        curve.append(float(np.mean(finished)) if finished else float("nan"))
        steps = (update + 1) * arguments.rollout * arguments.worlds
        rate = steps / (time.monotonic() - begun)
        print(f"{steps:10,} steps, {rate:6,.0f}/s, return {curve[-1]:7.2f}", flush=True)
    layers = [part for part in agent.actor if isinstance(part, nn.Linear)]
    about = {
        "algorithm": "PPO (examples/ppo_cleanrl.py)",
        "steps": arguments.steps,
        "returns": curve,
    }
    save_policy(network_of(layers, DecisionProcess(**settings)), arguments.output, about)
    return curve


if __name__ == "__main__":
    train(tyro.cli(Arguments))
