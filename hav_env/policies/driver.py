"""This module lets a policy drive HAVs of a batch that somebody else steps, as environments do."""

import os

import numpy as np

from hav_env.models.protocols import Policy
from hav_env.policies.interface import allocate_memory, check_policy, decide
from hav_env.policies.names import make_policy
from hav_env.simulator.batch import Batch
from hav_env.world.task import check_at_once


class PolicyDriver:
    """Decides for HAVs of a batch; keeps the policy's memory."""

    def __init__(
        self, policy: Policy | str | os.PathLike[str], batch: Batch, first: int = 0
    ) -> None:
        """Take a policy, or the name of one: then its parameters are the defaults.

        Args:
            policy: a policy, or its name.
            batch: the worlds whose HAVs it drives.
            first: number of the first HAV that it drives. The policy does not act for those before,
                and its memory of them, which others may hear, stays empty.

        Raises:
            ValueError, TypeError: when there is no such policy, or it cannot drive these HAVs,
                or they decide in turn.
        """
        self.policy = make_policy(policy)
        check_at_once(batch.task)
        check_policy(self.policy, batch.scenario, batch.task, batch.vehicle)
        self.batch, self.first = batch, first
        self.memory = allocate_memory(self.policy, batch.scenario.num_havs, batch.num_worlds)

    def decide(self) -> tuple[np.ndarray, np.ndarray]:
        """Return speed [m/s] and steering [rad], (N, W) each.

        They are zero for HAVs that wait and for HAVs that are driven otherwise.
        """
        return decide(self.policy, self.memory, self.batch, self.first)

    def forget(self, worlds: np.ndarray) -> None:
        """Begin anew in the worlds (W,) that are true."""
        self.memory[..., np.flatnonzero(worlds)] = 0.0  # it may have a lane more
