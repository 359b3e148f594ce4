"""This module reads hitches, limits and bodies of worlds as arrays, whatever a fleet has."""

from typing import Any

import numpy as np

from hav_env.world.units.parts import Hitches, Outlines


def offsets_in(fleet: Any, w: Any) -> np.ndarray:
    """Return how far behind the axle of each unit its trailer is hitched, (N, U) [m].

    Args:
        fleet: of a batch.
        w: which world, or a slice of worlds, which are the last axis then.
    """
    if isinstance(fleet.joints, Hitches):
        return fleet.joints.offset[..., w].copy()
    return np.zeros(fleet.length[..., w].shape)


def limits_in(fleet: Any, w: Any, usual: np.ndarray) -> np.ndarray:
    """Return the limit of the articulation at the front of each unit, (N, U) [rad].

    The truck has none there: its entry is void.

    Args:
        fleet: of a batch.
        w: which world.
        usual: (N,) limits of the HAVs [rad], which count where joints have none of their own.
    """
    if isinstance(fleet.joints, Hitches):
        return fleet.joints.limit[..., w].copy()
    return np.broadcast_to(usual[:, None], fleet.length[..., w].shape).copy()


def shapes_in(fleet: Any, w: Any) -> np.ndarray | None:
    """Return the bodies of units, (N, U, 3) columns HALF_WIDTH .. REAR [m]; None for lines.

    The arguments are those of ``offsets_in``.
    """
    return fleet.bodies.shape[..., w].copy() if isinstance(fleet.bodies, Outlines) else None
