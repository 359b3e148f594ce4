"""This module finds collisions with obstacles by brute force, with Shapely."""

import numpy as np
import shapely

from hav_env.world.units.parts import Outlines
from hav_env.world.units.reading import offsets_in

TOGETHER = 3  # steps in a hull


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


def first_touches(worlds, walls, havs) -> np.ndarray:
    """Return which of some HAVs touch any segment: ``touching_walls`` for many worlds.

    Shapely compares the bodies and the segments whose boxes overlap.

    Args:
        worlds: The worlds.
        walls: (S, W) segments, as Shapely has them.
        havs: (K, 2) numbers of the HAVs and of their worlds.
    """
    agent, w = havs.T
    if len(havs) == 0:
        return np.zeros(0, bool)
    bodies = body_shapes(worlds)[agent, :, w]  # (K, U)
    low_x, low_y, high_x, high_y = np.moveaxis(shapely.bounds(bodies)[:, :, None], -1, 0)
    left, low, right, high = np.moveaxis(shapely.bounds(walls.T)[w][:, None], -1, 0)
    # comparisons with the boxes of empty bodies, which are NaN, are false
    near = (low_x <= right) & (left <= high_x) & (low_y <= high) & (low <= high_y)
    hav, unit, segment = np.nonzero(near)
    touches = shapely.intersects(bodies[hav, unit], walls.T[w[hav], segment])
    return np.bincount(hav[touches], minlength=len(havs)) > 0


def corners_of(vehicle, x, y, headings) -> np.ndarray:
    """Return the corners (..., 4, 2) of each body, along the equations of hitches."""
    bodies, place = [], np.stack([x, y], axis=-1)
    for number, unit in enumerate(vehicle.units):
        ahead = np.stack([np.cos(headings[..., number]), np.sin(headings[..., number])], axis=-1)
        if number:
            front = np.stack(
                [np.cos(headings[..., number - 1]), np.sin(headings[..., number - 1])], axis=-1
            )
            place = place - unit.hitch * front - unit.length * ahead
        left = np.stack([-ahead[..., 1], ahead[..., 0]], axis=-1)
        bodies.append(
            np.stack(
                [
                    place + along * ahead + side * unit.half_width * left
                    for along, side in (
                        (-unit.rear, -1.0),
                        (unit.length + unit.front, -1.0),
                        (unit.length + unit.front, 1.0),
                        (-unit.rear, 1.0),
                    )
                ],
                axis=-2,
            )
        )
    return np.stack(bodies, axis=-3)


def hulls_over_time(corners) -> np.ndarray:
    """Return the hulls of bodies (T, ..., 4, 2) over steps, the last one of each in the next."""
    steps = range(0, len(corners) - 1, TOGETHER)
    parts = [corners[k : k + TOGETHER + 1] for k in steps]
    parts[-1] = np.concatenate([parts[-1], parts[-1][-1:].repeat(TOGETHER, 0)])[: TOGETHER + 1]
    points = np.moveaxis(np.stack(parts), 1, -3)  # (hulls, ..., TOGETHER + 1, 4, 2)
    points = points.reshape(-1, (TOGETHER + 1) * 4, 2)
    return shapely.convex_hull(shapely.multipoints(points))


def _pairs(points: np.ndarray) -> np.ndarray:
    """Return complex numbers as pairs of coordinates, on a further axis."""
    return np.stack([points.real, points.imag], axis=-1)
