"""This module makes the worlds and the learner of a training by PPO."""

from typing import Any

import numpy as np
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecNormalize

from hav_env.envs.stable_baselines3 import HAVVecEnv
from train.training_task import settings_of


def make_worlds(arguments: Any) -> HAVVecEnv:
    """Return the worlds to train on.

    Args:
        arguments: The arguments of ``train.ppo``.
    """
    return HAVVecEnv(arguments.worlds, **settings_of(arguments, arguments.threads))


def make_learner(arguments: Any, env: VecNormalize) -> PPO:
    """Return a new learner."""
    return PPO(
        "MlpPolicy",
        env,
        learning_rate=lambda remaining: arguments.learning_rate * remaining,
        n_steps=arguments.rollout_decisions,
        batch_size=arguments.batch_size,
        n_epochs=arguments.epochs,
        gamma=arguments.discount,
        gae_lambda=arguments.gae_lambda,
        clip_range=arguments.clip_range,
        target_kl=arguments.target_divergence,
        ent_coef=arguments.entropy,
        policy_kwargs={
            "net_arch": list(arguments.layers),
            "log_std_init": float(np.log(arguments.deviation)),
        },
        use_sde=arguments.hold_noise > 0,
        sde_sample_freq=max(arguments.hold_noise, 1),
        seed=arguments.seed,
        device="cpu",
    )
