"""This module initializes a learner with a trained policy (a warm start).

A policy can thus learn to drive alone first, and then among other HAVs.
"""

from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.vec_env import VecNormalize

from baselines.policies.network import Network, input_names, unpack_layers
from baselines.policies.pooling import Encoder
from hav_env.mdp.decision_process import DecisionProcess
from train.loops.starts import (
    ALONG_ROUTE,
    LEAST_AT_START,
    TRUSTED,
    begin_anew_with_speed,
    copy_layers,
    quieten_steering,
    steer_along_route,
)

__all__ = ["ALONG_ROUTE", "start_from", "start_on_route"]


def start_from(policy: Any, learner: PPO, env: VecNormalize, process: DecisionProcess) -> None:
    """Copy the layers and the normalizer of a policy into a learner, but not the value network.

    Columns that the policy does not observe start with weights of zero. So the learner first acts
    like the policy, but at full speed. The starts of episodes normalize these columns.

    Raises:
        ValueError: If the policy was not trained, its layers differ, or it observes columns that
            the learner does not.
    """
    if not isinstance(policy, Network):
        raise ValueError(f"the policy to begin with is {policy!r}, but must be a trained one")
    theirs, ours = input_names(policy), process.columns
    missing = sorted(set(theirs) - set(ours))
    if missing:
        raise ValueError(f"the policy to begin with observes {missing[0]}, which is not observed")
    places = [ours.index(name) for name in theirs]
    if isinstance(policy.pooling, Encoder):
        raise ValueError("the policy to begin with pools neighbours: use train.ippo or train.mappo")
    layers = _layers_of(learner)
    copy_layers(layers, unpack_layers(policy), places)
    # the policy can steer already
    begin_anew_with_speed(layers[-1])
    quieten_steering(learner.policy.log_std)
    seen = _see_beginnings(env)
    seen.mean[places] = policy.mean
    seen.var[places] = 1.0 / policy.scale**2 - env.epsilon


def start_on_route(learner: PPO, env: VecNormalize, process: DecisionProcess, speed: float) -> None:
    """Initialize a learner with weights that drive at one speed and steer along the route.

    One unit of each hidden layer passes on the column ``goal_path_steering``. The other units and
    the value network keep their random weights.

    Args:
        learner: Learner whose policy network changes.
        env: Worlds of the learner; their normalizer changes.
        process: Decision process of the worlds.
        speed: Share of the full speed, from 0 to 1.
    """
    place = process.columns.index("goal_path_steering")
    steer_along_route(_layers_of(learner), place, speed)
    quieten_steering(learner.policy.log_std)
    seen = _see_beginnings(env)
    seen.mean[place], seen.var[place] = 0.0, 1.0


def _layers_of(learner: PPO) -> list[torch.nn.Linear]:
    """Return the layers from the observation to the means of both actions."""
    modules = [*learner.policy.mlp_extractor.policy_net, learner.policy.action_net]
    return [module for module in modules if isinstance(module, torch.nn.Linear)]


def let_policy_learn(policy: ActorCriticPolicy, learns: bool) -> None:
    """Let the layers and the noise of a policy learn, or only its value network.

    Args:
        policy: Policy of the learner.
        learns: Whether the policy learns.
    """
    policy.mlp_extractor.policy_net.requires_grad_(learns)
    policy.action_net.requires_grad_(learns)
    policy.log_std.requires_grad_(learns)


def _see_beginnings(env: VecNormalize) -> Any:
    """Normalize columns by the observations at the starts of episodes; return the statistics."""
    seen: Any = env.obs_rms
    first: Any = env.venv.reset()
    seen.mean[:] = first.mean(axis=0)
    seen.var[:] = np.maximum(first.var(axis=0), LEAST_AT_START)
    seen.count = TRUSTED
    return seen
