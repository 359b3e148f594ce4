"""This module normalizes observations and rewards by running means and variances."""

import numpy as np
import torch

from train.loops.networks import Row

CLIPPED = 10.0  # largest absolute value of a normalized observation
_LEAST_VARIANCE = 1e-4  # so no column is scaled by more than 100
_TINY = 1e-8


class Moments:
    """Mean and variance of columns, of all rows so far (Chan et al. 1979)."""

    def __init__(self, columns: int) -> None:
        """Begin with a mean of 0 and a variance of 1, which count nothing."""
        self.mean, self.variance, self.count = np.zeros(columns), np.ones(columns), 0.0

    def update(self, rows: np.ndarray) -> None:
        """Include rows (B, columns)."""
        if not len(rows):
            return
        mean, variance, count = rows.mean(0, np.float64), rows.var(0, np.float64), len(rows)
        total = self.count + count
        apart = mean - self.mean
        sums = self.variance * self.count + variance * count
        self.variance = (sums + apart**2 * self.count * count / total) / total
        self.mean = self.mean + apart * count / total
        self.count = total


class Normalizer:
    """Normalization of observations; pooled neighbours share their mean and variance.

    Those of a neighbour are over present neighbours, and ``present`` itself is not normalized.
    """

    def __init__(self, row: Row, pooled: bool) -> None:
        """Begin without observations.

        Args:
            row: Layout of an observation.
            pooled: Whether the network pools the neighbours.
        """
        self.row, self.pooled = row, pooled and row.neighbors > 0
        self.own = Moments(row.own + (0 if self.pooled else row.neighbors * row.each))
        self.each = Moments(row.each)

    def update(self, rows: torch.Tensor) -> None:
        """Include observations (B, D)."""
        array = rows.numpy()
        self.own.update(array[:, : len(self.own.mean)])
        if self.pooled:
            others = array[:, self.row.own :].reshape(-1, self.row.each)
            self.each.update(others[others[:, 0] > 0.0])
            self.each.mean[0], self.each.variance[0] = 0.0, 1.0

    @property
    def mean(self) -> np.ndarray:
        """Return the mean of each column (D,)."""
        return self._join(self.own.mean, self.each.mean)

    @property
    def variance(self) -> np.ndarray:
        """Return the variance of each column (D,), with its lower bound."""
        found = self._join(self.own.variance, self.each.variance)
        return np.maximum(found, _LEAST_VARIANCE)

    def __call__(self, rows: torch.Tensor) -> torch.Tensor:
        """Return normalized and clipped observations (B, D) float32."""
        mean, scale = (
            torch.from_numpy(numbers.astype(np.float32))
            for numbers in (self.mean, self.variance**-0.5)
        )
        return (rows - mean).mul_(scale).clamp_(-CLIPPED, CLIPPED)

    def _join(self, own: np.ndarray, each: np.ndarray) -> np.ndarray:
        return np.concatenate([own, np.tile(each, self.row.neighbors)]) if self.pooled else own


class RewardScale:
    """Rewards over the standard deviation of discounted returns, clipped."""

    def __init__(self, rows: int, discount: float, limit: float) -> None:
        """Begin without rewards.

        Args:
            rows: Number R of HAVs in all worlds.
            discount: For each action.
            limit: Largest absolute value of a scaled reward.
        """
        self._returns, self._moments = torch.zeros(rows), Moments(1)
        self._discount, self._limit = discount, limit

    def __call__(self, rewards: torch.Tensor, ended: torch.Tensor) -> torch.Tensor:
        """Include the rewards of a rollout (T, R), and return them scaled.

        Args:
            rewards: (T, R) rewards of actions.
            ended: (T, R) bool: the episode ended with the action.
        """
        returns = torch.empty_like(rewards)
        for t, reward in enumerate(rewards):
            self._returns = self._returns * self._discount + reward
            returns[t] = self._returns
            self._returns = self._returns * ~ended[t]
        self._moments.update(returns.numpy().reshape(-1, 1))
        deviation = float(np.sqrt(self._moments.variance[0] + _TINY))
        return (rewards / deviation).clamp_(-self._limit, self._limit)
