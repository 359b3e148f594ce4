"""This module reads the outlines that policies reserve from their memory, for recorded episodes."""

from typing import Any

import numpy as np

from baselines.policies.reserve import Reserve
from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import states
from hav_env.compiled import generic
from hav_env.maths.kdop import SIDES, corner
from hav_env.policies.backup import NoBackup
from hav_env.policies.filtered import Filtered


@generic
def reserved_outline(
    policy: Any, memory: np.ndarray, agent: int, lane: int, corners: np.ndarray
) -> bool:
    """Write the corners of the area that a HAV has reserved; return whether there is one.

    Args:
        policy: Parameters; their type selects the kernel.
        memory: (N, K, W) of the policy after a step.
        agent: Index of the HAV.
        lane: Index of the world.
        corners: (24, 2) forward and left of the truck's rear axle [m], written.
    """
    return False


@reserved_outline.otherwise
def _reserve_nothing(policy, memory, agent, lane, corners):
    return False


@reserved_outline.register(Reserve)
def _reserved_by_reserve(policy, memory, agent, lane, corners):
    rows = memory[agent, :, lane]
    if rows[m.MODE] != states.RESERVED:
        return False
    cosine, sine = rows[m.FRAME_AFTER + 2], rows[m.FRAME_AFTER + 3]
    for side in range(SIDES):
        x, y = corner(rows, m.OUTLINE, side)
        corners[side, 0] = rows[m.FRAME_AFTER] + x * cosine - y * sine
        corners[side, 1] = rows[m.FRAME_AFTER + 1] + x * sine + y * cosine
    return True


@reserved_outline.register(Filtered)
def _reserved_by_filtered(policy, memory, agent, lane, corners):
    return _outline_behind(policy.backup, policy, memory, agent, lane, corners)


@generic
def _outline_behind(backup, policy, memory, agent, lane, corners):
    """Write the corners of the area that a filtered policy, or its backup, has reserved."""


@_outline_behind.register(NoBackup)
def _outline_of_policy(backup, policy, memory, agent, lane, corners):
    return reserved_outline(policy.policy, memory, agent, lane, corners)


@_outline_behind.otherwise
def _outline_of_backup(backup, policy, memory, agent, lane, corners):
    # the first rows of the memory are the backup's
    return reserved_outline(backup, memory, agent, lane, corners)
