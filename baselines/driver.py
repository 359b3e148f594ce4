"""A policy at work on a batch that somebody else steps, as environments do."""

from typing import Any

import numpy as np

from baselines.policy import allocate_memory, check_policy, decide
from baselines.registry import find_policy
from hav_env import Batch


class PolicyDriver:
    """Decides for all HAVs of a batch; keeps the policy's memory."""

    def __init__(self, policy: Any, batch: Batch) -> None:
        """Take a policy, or the name of one: then its parameters are the defaults.

        Raises:
            ValueError, TypeError: when there is no such policy, or it cannot drive these HAVs.
        """
        self.policy = find_policy(policy)() if isinstance(policy, str) else policy
        check_policy(self.policy, batch.scenario, batch.task, batch.vehicle)
        self.batch = batch
        self.memory = allocate_memory(self.policy, batch.scenario.num_havs, batch.num_worlds)

    def decide(self) -> tuple[np.ndarray, np.ndarray]:
        """Return speed [m/s] and steering [rad], (N, W) each; zero for HAVs that wait."""
        return decide(self.policy, self.memory, self.batch)

    def forget(self, worlds: np.ndarray) -> None:
        """Begin anew in the worlds (W,) that are true."""
        self.memory[..., worlds] = 0.0
