"""This module finds collisions with obstacles by brute force, with Shapely."""

import numpy as np
import shapely

from hav_env.world.units.parts import Outlines
from hav_env.world.units.reading import offsets_in


def body_shapes(worlds) -> np.ndarray:
    """Return the bodies of all units (N, U, W) as Shapely has them, straight from the definitions.

    Units beyond a HAV's last are empty.
    """
    state, fleet = worlds.state, worlds.fleet
    present = np.arange(state.heading.shape[1])[:, None] <= fleet.num_trailers[:, None]
    length = np.where(present, fleet.length, 1.0)  # (N, U, W)
    offset = np.where(present, offsets_in(fleet, slice(None)), 0.0)
    along = np.exp(1j * state.heading)
    front = (state.x + 1j * state.y)[:, None] + length[:, :1] * along[:, :1]
    behind = np.cumsum((length + offset) * along, axis=1)
    fronts = np.concatenate([front, front - behind[:, :-1]], axis=1)
    if isinstance(fleet.bodies, Outlines):
        half, ahead, rear = np.moveaxis(fleet.bodies.shape, 2, 0)
        corners = [
            fronts + (a + side * 1j * half) * along
            for a, side in ((ahead, 1), (ahead, -1), (-length - rear, -1), (-length - rear, 1))
        ]
        shapes = shapely.polygons(_pairs(np.stack(corners, axis=-1)))
    else:
        ends = [fronts, fronts - (length + np.maximum(offset, 0.0)) * along]
        shapes = shapely.linestrings(_pairs(np.stack(ends, axis=-1)))
    return np.where(present, shapes, shapely.Point())


def wall_shapes(worlds) -> np.ndarray:
    """Return the segments (S, W) of worlds with as many each, as Shapely has them."""
    x, y, cosine, sine, half = np.moveaxis(worlds.place.segment, 1, 0)
    ends = [x + 1j * y + side * half * (cosine + 1j * sine) for side in (-1, 1)]
    return shapely.linestrings(_pairs(np.stack(ends, axis=-1)))


def gaps_to_walls(worlds) -> np.ndarray:
    """Return the distances [m] of HAVs from segments (N, S, W)."""
    bodies, walls = body_shapes(worlds), wall_shapes(worlds)
    gaps = shapely.distance(bodies[:, :, None], walls[None, None])  # NaN for what is empty
    return np.nanmin(gaps, axis=1)


def touching_walls(worlds) -> np.ndarray:
    """Tell which HAVs touch which segments (N, S, W)."""
    bodies, walls = body_shapes(worlds), wall_shapes(worlds)
    return shapely.intersects(bodies[:, :, None], walls[None, None]).any(axis=1)


def _pairs(points: np.ndarray) -> np.ndarray:
    """Return complex numbers as pairs of coordinates, on a further axis."""
    return np.stack([points.real, points.imag], axis=-1)
