"""This module steps all worlds of a training together, as arrays with a row for each HAV."""

from typing import NamedTuple

import numpy as np
import torch

from hav_env.maths.random_numbers import SEED_LIMIT
from hav_env.mdp.buffers import Outcome
from hav_env.mdp.central_state import CentralState
from hav_env.mdp.decision_process import DecisionProcess
from train.loops.arguments import LoopArguments
from train.loops.networks import Row
from train.scores import TRAINING
from train.training_task import settings_of


class Step(NamedTuple):
    """Result of an action in W worlds of N HAVs; row w N + k of R is HAV k of world w."""

    reward: torch.Tensor
    """(R,) float32."""
    ended: torch.Tensor
    """(R,) bool: the episode ended, and the next one has begun."""
    cut: np.ndarray
    """(M,) worlds whose episodes were truncated: they have a future."""
    last: torch.Tensor
    """(M N, D) their last observations."""
    last_states: torch.Tensor
    """(M, S) their last states."""


class Worlds:
    """W worlds of N HAVs, which begin the next episode in the step in which one ends.

    Attributes:
        process: The decision process.
        seen: (R, D) the present observations.
        row: Layout of an observation.
        havs: Number N of HAVs of a world.
    """

    def __init__(self, arguments: LoopArguments) -> None:
        """Build the worlds, and begin their first episodes.

        Args:
            arguments: The arguments of ``train.ippo`` or ``train.mappo``.
        """
        settings = settings_of(arguments, arguments.threads)
        self.process = process = DecisionProcess(arguments.worlds, **settings)
        self.havs, self._central = process.num_havs, CentralState(process.batch)
        neighbors, total = process.observation.neighbors, len(process.columns)
        each = sum(name.startswith("neighbor_0_") for name in process.columns)
        self.row = Row(total - neighbors * each, neighbors, each)
        rows = arguments.worlds * self.havs  # trainings with different seeds share no episodes
        first = (TRAINING + arguments.seed * rows) % (SEED_LIMIT - rows)
        self._seeds = first + np.arange(arguments.worlds) * self.havs
        self._episodes = np.zeros(arguments.worlds, np.int64)
        self._reports: list[np.ndarray] = []
        outcome = process.outcome()
        self._begin(np.ones(arguments.worlds, np.bool_), outcome)

    def states(self) -> torch.Tensor:
        """Return the states of the worlds (W, S), for a central critic."""
        return torch.from_numpy(self._central.read_worlds())

    @property
    def state_size(self) -> int:
        """Return the number S of entries of a state."""
        return len(self._central.names)

    def waits(self) -> torch.Tensor:
        """Return which HAVs wait, (R,) bool: their actions have no effect."""
        return self.seen[:, self.process.columns.index("waits")] > 0.0

    def step(self, actions: torch.Tensor, central: bool = False) -> Step:
        """Take an action of every HAV.

        Args:
            actions: (R, 2) speed and steering; the process clips them to [-1, 1].
            central: Whether to return the last states of truncated worlds; otherwise there are
                none of them (M = 0).

        Raises:
            ValueError: If an action is not finite: the training has diverged.
        """
        if not actions.isfinite().all():
            raise ValueError("the training has diverged: try a smaller --learning-rate")
        shape = len(self._seeds), self.havs, 2
        outcome = self.process.step(actions.numpy().reshape(shape))
        reward = torch.from_numpy(outcome.reward.T.astype(np.float32).ravel())
        over = outcome.terminated | outcome.truncated
        cut = np.flatnonzero(outcome.truncated & ~outcome.terminated)
        last = torch.from_numpy(outcome.observation[cut].reshape(-1, self.seen.shape[1]))
        states = self._central.read_worlds()[cut] if central and cut.size else np.zeros((0, 0))
        if over.any():
            self._reports.append(outcome.info[:, :, over].reshape(len(outcome.info), -1))
            self._episodes += over
            self._begin(over, outcome)
        else:
            self._look(outcome)
        ended = torch.from_numpy(np.repeat(over, self.havs))
        return Step(reward, ended, cut, last, torch.from_numpy(states))

    def take_means(self) -> dict[str, float]:
        """Return the mean info over the HAVs whose episodes ended since the last call, by name."""
        reports, self._reports = self._reports, []
        if not reports:
            return {}
        means = np.concatenate(reports, axis=1).mean(axis=1).tolist()
        return dict(zip(self.process.info, means, strict=True))

    def _begin(self, chosen: np.ndarray, outcome: Outcome) -> None:
        self.process.begin(self._seeds, self._episodes, chosen, outcome)
        self._look(outcome)

    def _look(self, outcome: Outcome) -> None:
        rows = outcome.observation.reshape(len(self._seeds) * self.havs, -1)
        self.seen = torch.from_numpy(rows)
