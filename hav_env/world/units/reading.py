"""This module reads hitches, limits and bodies of worlds as arrays, for every type of fleet."""

from typing import Any

import numpy as np

from hav_env.world.units.parts import Hitches, Outlines


def offsets_in(fleet: Any, w: Any) -> np.ndarray:
    """Return the distance from the axle of each unit back to its trailer's hitch, (N, U) [m].

    Args:
        fleet: Fleet of a batch.
        w: Index of the world, or a slice of worlds, which are then the last axis.
    """
    if isinstance(fleet.joints, Hitches):
        return fleet.joints.offset[..., w].copy()
    return np.zeros(fleet.length[..., w].shape)


def limits_in(fleet: Any, w: Any, usual: np.ndarray) -> np.ndarray:
    """Return the limit of the articulation at the front of each unit, (N, U) [rad].

    The truck has none there: its entry is void.

    Args:
        fleet: Fleet of a batch.
        w: Index of the world.
        usual: (N,) limits of the HAVs [rad], used if joints have none of their own.
    """
    if isinstance(fleet.joints, Hitches):
        return fleet.joints.limit[..., w].copy()
    return np.broadcast_to(usual[:, None], fleet.length[..., w].shape).copy()


def shapes_in(fleet: Any, w: Any) -> np.ndarray | None:
    """Return the bodies of units, (N, U, 3) columns HALF_WIDTH .. REAR [m]; None for lines.

    The arguments are those of ``offsets_in``.
    """
    return fleet.bodies.shape[..., w].copy() if isinstance(fleet.bodies, Outlines) else None
