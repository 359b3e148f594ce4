"""This module moves chains of trailers along curvatures, and measures their distance from walls.

It serves the search for drives: many candidates at once, in NumPy. The equations are those of
``hav_env.vehicles.steady_circles``, over the path of the truck's rear axle.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.ndimage import distance_transform_edt

from hav_env.places import Site
from hav_env.vehicles import Combination

_CELL = 0.1  # [m] cell of the grid of distances
_BESIDE = 0.4  # [m] largest distance between points of an outline


class Chain(NamedTuple):
    """A vehicle as arrays: lengths and hitches of its units, and points of all outlines."""

    lengths: np.ndarray
    """(U,) [m]."""
    hitches: np.ndarray
    """(U,) distance of each unit's hitch behind the axle ahead [m]."""
    limits: np.ndarray
    """(U - 1,) largest articulations [rad]."""
    along: np.ndarray
    """(Q,) distance of each point ahead of its unit's axle [m]."""
    aside: np.ndarray
    """(Q,) distance of each point to the left [m]."""
    unit: np.ndarray
    """(Q,) index of each point's unit."""
    bodies: np.ndarray
    """(U, 3) half width, and where a body begins and ends ahead of its axle [m]."""


def chain_of(vehicle: Combination) -> Chain:
    """Return a vehicle of the catalogue as arrays."""
    along, aside, owner = [], [], []
    for number, unit in enumerate(vehicle.units):
        ends = -unit.rear, unit.length + unit.front
        length = np.linspace(*ends, math.ceil((ends[1] - ends[0]) / _BESIDE) + 1)
        width = np.linspace(
            -unit.half_width, unit.half_width, math.ceil(2.0 * unit.half_width / _BESIDE) + 1
        )
        for side in (-1.0, 1.0):
            along += [length, np.full(len(width), ends[side > 0.0])]
            aside += [np.full(len(length), side * unit.half_width), width]
        owner.append(np.full(2 * (len(length) + len(width)), number))
    bodies = [[unit.half_width, -unit.rear, unit.length + unit.front] for unit in vehicle.units]
    return Chain(
        np.array(vehicle.lengths),
        np.array(vehicle.offsets),
        np.array(vehicle.limits[1:]),
        np.concatenate(along),
        np.concatenate(aside),
        np.concatenate(owner),
        np.array(bodies),
    )


def advance(chain: Chain, states: np.ndarray, curvature: np.ndarray, way: np.ndarray) -> np.ndarray:
    """Return states (K, 2 + U) after distances (K, 1) [m] on curvatures (K,) [1/m]: midpoints."""
    headings = states[:, 2:]
    middle = headings + 0.5 * way * _rates(chain, headings, curvature)
    after = headings + way * _rates(chain, middle, curvature)
    half = 0.5 * way[:, 0] * curvature
    chord = way[:, 0] * np.sinc(half / math.pi)
    place = states[:, :2] + chord[:, None] * np.stack(
        [np.cos(middle[:, 0]), np.sin(middle[:, 0])], axis=-1
    )
    return np.concatenate([place, after], axis=1)


def _rates(chain: Chain, headings: np.ndarray, curvature: np.ndarray) -> np.ndarray:
    rates = np.empty(headings.shape)
    rates[:, 0], speed = curvature, np.ones(len(headings))
    for unit in range(1, headings.shape[1]):
        bend = headings[:, unit] - headings[:, unit - 1]
        cosine, sine = np.cos(bend), np.sin(bend)
        swing = chain.hitches[unit] * rates[:, unit - 1]
        rates[:, unit] = -(speed * sine + swing * cosine) / chain.lengths[unit]
        speed = speed * cosine - swing * sine
    return rates


def outline_points(chain: Chain, states: np.ndarray) -> np.ndarray:
    """Return points of the outlines of all bodies (K, Q, 2) [m]."""
    axles, direction = _axles_of(chain, states)
    own = direction[:, chain.unit]
    left = np.stack([-own[..., 1], own[..., 0]], axis=-1)
    return axles[:, chain.unit] + chain.along[:, None] * own + chain.aside[:, None] * left


def corner_points(chain: Chain, states: np.ndarray) -> np.ndarray:
    """Return the corners of all bodies (K, U, 4, 2) [m]."""
    axles, ahead = _axles_of(chain, states)
    left = np.stack([-ahead[..., 1], ahead[..., 0]], axis=-1)
    half, rear, front = chain.bodies[:, :1], chain.bodies[:, 1:2], chain.bodies[:, 2:]
    corners = [(rear, -half), (front, -half), (front, half), (rear, half)]
    return np.stack([axles + along * ahead + side * left for along, side in corners], axis=-2)


def _axles_of(chain: Chain, states: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the axles of all units and their directions, both (K, U, 2)."""
    direction = np.stack([np.cos(states[:, 2:]), np.sin(states[:, 2:])], axis=-1)
    axles = np.empty(direction.shape)
    axles[:, 0] = states[:, :2]
    for unit in range(1, len(chain.lengths)):
        hitch = axles[:, unit - 1] - chain.hitches[unit] * direction[:, unit - 1]
        axles[:, unit] = hitch - chain.lengths[unit] * direction[:, unit]
    return axles, direction


class Clearance(NamedTuple):
    """Distances to the nearest segment on a grid."""

    low: np.ndarray
    """(2,) least x and y [m]."""
    distance: np.ndarray
    """(X, Y) [m], float32."""


def clearance_of(site: Site) -> Clearance:
    """Return the distances of positions from the site's segments, accurate to a 0.1 m cell."""
    x0, y0, x1, y1 = site.bounds
    low = np.array([x0, y0]) - 1.0
    shape = np.ceil((np.array([x1, y1]) + 1.0 - low) / _CELL).astype(int) + 1
    free = np.ones(shape, bool)
    for ax, ay, bx, by in site.segment:
        count = math.ceil(math.hypot(bx - ax, by - ay) / (0.5 * _CELL)) + 1
        points = np.stack([np.linspace(ax, bx, count), np.linspace(ay, by, count)], axis=-1)
        free[tuple(np.rint((points - low) / _CELL).astype(int).T)] = False
    return Clearance(low, (distance_transform_edt(free) * _CELL).astype(np.float32))


def clearance_at(field: Clearance, points: np.ndarray) -> np.ndarray:
    """Return the distances [m] at points (..., 2); 0 beyond the grid."""
    cell = np.rint((points - field.low) / _CELL).astype(int)
    inside = ((cell >= 0) & (cell < field.distance.shape)).all(axis=-1)
    cell = np.where(inside[..., None], cell, 0)
    return np.where(inside, field.distance[cell[..., 0], cell[..., 1]], 0.0)
