"""This module tries a user's reward as plain Python before compilation."""

from typing import Any

import numpy as np

from hav_env.mdp.reward import BEFORE_SIZE, reward_terms
from hav_env.simulator.trial import attempt, sample_worlds


def try_reward(reward: Any) -> None:
    """Compute the terms of one HAV once; see ``hav_env.simulator.trial.attempt``.

    Args:
        reward: Reward of any registered class.

    Raises:
        ValueError: If the kernel raises or does not write a term; the message names file and line.
    """

    def call() -> str:
        worlds = sample_worlds()
        num_havs, lanes = worlds.state.x.shape
        before = np.zeros((num_havs, BEFORE_SIZE, lanes))
        terms = np.full((len(reward), num_havs, lanes), np.nan)
        reward_terms(reward, 0.2, worlds, 0, before, np.ones((num_havs, lanes)), terms)
        left_out = [
            name
            for name, term in zip(reward._fields, terms, strict=True)
            if not np.isfinite(term[0]).all()
        ]
        return f"does not write the term {left_out[0]!r}" if left_out else ""

    attempt("reward", reward, reward_terms.table[type(reward)], call)
