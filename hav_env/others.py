"""Who drives the HAVs that no learner controls: the one place that asks for a policy by name."""

import importlib
from typing import Any, Protocol

import numpy as np

from hav_env.batch import Batch


class Driver(Protocol):
    """A policy at work on a batch."""

    def decide(self) -> tuple[np.ndarray, np.ndarray]:
        """Return speed [m/s] and steering [rad] of all HAVs, (N, W) each."""

    def forget(self, worlds: np.ndarray) -> None:
        """Begin anew in the worlds (W,) that are true."""


def driver_of(policy: Any, batch: Batch, first: int) -> Driver:
    """Return a policy, or the one of a name ("avoid_jack"), at work on the HAVs from a number on.

    The simulator knows no policy: only when one is asked for are the baselines imported.

    Raises:
        ValueError, TypeError: when there is no such policy.
    """
    return importlib.import_module("baselines.driver").PolicyDriver(policy, batch, first)
