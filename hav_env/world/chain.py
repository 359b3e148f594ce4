"""This module computes the chain of a HAV: its units one behind the other, from front to rear.

The truck's front end is its front axle, its length ahead of its rear axle. A trailer's front end is
its hitch, and its own axle is its length behind. Trailers are hitched on the axle ahead of them, or
as ``fleet.joints`` states. The simulator calls the kernels. Drawings call ``axles_of``,
``fronts_of`` and ``corners_of``. All of them sum from front to rear.
"""

from typing import Any

import numpy as np

from hav_env.compiled import kernel
from hav_env.world.units.joints import unit_spans
from hav_env.world.units.parts import FRONT, HALF_WIDTH, REAR


@kernel
def front_axle(world, agent, lane):
    """Return the position [m] of the truck's front axle, where the chain begins."""
    length = world.fleet.length[agent, 0, lane]
    return (
        world.state.x[agent, lane] + length * world.state.cosine[agent, 0, lane],
        world.state.y[agent, lane] + length * world.state.sine[agent, 0, lane],
    )


@kernel
def ends_behind(world, agent, unit, lane, x, y):
    """Return where the line of a unit ends and where the next one begins [m].

    They are the same for a HAV whose trailers are hitched on axles. Beyond the last unit, both are
    the given position.

    Args:
        world: Block of worlds.
        agent: Index of the HAV.
        unit: Index of the unit.
        lane: Index of the world.
        x: x of the front end of the unit [m].
        y: y of the front end of the unit [m].

    Returns:
        x and y of the end; x and y of the front end of the unit behind.
    """
    line, following = unit_spans(world.fleet.joints, world.fleet, agent, unit, lane)
    cosine, sine = world.state.cosine[agent, unit, lane], world.state.sine[agent, unit, lane]
    return x - line * cosine, y - line * sine, x - following * cosine, y - following * sine


def axles_of(x, y, heading: np.ndarray, length: np.ndarray, offset: Any = 0.0) -> np.ndarray:
    """Return the positions of the axles of HAVs; on-axle, they are the polygonal chain P_i.

    Args:
        x: (...) x of the truck's rear axle [m].
        y: (...) y of the truck's rear axle [m].
        heading: (..., K) headings of the units [rad], without entries beyond the last unit.
        length: (..., K) lengths of the units [m].
        offset: (..., K) distance from the axle of each unit back to its trailer's hitch [m].

    Returns:
        (..., K + 1, 2) x and y [m]: the truck's front axle, its rear axle, each trailer's axle.
    """
    fronts, direction = _fronts_of(x, y, heading, length, offset)
    behind = fronts - np.asarray(length)[..., None] * direction
    return np.concatenate([fronts[..., :1, :], behind], axis=-2)


def fronts_of(x, y, heading: np.ndarray, length: np.ndarray, offset: Any = 0.0) -> np.ndarray:
    """Return the front ends of units: the truck's front axle, the trailers' hitches.

    Args and shapes are those of ``axles_of``.

    Returns:
        (..., K, 2) x and y [m].
    """
    return _fronts_of(x, y, heading, length, offset)[0]


def corners_of(
    shape: np.ndarray, x, y, heading: np.ndarray, length: np.ndarray, offset: Any = 0.0
) -> np.ndarray:
    """Return the corners of the bodies of units: of the rectangles that collide.

    Args:
        shape: (..., K, 3) columns HALF_WIDTH .. REAR [m].
        x: (...) x of the truck's rear axle [m].
        y: (...) y of the truck's rear axle [m].
        heading: (..., K) headings of the units [rad], without entries beyond the last unit.
        length: (..., K) lengths of the units [m].
        offset: (..., K) distance from the axle of each unit back to its trailer's hitch [m].

    Returns:
        (..., K, 4, 2) x and y [m]: rear right, front right, front left, rear left.
    """
    fronts, direction = _fronts_of(x, y, heading, length, offset)
    ahead, behind = shape[..., FRONT], np.asarray(length) + shape[..., REAR]
    along = np.stack([-behind, ahead, ahead, -behind], axis=-1)[..., None]
    across = shape[..., HALF_WIDTH, None, None] * np.array([-1.0, -1.0, 1.0, 1.0])[:, None]
    left = np.stack([-direction[..., 1], direction[..., 0]], axis=-1)
    return fronts[..., None, :] + along * direction[..., None, :] + across * left[..., None, :]


def _fronts_of(x, y, heading, length, offset) -> tuple[np.ndarray, np.ndarray]:
    """Return the front ends of units, and the directions of their headings, (..., K, 2) each."""
    direction = np.stack([np.cos(heading), np.sin(heading)], axis=-1)
    along = np.asarray(length)[..., None] * direction
    following = (np.asarray(length) + offset)[..., None] * direction
    front = np.stack([x, y], axis=-1) + along[..., 0, :]
    chain = np.concatenate([front[..., None, :], -following[..., :-1, :]], axis=-2)
    return np.cumsum(chain, axis=-2), direction
