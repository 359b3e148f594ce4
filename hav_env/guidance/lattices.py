"""This module makes the lattices of a site: one for each goal pose and each turning radius."""

import logging
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from hav_env.guidance.lattice import BYTES_IN_TABLE, Lattice, check_size
from hav_env.guidance.table_files import are_kept, load_lengths
from hav_env.guidance.walls import Grid, lay_grid
from hav_env.models.memory import check_memory

_log = logging.getLogger(__name__)
_NODES_PER_SECOND = 4e5  # in a search
_SILENT = 2.0  # [s]; a warning announces longer searches


class Lattices(NamedTuple):
    """T lattices over one grid, shared by all worlds; the arrays of ``LatticeTable``, stacked."""

    length: np.ndarray  # (T, ny, nx, H) float32 [m]
    side: np.ndarray  # (T, ny, nx, H) int8
    steps: np.ndarray  # (T, ny, nx, H) uint8
    offset: np.ndarray  # (T, ny, nx, H, 2) int8
    goal: np.ndarray  # (T, 3) x, y [m], heading [rad]
    radius: np.ndarray  # (T,) turning radius [m]
    grid: Grid
    widening: float
    """Turning radius over the least radius that a HAV can drive for good."""

    def __deepcopy__(self, memo: Any) -> "Lattices":
        """Return the same object: no code writes to lattices."""
        return self


def load_lattices(
    lattice: Lattice,
    segments: np.ndarray,
    goals: np.ndarray,
    radii: Sequence[float],
    bounds: tuple[float, float, float, float],
) -> Lattices:
    """Return the lattices of a site; load those that the disk has, and compute the others.

    Args:
        lattice: Sizes of cells, clearance, widening.
        segments: (S, 4) Walls, x1, y1, x2, y2 [m].
        goals: (P, 3) Poses x, y [m], heading [rad], all inside the bounds.
        radii: Turning radii [m]; each goal gets a lattice for each of them.
        bounds: Bounds of the grid [m], as in ``find_lengths``.

    Raises:
        ValueError: If the lattices need more memory than the machine has.
    """
    check_size(lattice, bounds)
    _, rows, columns = lay_grid(bounds, lattice.cell)
    poses = [(float(x), float(y), float(heading)) for x, y, heading in goals]
    wanted = [(pose, float(radius)) for pose in poses for radius in radii]
    nodes = rows * columns * lattice.headings
    check_memory("number of lattices", len(wanted), len(wanted) * nodes * float(BYTES_IN_TABLE))
    missing = len(wanted) - are_kept(lattice, segments, wanted, bounds)
    seconds = missing * nodes / _NODES_PER_SECOND
    if seconds >= _SILENT:
        told = "hav_env finds %d lattices of %d nodes: about %.0f s, once for this site here ..."
        _log.warning(told, missing, nodes, seconds)
    tables = [load_lengths(lattice, segments, goal, radius, bounds) for goal, radius in wanted]
    return Lattices(
        np.stack([table.length for table in tables]),
        np.stack([table.side for table in tables]),
        np.stack([table.steps for table in tables]),
        np.stack([table.offset for table in tables]),
        np.stack([table.goal for table in tables]),
        np.array([table.radius for table in tables]),
        tables[0].grid,
        float(lattice.widening),
    )
