"""This module keeps lattices on disk.

The name of a file is the SHA-256 of all inputs of its table: walls, goal, radius, bounds, lattice,
and the code of the search.
"""

import functools
import pathlib
from collections.abc import Sequence

import numpy as np

from hav_env.compiled import digest_code
from hav_env.guidance.array_files import digest_numbers, file_of, keep_arrays, read_arrays
from hav_env.guidance.lattice import (
    Lattice,
    LatticeTable,
    check_arguments,
    search,
    table_of,
)
from hav_env.guidance.search import find_direct, spread_backwards
from hav_env.guidance.walls import Grid

_FOLDER = "lattices"
_ARRAYS = ("length", "side", "steps", "offset", "goal")
_SCALARS = "scalars"


def load_lengths(
    lattice: Lattice,
    segments: np.ndarray,
    goal: tuple[float, float, float],
    radius: float,
    bounds: tuple[float, float, float, float] | None = None,
) -> LatticeTable:
    """Return the table of ``find_lengths``; load it from disk, or compute it and keep it there.

    Args:
        lattice: Sizes of cells, clearance.
        segments: (S, 4) Walls, x1, y1, x2, y2 [m].
        goal: x, y [m] and heading [rad].
        radius: Turning radius [m].
        bounds: As in ``find_lengths``.

    Raises:
        TypeError: If an argument has another type.
        ValueError: If an argument is out of range.
    """
    known = check_arguments(lattice, segments, goal, radius, bounds)
    path = _path_of(lattice, *known)
    found = read_arrays(path, (*_ARRAYS, _SCALARS))
    if found is not None:
        radius, *grid = found.pop(_SCALARS).tolist()
        return LatticeTable(**found, radius=radius, grid=Grid(*grid))
    table = table_of(lattice, *search(lattice, *known))
    arrays = {name: getattr(table, name) for name in _ARRAYS}
    keep_arrays(path, {**arrays, _SCALARS: np.array([table.radius, *table.grid])})
    return table


def are_kept(
    lattice: Lattice,
    segments: np.ndarray,
    wanted: Sequence[tuple[tuple[float, float, float], float]],
    bounds: tuple[float, float, float, float],
) -> int:
    """Return the number of tables on disk among those of the given goals and radii [m].

    The other arguments are those of ``load_lengths``.
    """
    found = 0
    for goal, radius in wanted:
        path = _path_of(lattice, *check_arguments(lattice, segments, goal, radius, bounds))
        found += path is not None and path.exists()
    return found


def _path_of(
    lattice: Lattice,
    segments: np.ndarray,
    goal: np.ndarray,
    radius: float,
    bounds: tuple[float, float, float, float],
) -> pathlib.Path | None:
    """Return the path of the file of a table, None if no folder is usable."""
    key = digest_numbers(_digest_search(), (*lattice, *goal, radius, *bounds), (segments,))
    return file_of(_FOLDER, key)


@functools.cache
def _digest_search() -> str:
    """Return the digest of the code of the search."""
    return digest_code([search, table_of, find_direct, spread_backwards]).digest
