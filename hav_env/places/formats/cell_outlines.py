"""This module traces the outlines of the occupied cells of a grid."""

import numpy as np

from hav_env.places.libraries import import_maps

_MOST_RUNS = 400_000  # straight pieces of outlines; Shapely takes seconds for 100,000


def trace_cells(occupied: np.ndarray) -> list[np.ndarray]:
    """Return the outlines of occupied cells.

    Chains end where four edges meet, at cells that touch at a corner. All others are rings. A place
    is in an occupied cell if a ray from it crosses the chains an odd number of times.

    Args:
        occupied: (H, W) bool, the lowest row first.

    Returns:
        Chains of corners (P, 2), x and y in cells; none is closed and begins where four edges meet.

    Raises:
        ImportError: without the extra ``maps``.
        ValueError: when the outlines are too ragged.
    """
    shapely = import_maps("shapely")
    grid = np.pad(occupied, 1)
    low, high = grid[:-1], grid[1:]
    diagonal = (low[:, :-1] == high[:, 1:]) & (low[:, 1:] == high[:, :-1])
    crossing = diagonal & (low[:, :-1] != low[:, 1:])  # (H + 1, W + 1): of the corners of cells
    level = _runs((low != high)[:, 1:-1], crossing)
    upright = _runs((grid[:, :-1] != grid[:, 1:])[1:-1].T, crossing.T)[..., ::-1]
    runs = np.concatenate([level, upright])
    if len(runs) == 0:
        return []
    if len(runs) > _MOST_RUNS:
        told = f"the outlines of the occupied cells have {len(runs)} straight pieces"
        raise ValueError(f"{told}, but must have at most {_MOST_RUNS}")
    merged = shapely.get_parts(shapely.line_merge(shapely.MultiLineString(list(runs))))
    found: list[np.ndarray] = []
    for line in merged:
        points = np.asarray(line.coords)
        first = points[0].astype(int)
        if line.is_closed and crossing[first[1], first[0]]:
            middle = len(points) // 2
            found += [points[: middle + 1], points[middle:]]
        else:
            found.append(points)
    return found


def _runs(edges: np.ndarray, crossing: np.ndarray) -> np.ndarray:
    """Return straight pieces (R, 2, 2) of outlines along the rows, x and y of both ends.

    Args:
        edges: (A, B) bool, whether an edge leads from corner b to corner b + 1 of row a.
        crossing: (A, B + 1) bool, whether four edges meet at a corner.
    """
    padded = np.pad(edges, ((0, 0), (1, 1)))
    begins = edges & (~padded[:, :-2] | crossing[:, :-1])
    ends = edges & (~padded[:, 2:] | crossing[:, 1:])
    row, first = np.nonzero(begins)
    _, last = np.nonzero(ends)
    pieces = np.array([[first, row], [last + 1, row]], float)
    return np.moveaxis(pieces, -1, 0)
