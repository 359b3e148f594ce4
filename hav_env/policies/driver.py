"""This module lets a policy drive HAVs of a batch that other code steps, such as environments."""

import os

import numpy as np

from hav_env.models.protocols import Policy
from hav_env.policies.checks import check_commands, check_policy, is_of_user
from hav_env.policies.demands import bind, check_guided
from hav_env.policies.interface import allocate_memory, decide
from hav_env.policies.names import make_policy
from hav_env.simulator.batch import Batch
from hav_env.world.task import check_at_once


class PolicyDriver:
    """Decides for HAVs of a batch, and keeps the policy's memory."""

    def __init__(
        self, policy: Policy | str | os.PathLike[str], batch: Batch, first: int = 0
    ) -> None:
        """Create the driver of a policy, given as an object or by name with default parameters.

        Args:
            policy: Policy, or its name.
            batch: Worlds whose HAVs the policy drives.
            first: Index of the first HAV that the policy drives. The policy does not act for HAVs
                with a smaller index. Its memory of them stays zero, so other HAVs receive zeros
                from them.

        Raises:
            ValueError, TypeError: If the policy is unknown, it cannot drive these HAVs, or the
                rules let HAVs decide in turn.
        """
        made = make_policy(policy)
        check_at_once(batch.task)
        check_guided(made, batch.guidance)
        check_policy(made, batch.scenario, batch.task, batch.vehicle)
        # bound after the check: rules of a batch are those that compiled code sees
        self.policy = bind(made, batch.task, batch.vehicle)
        self.batch, self.first = batch, first
        self._of_user = is_of_user(made)
        self.memory = allocate_memory(self.policy, batch.scenario.num_havs, batch.num_worlds)

    def decide(self) -> tuple[np.ndarray, np.ndarray]:
        """Return speed [m/s] and steering [rad], (N, W) each.

        They are zero for waiting HAVs and for HAVs that the policy does not drive.

        Raises:
            ValueError: If a number is not finite; the policies of the project return none.
        """
        commands = decide(self.policy, self.memory, self.batch, self.first)
        if self._of_user:
            check_commands(self.policy, commands, self.batch.worlds.state.clock)
        return commands

    def forget(self, worlds: np.ndarray) -> None:
        """Clear the memory in the worlds (W,) that are true, or in those with these indices."""
        places = np.flatnonzero(worlds) if worlds.dtype == np.bool_ else worlds
        self.memory[..., places] = 0.0  # the memory may have one lane more
