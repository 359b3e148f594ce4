"""This module makes a lattice: lengths of the drives to one goal pose among the walls of a site.

The truck drives forward only, straight ahead or on circles of one radius to either side. A disc of
radius ``Lattice.clearance`` around its rear axle touches no wall along a drive.

Guaranteed: from the pose of every reached node, a drive of exactly the node's length ends in the
goal pose and keeps the clearance. A node's pose is somewhere in its cell. The table refers to the
middle of the cell: it adds the distance by which the pose is ahead of the middle. So lengths are
approximate between nodes. Around direct nodes, they are those of Dubins paths that keep clear.

Not guaranteed: the lengths need not be the shortest, because each cell keeps one pose. An unreached
pose may have a path to the goal. Bodies may touch walls. A disc of ``clearance_of`` holds all
bodies on the steady circle. It need not hold bodies ahead of the axle at the goal, behind it at the
start, or swinging out in between.
"""

from typing import Annotated, NamedTuple

import numpy as np

from hav_env.guidance.search import (
    DRIVE_SIDES,
    IN_SIGHT,
    UNREACHED,
    Drives,
    Nodes,
    find_direct,
    spread_backwards,
)
from hav_env.guidance.walls import Grid, Walls, lay_grid, measure_gaps
from hav_env.maths.geometry import TWO_PI
from hav_env.models.annotations import Range
from hav_env.models.checks import check_fields, check_relations, check_value, require
from hav_env.models.memory import check_memory
from hav_env.models.quantities import Coordinate, Distance, Heading, Widening

Radius = Annotated[float, Range(0.01, 1e6, "m")]
_BYTES_OF_NODE = 40.0  # during the search
BYTES_IN_TABLE = 8  # of a node: length, side, steps, offset
OFFSETS = 254.0  # units of ``LatticeTable.offset`` in the side of a cell
_MOST_NODES = 2**31 - 1


class Lattice(NamedTuple):
    """A lattice of poses for guidance among walls; one table of lengths for each goal pose."""

    cell: Annotated[float, Range(0.1, 100.0, "m")] = 2.0
    """Side of the cells in x and y [m], at most 1.4 times the clearance. So interpolation never
    mixes lengths from both sides of a wall."""
    headings: Annotated[int, Range(8, 360)] = 32
    """Number of headings. Each drive turns by one heading, or goes straight with equal length."""
    clearance: Annotated[float, Range(0.1, 1e3, "m")] = 1.5
    """Distance of the truck's rear axle from walls [m]; see ``clearance_of``."""
    widening: Widening = 1.2
    """Turning radius over the least radius that a HAV can drive for good, in simulations.
    ``find_lengths`` takes the radius itself."""
    direct: Distance = 60.0
    """Greatest length of Dubins paths [m] that replace drives if they keep clear; 0 for none. They
    make lengths exact near the goal. The time of the search for them grows with its square."""


class LatticeTable(NamedTuple):
    """Lengths of drives to one goal pose, read by ``hav_env.guidance.lookup``."""

    length: np.ndarray  # (ny, nx, H) float32, from the middle of each cell [m]; inf: not reached
    side: np.ndarray  # (ny, nx, H) int8, of the first turn, see ``Nodes``
    steps: np.ndarray  # (ny, nx, H) uint8, number of drives on that side
    offset: np.ndarray  # (ny, nx, H, 2) int8, the node's pose in x and y, see ``OFFSETS``
    goal: np.ndarray  # (3,) x, y [m], heading [rad], the first of the headings
    radius: float
    """Turning radius [m]."""
    grid: Grid


@check_relations.register
def _(lattice: Lattice) -> None:
    fits = lattice.cell <= 1.4 * lattice.clearance
    rule = f"at most 1.4 times the clearance, {lattice.clearance} m"
    require(fits, "lattice", lattice, "cell", rule)


