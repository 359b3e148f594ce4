"""This module finds collisions with obstacles by brute force, with Shapely."""

import numpy as np
import shapely

from hav_env.world.units.parts import Outlines
from hav_env.world.units.reading import offsets_in


def unit_shapes(x, y, heading, length, offset, shape=None) -> np.ndarray:
    """Return the bodies of units (..., K) as Shapely has them, straight from the definitions.

    Args:
        x: (...) of the truck's rear axle [m].
        y: (...) likewise [m].
        heading: (..., K) of the units [rad].
        length: (..., K) [m].
        offset: (..., K) how far behind the axle of each unit its trailer is hitched [m].
        shape: (..., K, 3) half width, front and rear overhang [m]; None for lines.
    """
    along = np.exp(1j * heading)
    front = (x + 1j * y)[..., None] + length[..., :1] * along[..., :1]
    behind = np.cumsum((length + offset) * along, axis=-1)
    fronts = np.concatenate([front, front - behind[..., :-1]], axis=-1)
    if shape is None:
        ends = [fronts, fronts - (length + np.maximum(offset, 0.0)) * along]
        return shapely.linestrings(_pairs(np.stack(ends, axis=-1)))
    half, ahead, rear = np.moveaxis(shape, -1, 0)
    corners = [
        fronts + (a + side * 1j * half) * along
        for a, side in ((ahead, 1), (ahead, -1), (-length - rear, -1), (-length - rear, 1))
    ]
    return shapely.polygons(_pairs(np.stack(corners, axis=-1)))


def body_shapes(worlds) -> np.ndarray:
    """Return the bodies of all units (N, U, W); units beyond a HAV's last are empty."""
    state, fleet = worlds.state, worlds.fleet
    present = np.arange(state.heading.shape[1])[:, None] <= fleet.num_trailers[:, None]
    units = [
        np.moveaxis(part, 1, 2)  # (N, W, U)
        for part in (
            state.heading,
            np.where(present, fleet.length, 1.0),
            np.where(present, offsets_in(fleet, slice(None)), 0.0),
        )
    ]
    wide = isinstance(fleet.bodies, Outlines)
    shape = np.moveaxis(fleet.bodies.shape, 3, 1) if wide else None  # (N, W, U, 3)
    shapes = np.moveaxis(unit_shapes(state.x, state.y, *units, shape), 2, 1)
    return np.where(present, shapes, shapely.Point())


def wall_shapes(worlds) -> np.ndarray:
    """Return the segments (S, W) of worlds with as many each, as Shapely has them."""
    x, y, cosine, sine, half = np.moveaxis(worlds.place.segment, 1, 0)
    ends = [x + 1j * y + side * half * (cosine + 1j * sine) for side in (-1, 1)]
    return shapely.linestrings(_pairs(np.stack(ends, axis=-1)))


def gaps_to_walls(worlds) -> np.ndarray:
    """Return the distances [m] of HAVs from segments (N, S, W)."""
    bodies, walls = body_shapes(worlds), wall_shapes(worlds)
    gaps = shapely.distance(bodies[:, :, None], walls[None, None])  # NaN for empty bodies
    return np.nanmin(gaps, axis=1)


def touching_walls(worlds) -> np.ndarray:
    """Return which HAVs touch which segments (N, S, W)."""
    bodies, walls = body_shapes(worlds), wall_shapes(worlds)
    return shapely.intersects(bodies[:, :, None], walls[None, None]).any(axis=1)


def _pairs(points: np.ndarray) -> np.ndarray:
    """Return complex numbers as pairs of coordinates, on a further axis."""
    return np.stack([points.real, points.imag], axis=-1)
