"""This module is PPO on TorchRL: PettingZooWrapper, the group ``hav``, one actor for all HAVs.

    python examples/ppo_torchrl.py --steps 200000 --output pair.policy
    python -m baselines evaluate pair.policy --scenario paper-pair

It is a recipe to start from: one world, so it is slow, and TorchRL's own parts where possible.
TorchRL distinguishes the last observation of an episode from the first of the next one, and a
truncation from a termination. Advantages are therefore right without further care.
"""

import dataclasses
import pathlib

import numpy as np
import torch
import tyro
from tensordict.nn import AddStateIndependentNormalScale, TensorDictModule
from torch import nn
from torchrl.envs.libs.pettingzoo import PettingZooWrapper
from torchrl.modules import IndependentNormal, ProbabilisticActor
from torchrl.objectives import ClipPPOLoss, ValueEstimators

from baselines.policies.files import save_policy
from hav_env import parallel_env
from hav_env.mdp.decision_process import DecisionProcess
from train.export import network_of

OBSERVED, MEAN, DEVIATION = ("hav", "observation"), ("hav", "loc"), ("hav", "scale")
LOG, VALUE = ("hav", "sample_log_prob"), ("hav", "state_value")


@dataclasses.dataclass
class Arguments:
    """Options of the training."""

    output: pathlib.Path = pathlib.Path("ppo_torchrl.policy")
    """Policy file to write."""
    steps: int = 200_000
    """Number of actions of each HAV."""
    scenario: str = "paper-pair"
    """Scenario: its name, or a JSON file."""
    rollout: int = 2_000
    """Actions of each HAV between updates; then episodes begin anew."""
    batch: int = 500
    epochs: int = 8
    learning_rate: float = 5e-4
    discount: float = 0.995
    gae_lambda: float = 0.95
    clip_range: float = 0.2
    reward_scale: float = 0.1
    frame_skip: int = 5
    max_steps: int = 4_000
    """Length of an episode in steps of the simulator."""
    seed: int = 1


def tower(columns: int, outputs: int) -> nn.Sequential:
    """Return two layers of 64 tanh units and a linear one, for each HAV the same."""
    first, second = nn.Linear(columns, 64), nn.Linear(64, 64)
    return nn.Sequential(first, nn.Tanh(), second, nn.Tanh(), nn.Linear(64, outputs))


def train(arguments: Arguments) -> list[float]:
    """Train, write the policy; return the mean rewards of an action, update by update."""
    torch.manual_seed(arguments.seed)
    torch.set_num_threads(1)
    settings = {
        "scenario": arguments.scenario,
        "frame_skip": arguments.frame_skip,
        "max_steps": arguments.max_steps,
        "on_jackknife": "end",
        "on_collision": "end",
    }
    env = PettingZooWrapper(parallel_env(**settings))
    env.set_seed(1_000_000 * arguments.seed)  # the evaluator's episodes have small seeds
    columns = env.observation_spec[OBSERVED].shape[-1]
    means, critic = tower(columns, 2), tower(columns, 1)
    with torch.no_grad():
        means[-1].weight.mul_(0.01)
    spread = AddStateIndependentNormalScale(2, scale_mapping="exp")
    with torch.no_grad():
        spread.state_independent_scale.fill_(float(np.log(0.4)))
    actor = ProbabilisticActor(
        TensorDictModule(nn.Sequential(means, spread), [OBSERVED], [MEAN, DEVIATION]),
        in_keys=[MEAN, DEVIATION],
        out_keys=[env.action_key],
        distribution_class=IndependentNormal,  # the environment clips actions to [-1, 1]
        return_log_prob=True,
        log_prob_key=LOG,
    )
    loss = ClipPPOLoss(
        actor,
        TensorDictModule(critic, [OBSERVED], [VALUE]),
        clip_epsilon=arguments.clip_range,
        entropy_bonus=False,
        normalize_advantage=True,
    )
    loss.set_keys(
        reward=env.reward_key,
        action=env.action_key,
        sample_log_prob=LOG,
        value=VALUE,
        done=("hav", "done"),
        terminated=("hav", "terminated"),
    )
    loss.make_value_estimator(
        ValueEstimators.GAE, gamma=arguments.discount, lmbda=arguments.gae_lambda
    )
    optimizer = torch.optim.Adam(loss.parameters(), arguments.learning_rate)
    curve = []
    for update in range(max(1, arguments.steps // arguments.rollout)):
        with torch.no_grad():
            data = env.rollout(arguments.rollout, actor, break_when_any_done=False)
            curve.append(float(data["next", "hav", "reward"].mean()))
            data["next", "hav", "reward"] *= arguments.reward_scale
            loss.value_estimator(
                data,
                params=loss.critic_network_params,
                target_params=loss.target_critic_network_params,
            )
        for _ in range(arguments.epochs):
            for rows in torch.randperm(len(data)).split(arguments.batch):
                losses = loss(data[rows])
                optimizer.zero_grad()
                (losses["loss_objective"] + losses["loss_critic"]).backward()
                nn.utils.clip_grad_norm_(loss.parameters(), 0.5)
                optimizer.step()
        print(f"{(update + 1) * arguments.rollout:9,} steps, reward {curve[-1]:8.4f}", flush=True)
    layers = [part for part in means if isinstance(part, nn.Linear)]
    about = {
        "algorithm": "PPO (examples/ppo_torchrl.py)",
        "steps": arguments.steps,
        "rewards": curve,
    }
    save_policy(network_of(layers, DecisionProcess(**settings)), arguments.output, about)
    return curve


if __name__ == "__main__":
    train(tyro.cli(Arguments))