def find_lengths(
    lattice: Lattice,
    segments: np.ndarray,
    goal: tuple[float, float, float],
    radius: float,
    bounds: tuple[float, float, float, float] | None = None,
) -> LatticeTable:
    """Return the lengths of drives to a goal pose from all cells of a rectangle.

    Args:
        lattice: sizes of cells, clearance.
        segments: (S, 4) walls, x1, y1, x2, y2 [m].
        goal: x, y [m] and heading [rad].
        radius: turning radius [m].
        bounds: x and y [m] of the rectangle's south-western corner, then of its north-eastern one;
            by default the smallest rectangle that holds the segments and the goal.

    Raises:
        TypeError: If an argument has another type.
        ValueError: If an argument is out of range.
    """
    return table_of(
        lattice, *search(lattice, *check_arguments(lattice, segments, goal, radius, bounds))
    )


def check_arguments(
    lattice: Lattice,
    segments: np.ndarray,
    goal: tuple[float, float, float],
    radius: float,
    bounds: tuple[float, float, float, float] | None,
) -> tuple[np.ndarray, np.ndarray, float, tuple[float, float, float, float]]:
    """Check the arguments of ``find_lengths``; return segments, goal, radius and bounds.

    Args:
        lattice: sizes of cells, clearance.
        segments: (S, 4) walls [m].
        goal: x, y [m] and heading [rad].
        radius: turning radius [m].
        bounds: as in ``find_lengths``.

    Raises:
        TypeError: If an argument has another type.
        ValueError: If an argument is out of range.
    """
    check_fields("lattice", lattice)
    check_value("radius", Radius, radius)
    for name, kind, value in zip(
        ("goal x", "goal y", "goal heading"), (Coordinate, Coordinate, Heading), goal, strict=True
    ):
        check_value(name, kind, value)
    walls = np.ascontiguousarray(segments, np.float64)
    if walls.ndim != 2 or walls.shape[1] != 4:
        raise ValueError(f"segments is of shape {walls.shape}, but must be of shape (S, 4)")
    check_value("segments", Annotated[np.ndarray, Range(-1e8, 1e8, "m")], walls)
    ends = np.concatenate([walls.reshape(-1, 2), [goal[:2]]])
    box = (*ends.min(axis=0), *ends.max(axis=0)) if bounds is None else bounds
    west, south, east, north = (float(side) for side in box)
    for name, side in zip(("west", "south", "east", "north"), box, strict=True):
        check_value(f"bounds {name}", Coordinate, float(side))
    if not (west <= goal[0] <= east and south <= goal[1] <= north):
        raise ValueError(f"goal is {goal}, but must be inside the bounds {box}")
    check_size(lattice, (west, south, east, north))
    return walls, np.array(goal, np.float64), float(radius), (west, south, east, north)


def check_size(lattice: Lattice, bounds: tuple[float, float, float, float]) -> None:
    """Check that the table of a rectangle fits into memory.

    Args:
        lattice: sizes of cells.
        bounds: the rectangle [m].

    Raises:
        ValueError: If it needs more memory than the machine has, or more than 2**31 - 1 nodes.
    """
    _, rows, columns = lay_grid(bounds, lattice.cell)
    count = rows * columns * lattice.headings
    check_memory("number of nodes of the lattice", count, count * _BYTES_OF_NODE)
    if count > _MOST_NODES:
        told = f"number of nodes of the lattice is {count}, but must be at most {_MOST_NODES}"
        raise ValueError(f"{told}: take larger cells or fewer headings")


