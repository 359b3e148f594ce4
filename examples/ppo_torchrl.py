"""This module is PPO on TorchRL: PettingZooWrapper, the group ``hav``, one actor for all HAVs.

    python examples/ppo_torchrl.py --steps 200000 --output pair.policy
    python -m baselines evaluate pair.policy --scenario paper-pair

It is a recipe to begin from: one world, so it is slow, and TorchRL's own parts wherever there are
any. TorchRL distinguishes the last observation of an episode from the first of the next one, and a
truncation from an end, so advantages are right without further care.
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
    """How to train."""

    output: pathlib.Path = pathlib.Path("ppo_torchrl.policy")
    """The policy file."""
    steps: int = 200_000
    """Actions of each HAV."""
    scenario: str = "paper-pair"
    """Its name, or a JSON file."""
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
    """Of an episode, in steps of the simulator."""
    seed: int = 1


def tower(columns: int, outputs: int) -> nn.Sequential:
    """Return two layers of 64 tanh units and a linear one, for each HAV the same."""
    first, second = nn.Linear(columns, 64), nn.Linear(64, 64)
    return nn.Sequential(first, nn.Tanh(), second, nn.Tanh(), nn.Linear(64, outputs))


def train(told: Arguments) -> list[float]:
    """Train, write the policy; return the mean rewards of an action, update by update."""
    torch.manual_seed(told.seed)
    torch.set_num_threads(1)
    settings = {
        "scenario": told.scenario,
        "frame_skip": told.frame_skip,
        "max_steps": told.max_steps,
        "on_jackknife": "end",
        "on_collision": "end",
    }
    env = PettingZooWrapper(parallel_env(**settings))
    env.set_seed(1_000_000 * told.seed)  # the evaluator's episodes have small seeds
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
        distribution_class=IndependentNormal,  # the environment cuts actions to [-1, 1]
        return_log_prob=True,
        log_prob_key=LOG,
    )
    loss = ClipPPOLoss(
        actor,
        TensorDictModule(critic, [OBSERVED], [VALUE]),
        clip_epsilon=told.clip_range,
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
    loss.make_value_estimator(ValueEstimators.GAE, gamma=told.discount, lmbda=told.gae_lambda)
    optimizer = torch.optim.Adam(loss.parameters(), told.learning_rate)
    curve = []
    for update in range(max(1, told.steps // told.rollout)):
        with torch.no_grad():
            data = env.rollout(told.rollout, actor, break_when_any_done=False)
            curve.append(float(data["next", "hav", "reward"].mean()))
            data["next", "hav", "reward"] *= told.reward_scale
            loss.value_estimator(
                data,
                params=loss.critic_network_params,
                target_params=loss.target_critic_network_params,
            )
        for _ in range(told.epochs):
            for rows in torch.randperm(len(data)).split(told.batch):
                told_loss = loss(data[rows])
                optimizer.zero_grad()
                (told_loss["loss_objective"] + told_loss["loss_critic"]).backward()
                nn.utils.clip_grad_norm_(loss.parameters(), 0.5)
                optimizer.step()
        print(f"{(update + 1) * told.rollout:9,} steps, reward {curve[-1]:8.4f}", flush=True)
    layers = [part for part in means if isinstance(part, nn.Linear)]
    about = {"algorithm": "PPO (examples/ppo_torchrl.py)", "steps": told.steps, "rewards": curve}
    save_policy(network_of(layers, DecisionProcess(**settings)), told.output, about)
    return curve


if __name__ == "__main__":
    train(tyro.cli(Arguments))
