"""This module configures RLlib: the swarm as its environment, the network, the settings of PPO."""

import dataclasses
from typing import Any

import numpy as np
import torch

from hav_env import parallel_env
from train.rllib.arguments import Arguments
from train.scores import TRAINING

try:
    from ray.rllib.algorithms.ppo import PPOConfig
    from ray.rllib.algorithms.ppo.torch.default_ppo_torch_rl_module import DefaultPPOTorchRLModule
    from ray.rllib.core.rl_module.default_model_config import DefaultModelConfig
    from ray.rllib.core.rl_module.rl_module import RLModuleSpec
    from ray.rllib.env.multi_agent_env import MultiAgentEnv
except ImportError as error:
    message = f"train.rllib needs Ray's RLlib ({error}): run pip install -e '.[ray]' in the clone"
    raise ImportError(message) from None

SHARED = "hav"  # the name of the one policy


class HAVMultiAgentEnv(MultiAgentEnv):
    """``hav_env.parallel_env`` as an environment of RLlib's new API stack.

    Ray's own wrapper does not suffice. This class scales the reward, lets a curriculum change it,
    keeps infos out of the samples, and never gives two worlds the same episodes.
    """

    def __init__(self, config: Any) -> None:
        """Build the environment.

        Args:
            config: RLlib's configuration. ``settings``: arguments of ``hav_env.parallel_env``;
                ``worlds``: number of worlds in each process; ``reward_scale``: factor of rewards.

        Raises:
            ValueError, TypeError: If an argument is invalid; the message names it, its value and
                the rule.
        """
        super().__init__()
        self._swarm = parallel_env(**config["settings"])
        self._apart = config["worlds"] * getattr(config, "worker_index", 0)
        self._scale = config["reward_scale"]
        self.possible_agents = list(self._swarm.possible_agents)
        self.agents = list(self.possible_agents)
        self.observation_spaces = self._swarm.observation_spaces
        self.action_spaces = self._swarm.action_spaces

    def reset(
        self, *, seed: int | None = None, options: dict | None = None
    ) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
        """Begin an episode.

        RLlib gives consecutive seeds to the worlds of one process. The seeds of the next process
        begin one later, so this method adds an offset for each process.
        """
        seed = None if seed is None else seed + self._apart
        observations, _ = self._swarm.reset(seed, options)
        self.agents = list(self.possible_agents)
        return observations, {}

    def step(self, action_dict: dict[str, np.ndarray]) -> tuple[dict, dict, dict, dict, dict]:
        """Take one action of every agent."""
        observations, rewards, ends, cuts, _ = self._swarm.step(action_dict)
        self.agents = list(self._swarm.agents)
        over = not self.agents
        scaled = {agent: self._scale * reward for agent, reward in rewards.items()}
        ends["__all__"] = over and all(ends.values())
        cuts["__all__"] = over and not ends["__all__"]
        return observations, scaled, ends, cuts, {}

    def set_reward(self, reward: Any) -> None:
        """Change the weights of the reward from the next action on."""
        self._swarm._world.process.set_reward(reward)


class HAVModule(DefaultPPOTorchRLModule):
    """RLlib's own network, initialized with actions near zero and a given standard deviation.

    ``model_config`` is the dictionary of RLlib's model configuration, with ``deviation``.
    """

    def setup(self) -> None:
        """Build the network."""
        deviation = self.model_config["deviation"]
        super().setup()
        with torch.no_grad():
            layers_of(self.pi)[-1].weight.mul_(0.01)
            self.pi.log_std.fill_(float(np.log(deviation)))


def layers_of(*modules: torch.nn.Module) -> list[torch.nn.Linear]:
    """Return the linear layers of consecutive modules."""
    found = [part for module in modules for part in module.modules()]
    return [layer for layer in found if isinstance(layer, torch.nn.Linear)]


def mean_layers(module: Any) -> list[torch.nn.Linear]:
    """Return the layers of an RLlib PPO module from the observation to the means of both actions.

    The last layer of RLlib's default also has outputs for the logarithms of the standard
    deviations, behind the means. This function drops them.
    """
    *hidden, last = layers_of(module.encoder.actor_encoder, module.pi)
    means = torch.nn.Linear(last.in_features, 2)
    means.load_state_dict({"weight": last.weight[:2], "bias": last.bias[:2]})
    return [*hidden, means]


def configure(arguments: Arguments, settings: dict[str, Any], num_havs: int) -> PPOConfig:
    """Return RLlib's configuration, with the same losses of PPO as Stable-Baselines3."""
    processes = max(arguments.runners, 1)
    network = DefaultModelConfig(
        fcnet_hiddens=list(arguments.layers),
        fcnet_activation="tanh",
        free_log_std=True,
        vf_share_layers=False,
    )
    model = dataclasses.asdict(network) | {"deviation": arguments.deviation}
    return (
        PPOConfig()
        .environment(
            HAVMultiAgentEnv,
            env_config={
                "settings": settings,
                "worlds": arguments.worlds,
                "reward_scale": arguments.reward_scale,
            },
        )
        .env_runners(
            num_env_runners=arguments.runners,
            num_envs_per_env_runner=arguments.worlds,
            rollout_fragment_length=arguments.rollout_decisions,
        )
        .training(
            train_batch_size_per_learner=processes * arguments.worlds * arguments.rollout_decisions,
            minibatch_size=arguments.batch_size,
            num_epochs=arguments.epochs,
            # RLlib counts steps of worlds; in each of them every HAV acts once
            lr=[[0, arguments.learning_rate], [arguments.decisions // num_havs, 0.0]],
            gamma=arguments.discount,
            lambda_=arguments.gae_lambda,
            clip_param=arguments.clip_range,
            entropy_coeff=arguments.entropy,
            use_kl_loss=False,
            vf_loss_coeff=0.5,
            vf_clip_param=np.inf,
            grad_clip=0.5,
            grad_clip_by="global_norm",
        )
        .multi_agent(policies={SHARED}, policy_mapping_fn=_to_shared)
        .rl_module(rl_module_spec=RLModuleSpec(module_class=HAVModule, model_config=model))
        # trainings with different seeds share no episodes, in any process
        .debugging(
            seed=TRAINING + arguments.seed * (processes + 1) * (arguments.worlds + 1),
            log_level="ERROR",
        )
    )


def _to_shared(agent: str, episode: Any, **more: Any) -> str:
    return SHARED
