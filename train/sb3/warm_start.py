"""This module begins a training with an earlier one's policy (a warm start).

A policy can thus learn to drive alone first, then in company.
"""

from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecNormalize

from baselines.policies.network import Network, input_names, unpack_layers
from hav_env.mdp.decision_process import DecisionProcess

_SPEED_OUTPUT, _STEERING_OUTPUT = range(2)
_QUIETER = 0.5  # times which steering is explored
_LEAST_VARIANCE = 1e-2  # of a column that is the same in all episodes at first
_TRUSTED = 1e6  # observations that the normalizer is taken to have seen, so that it changes slowly


def start_from(policy: Any, learner: PPO, env: VecNormalize, process: DecisionProcess) -> None:
    """Give a learner the layers and the normalizer of a policy; the value is learned anew.

    Columns that the policy does not observe begin with weights of zero, so that the learner acts
    as the policy does until it learns better, but for its speed, which is full. They are normalized
    by what is seen at the beginning of episodes.

    Raises:
        ValueError: when it was not trained, its layers differ, or it observes what the learner
            does not.
    """
    if not isinstance(policy, Network):
        raise ValueError(f"the policy to begin with is {policy!r}, but must be a trained one")
    theirs, ours = input_names(policy), process.columns
    missing = sorted(set(theirs) - set(ours))
    if missing:
        raise ValueError(f"the policy to begin with observes {missing[0]}, which is not observed")
    places = [ours.index(name) for name in theirs]
    modules = [*learner.policy.mlp_extractor.policy_net, learner.policy.action_net]
    linear = [module for module in modules if isinstance(module, torch.nn.Linear)]
    layers = unpack_layers(policy)
    wanted, found = [m.out_features for m in linear], [len(bias) for _, bias in layers]
    if wanted != found:
        raise ValueError(f"the policy to begin with has layers {found}, but must have {wanted}")
    widened = np.zeros((wanted[0], len(ours)))
    widened[:, places] = layers[0][0]
    layers[0] = widened, layers[0][1]
    with torch.no_grad():
        for module, (weights, biases) in zip(linear, layers, strict=True):
            module.weight.copy_(torch.from_numpy(weights))
            module.bias.copy_(torch.from_numpy(biases))
    # Alone, full speed is always right, and what puts it out is far above 1, where it is cut: no
    # noise would bring it down to where it has an effect. So speed is learned anew; steering, which
    # can be done already, is explored less.
    with torch.no_grad():
        linear[-1].weight[_SPEED_OUTPUT] = 0.0
        linear[-1].bias[_SPEED_OUTPUT] = 1.0
        learner.policy.log_std[..., _STEERING_OUTPUT] += np.log(_QUIETER)
    seen: Any = env.obs_rms
    first: Any = env.venv.reset()
    seen.mean[:] = first.mean(axis=0)
    seen.var[:] = np.maximum(first.var(axis=0), _LEAST_VARIANCE)
    seen.mean[places] = policy.mean
    seen.var[places] = 1.0 / policy.scale**2 - env.epsilon
    seen.count = _TRUSTED
