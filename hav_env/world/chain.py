"""This module computes the chain of a HAV: its axles, given its pose, headings and lengths.

The truck's front axle is its length ahead of its rear axle. Each trailer is hitched on the axle
ahead of it, and its own axle is its length behind. The simulator calls the kernels, and drawings
call ``axles_of``; both add up from front to rear.
"""

import numpy as np

from hav_env.compiled import kernel


@kernel
def front_axle(world, agent, lane):
    """Return the position [m] of the truck's front axle, where the chain begins."""
    length = world.fleet.length[agent, 0, lane]
    return (
        world.state.x[agent, lane] + length * world.state.cosine[agent, 0, lane],
        world.state.y[agent, lane] + length * world.state.sine[agent, 0, lane],
    )


@kernel
def axle_behind(world, agent, unit, lane, x, y):
    """Return the position [m] of a unit's rear end, given that of its front end.

    They are the same for a unit beyond the HAV's last.
    """
    present = unit <= world.fleet.num_trailers[agent, lane]
    length = world.fleet.length[agent, unit, lane] if present else 0.0
    return (
        x - length * world.state.cosine[agent, unit, lane],
        y - length * world.state.sine[agent, unit, lane],
    )


def axles_of(x, y, heading: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Return where the axles of HAVs are, the polygonal chain P_i.

    Args:
        x: (...) of the truck's rear axle [m].
        y: (...) likewise [m].
        heading: (..., K) of the units [rad], without any beyond the last.
        length: (..., K) of the units [m].

    Returns:
        (..., K + 1, 2) x and y [m]: the truck's front axle, its rear axle, each trailer's axle.
    """
    direction = np.stack([np.cos(heading), np.sin(heading)], axis=-1)
    along = np.asarray(length)[..., None] * direction
    front = np.stack([x, y], axis=-1) + along[..., 0, :]
    return np.cumsum(np.concatenate([front[..., None, :], -along], axis=-2), axis=-2)
