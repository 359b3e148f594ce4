"""This module lets agents of PettingZoo act one after the other (AEC)."""

from typing import Any

import numpy as np
from pettingzoo.utils.conversions import parallel_to_aec_wrapper

from hav_env.mdp.actions import read_action
from hav_env.models.annotations import show


class OneAfterAnother(parallel_to_aec_wrapper):
    """The same environment for agents that act in turn."""

    @property
    def np_random(self) -> np.random.Generator:
        """Return the random generator that draws seeds."""
        return self.unwrapped.np_random

    def step(self, action: Any) -> None:
        """Take the action of the agent whose turn it is; None for an agent that has left.

        Raises:
            TypeError, ValueError: See ``HAVSwarmParallelEnv.step``; raised at the turn of the
                agent.
        """
        agent = self.agent_selection
        if not (self.terminations[agent] or self.truncations[agent]):
            # a copy: the user may write the next action into the same array
            action = read_action(f"the action of {agent}", action, (2,))
        elif action is not None:
            message = f"the action of {agent} is {show(action)}"
            raise ValueError(f"{message}, but must be None: its episode has ended")
        super().step(action)
