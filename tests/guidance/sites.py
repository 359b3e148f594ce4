"""This module has sites with walls for tests of guidance, and a truck that drives arcs in NumPy."""

import itertools
import math

import numpy as np
import shapely

HEADINGS = 24


def walled_site(size, num_walls, seed):
    """Return the segments (S, 4) of a square yard [m] with some walls in it."""
    rng = np.random.default_rng(seed)
    corners = [(0, 0), (size, 0), (size, size), (0, size), (0, 0)]
    sides = [[*a, *b] for a, b in itertools.pairwise(corners)]
    starts = rng.uniform(0.15 * size, 0.85 * size, (num_walls, 2))
    walls = np.hstack([starts, starts + rng.uniform(-0.2 * size, 0.2 * size, (num_walls, 2))])
    return np.vstack([np.array(sides, float), walls])


def lines_of(segments):
    """Return segments for Shapely."""
    return shapely.multilinestrings(list(segments.reshape(-1, 2, 2)))


def drive(pose, side, radius, length):
    """Return the pose after an arc or a straight; arrays of lengths give arrays."""
    x, y, heading = pose
    if side == 0.0:
        return x + length * np.cos(heading), y + length * np.sin(heading), heading + 0.0 * length
    centre = x + 1j * y + 1j * side * radius * np.exp(1j * heading)
    after = heading + side * length / radius
    place = centre - 1j * side * radius * np.exp(1j * after)
    return place.real, place.imag, after


def trace(pose, side, radius, length):
    """Return an arc as a line of Shapely, whose chords leave it by less than 1e-4 m."""
    at = np.linspace(0.0, length, 2 + int(length / math.sqrt(8e-4 * radius)))
    x, y, _ = drive(pose, side, radius, at)
    return shapely.LineString(np.column_stack([x, y]))


def turned(one, other):
    """Return by how much two headings differ [rad]."""
    return abs((one - other + math.pi) % (2.0 * math.pi) - math.pi)
