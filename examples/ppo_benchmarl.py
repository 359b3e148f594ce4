"""This module is IPPO and MAPPO on BenchMARL: batched worlds, one actor for all HAVs.

    python examples/ppo_benchmarl.py --algorithm mappo --frames 200000 --output pair.policy
    python -m baselines evaluate pair.policy --scenario paper-pair

It is a recipe to start from. The critic of MAPPO observes the central state of a world, that of
IPPO the observation of the HAV. Any other BenchMARL algorithm for continuous actions runs on the
same task; only the actors of these two become policy files here.
"""

import dataclasses
import pathlib
import tempfile
from typing import Any, Literal

import numpy as np
import torch
import tyro
from benchmarl.algorithms import IppoConfig, MappoConfig
from benchmarl.experiment import Callback, Experiment, ExperimentConfig
from benchmarl.models.mlp import MlpConfig
from torch import nn

from baselines.policies.files import save_policy
from hav_env.envs.benchmarl import HAVTask
from hav_env.envs.torchrl import GROUP
from hav_env.mdp.decision_process import DecisionProcess
from train.export import network_of

ALGORITHMS = {"ippo": IppoConfig, "mappo": MappoConfig}


@dataclasses.dataclass
class Arguments:
    """Options of the training."""

    output: pathlib.Path = pathlib.Path("ppo_benchmarl.policy")
    """Policy file to write."""
    algorithm: Literal["ippo", "mappo"] = "mappo"
    frames: int = 200_000
    """Number of actions of all worlds; a frame of BenchMARL is an action of all HAVs of a world."""
    scenario: str = "paper-pair"
    """Scenario: its name, or a JSON file."""
    worlds: int = 64
    rollout: int = 100
    """Actions of each world between updates."""
    batch: int = 800
    epochs: int = 8
    learning_rate: float = 5e-4
    discount: float = 0.995
    gae_lambda: float = 0.95
    clip_range: float = 0.2
    frame_skip: int = 5
    max_steps: int = 4_000
    """Length of an episode in steps of the simulator."""
    seed: int = 1


class RewardCurve(Callback):
    """Keeps the mean reward of an action, batch by batch."""

    def __init__(self) -> None:
        """Begin with an empty curve."""
        super().__init__()
        self.rewards: list[float] = []

    def on_batch_collected(self, batch: Any) -> None:
        """Record the rewards of a batch."""
        self.rewards.append(float(batch["next", GROUP, "reward"].mean()))


def train(arguments: Arguments) -> list[float]:
    """Train, write the policy; return the mean rewards of an action, update by update."""
    torch.set_num_threads(1)
    settings: dict[str, Any] = {
        "scenario": arguments.scenario,
        "frame_skip": arguments.frame_skip,
        "max_steps": arguments.max_steps,
        "on_jackknife": "end",
        "on_collision": "end",
    }
    algorithm = ALGORITHMS[arguments.algorithm].get_from_yaml()
    algorithm.clip_epsilon, algorithm.lmbda = arguments.clip_range, arguments.gae_lambda
    algorithm.use_tanh_normal = False  # means are actions, which the environment clips to [-1, 1]
    layers = MlpConfig(num_cells=[64, 64], activation_class=nn.Tanh, layer_class=nn.Linear)
    curve = RewardCurve()
    with tempfile.TemporaryDirectory() as folder:
        experiment = Experiment(
            HAVTask.PAPER_PAIR.get_task({**settings, "state": arguments.algorithm == "mappo"}),
            algorithm,
            layers,
            1_000_000 * arguments.seed,  # the evaluator's episodes have small seeds
            configure(arguments, folder),
            critic_model_config=layers,
            callbacks=[curve],
        )
        experiment.run()
    about = {
        "algorithm": f"{arguments.algorithm.upper()} (examples/ppo_benchmarl.py)",
        "frames": arguments.frames,
        "rewards": curve.rewards,
    }
    actor = experiment.group_policies[GROUP]
    policy = network_of(mean_layers(actor), DecisionProcess(**settings))
    save_policy(policy, arguments.output, about)
    return curve.rewards


def configure(arguments: Arguments, folder: str) -> ExperimentConfig:
    """Return BenchMARL's configuration: no evaluation, no logger, no permanent file."""
    config = ExperimentConfig.get_from_yaml()
    config.max_n_frames, config.max_n_iters = arguments.frames, None
    config.on_policy_n_envs_per_worker = arguments.worlds
    config.on_policy_collected_frames_per_batch = arguments.worlds * arguments.rollout
    config.on_policy_minibatch_size, config.on_policy_n_minibatch_iters = (
        arguments.batch,
        arguments.epochs,
    )
    config.gamma, config.lr, config.clip_grad_val = arguments.discount, arguments.learning_rate, 0.5
    config.evaluation, config.render, config.loggers = False, False, []
    config.create_json, config.save_folder = False, folder
    return config


def mean_layers(actor: nn.Module) -> list[nn.Linear]:
    """Return the layers from the observation to the means, without those of the deviations.

    The actor is one network for all HAVs; its last layer has the means first, then the deviations.
    """
    weights = list(actor.parameters())
    matrices, offsets = ([part for part in weights if part.ndim == axes] for axes in (2, 1))
    layers = []
    for number, (matrix, offset) in enumerate(zip(matrices, offsets, strict=True)):
        kept = 2 if number == len(matrices) - 1 else len(matrix)
        layer = nn.Linear(matrix.shape[1], kept)
        with torch.no_grad():
            layer.weight.copy_(matrix[:kept])
            layer.bias.copy_(offset[:kept])
        layers.append(layer)
    return layers


if __name__ == "__main__":
    rewards = train(tyro.cli(Arguments))
    print(f"mean reward of an action: {np.round(rewards, 3).tolist()}")