def search(
    lattice: Lattice,
    segments: np.ndarray,
    goal: np.ndarray,
    radius: float,
    bounds: tuple[float, float, float, float],
) -> tuple[Walls, Drives, Nodes, np.ndarray]:
    """Search the lattice; return the walls, the drives, the nodes and the goal.

    Args:
        lattice: sizes of cells, clearance.
        segments: (S, 4) walls [m].
        goal: (3,) x, y [m] and heading [rad].
        radius: turning radius [m].
        bounds: the rectangle [m].
    """
    grid, rows, columns = lay_grid(bounds, lattice.cell)
    site = Walls(segments, measure_gaps(segments, grid, rows, columns), grid)
    drives = drives_of(lattice, goal[2], radius)
    nodes = _allocate_nodes(rows * columns * lattice.headings)
    if lattice.direct > 0.0:
        find_direct(rows, site, drives, nodes, goal)
    seeds = np.flatnonzero(nodes.side == IN_SIGHT)
    seeds = seeds[np.argsort(nodes.length[seeds], kind="stable")]
    if seeds.size == 0 and _is_free(segments, goal, lattice.clearance):
        column = min(int((goal[0] - grid.x) / grid.cell), columns - 1)
        row = min(int((goal[1] - grid.y) / grid.cell), rows - 1)
        seeds = np.array([(row * columns + column) * lattice.headings])
        nodes.length[seeds], nodes.side[seeds] = 0.0, IN_SIGHT
        nodes.x[seeds], nodes.y[seeds] = goal[0], goal[1]
    spread_backwards(1, site, drives, nodes, seeds)
    return site, drives, nodes, goal


def _allocate_nodes(count: int) -> Nodes:
    """Return unreached nodes."""
    return Nodes(
        np.full(count, np.inf),
        *(np.zeros(count), np.zeros(count)),
        np.full(count, UNREACHED, np.int8),
        *(np.zeros(count, np.uint8), np.zeros(count, np.int32)),
    )


def _is_free(segments: np.ndarray, goal: np.ndarray, clearance: float) -> bool:
    """Return whether the goal keeps clear of all segments."""
    here = Grid(goal[0] - 0.5, goal[1] - 0.5, 1.0)
    return bool(measure_gaps(segments, here, 1, 1)[0, 0] >= clearance)


def drives_of(lattice: Lattice, heading: float, radius: float) -> Drives:
    """Return the drives from node to node.

    Args:
        lattice: number of headings, clearance.
        heading: heading of the goal, the first heading [rad].
        radius: turning radius [m].
    """
    turn = TWO_PI / lattice.headings
    angles = heading + turn * np.arange(lattice.headings)
    step = radius * turn
    backwards = np.zeros((len(DRIVE_SIDES), 2, lattice.headings))
    backwards[0] = -step * np.cos(angles), -step * np.sin(angles)
    for side in (-1, 1):
        before = angles - side * turn
        backwards[side, 0] = -side * radius * (np.sin(angles) - np.sin(before))
        backwards[side, 1] = side * radius * (np.cos(angles) - np.cos(before))
    directions = np.array([np.cos(angles), np.sin(angles)])
    return Drives(
        radius, step, float(lattice.clearance), float(lattice.direct), directions, backwards
    )


def table_of(
    lattice: Lattice, site: Walls, drives: Drives, nodes: Nodes, goal: np.ndarray
) -> LatticeTable:
    """Return the table of a search, with the lengths from the middle of each cell.

    Args:
        lattice: number of headings.
        site: the walls and the grid.
        drives: from node to node.
        nodes: nodes after the search.
        goal: (3,) x, y [m] and heading [rad].
    """
    rows, columns = site.gaps.shape
    shape, grid = (rows, columns, lattice.headings), site.grid
    middle_x = grid.x + grid.cell * (np.arange(columns) + 0.5)
    middle_y = grid.y + grid.cell * (np.arange(rows) + 0.5)
    cosine, sine = drives.directions
    dx = nodes.x.reshape(shape) - middle_x[:, None]
    dy = nodes.y.reshape(shape) - middle_y[:, None, None]
    ahead = dx * cosine + dy * sine
    reached = (nodes.side != UNREACHED).reshape(*shape, 1)
    offset = np.where(reached, np.stack([dx, dy], axis=-1) * (OFFSETS / grid.cell), 0.0)
    length = np.maximum(nodes.length.reshape(shape) + ahead, 0.0).astype(np.float32)
    side, steps = nodes.side.reshape(shape), nodes.steps.reshape(shape)
    offset = np.clip(np.rint(offset), -127, 127).astype(np.int8)
    return LatticeTable(length, side, steps, offset, goal, drives.radius, grid)
