"""This module states the task of a backup: it drives where the proposals of a policy are unsafe."""

import functools
from typing import Any, NamedTuple

import numpy as np

from hav_env.compiled import generic
from hav_env.models.protocols import Scenario
from hav_env.world.arrays import World


class NoBackup(NamedTuple):
    """No backup: proposals are executed, after the safety filter if there is one."""


@generic
def backup_rows(backup: Any) -> int:
    """Return the number of rows of a HAV's memory that the backup needs. They come first."""
    return 0


@generic
def back_up(
    backup: Any,
    memory: np.ndarray,
    world: World,
    agent: int,
    lane: int,
    speed: float,
    steering: float,
) -> tuple[bool, float, float]:
    """Take a proposal, or drive instead.

    A policy that can be a backup registers this function and ``backup_rows``. Its memory and its
    broadcast are those that it has as a policy.

    Args:
        backup: Parameters of the backup; their type selects the kernel.
        memory: (N, K, W); the first rows of ``memory[agent, :, lane]`` are the backup's.
        world: Block of worlds; read it only through ``hav_env.world.sensing``.
        agent: Index of the HAV.
        lane: Index of the world in the block.
        speed: Proposed speed [m/s].
        steering: Proposed steering angle [rad].

    Returns:
        Whether the proposal was taken; speed [m/s] and steering [rad] to execute.
    """
    raise NotImplementedError


@functools.singledispatch
def check_backup(backup: Any, scenario: Scenario) -> None:
    """Check a policy that is to be a backup, and has passed ``check_policy``, for a scenario.

    Raises:
        ValueError: If it cannot be one with these parameters or there; the message says why.
    """
