"""This module builds the road networks of a site: edges, and all shortest paths once."""

from collections.abc import Sequence

import numpy as np

from hav_env.guidance.roads.edges import (
    EDGE_SEGMENTS,
    Drive,
    RoadPose,
    chain_to_sweep,
    find_edge,
    tightest_curvature,
)
from hav_env.guidance.roads.model import NO_EDGE, RoadNetworks, Roads, RoadVehicle
from hav_env.guidance.walls import Walls, lay_grid, measure_gaps

_CELL = 1.0  # [m], of the grid that speeds up the check of the ways to a pose
_DECIMALS = 6  # of radii [m]: equal vehicles share a network
_ROUNDED = 1e-9  # share of a curvature


def build_networks(
    roads: Roads,
    walls: np.ndarray,
    poses: np.ndarray,
    joins: np.ndarray,
    vehicles: Sequence[RoadVehicle],
    bounds: tuple[float, float, float, float],
) -> RoadNetworks:
    """Return the networks of a site: one for each turning radius.

    Edges of a network are clear for all vehicles of its radius. Paths lead through road poses, not
    through the places where HAVs stop.

    Args:
        roads: Clearance, radii.
        walls: (S, 4) x1, y1, x2, y2 [m].
        poses: (P, 4) x, y [m], heading [rad] and curvature [1/m].
        joins: (P + 1, P) bool: whether an edge may lead from the row to the column. The last row
            marks the poses through which paths may lead.
        vehicles: Kinds of HAVs.
        bounds: x and y [m] of the south-western corner of the site, then of the north-eastern one.

    Raises:
        ValueError: If the curvature of a pose is tighter than a vehicle follows steadily.
    """
    _check_curvatures(poses, vehicles)
    known = np.round([vehicle.radius for vehicle in vehicles], _DECIMALS)
    nodes = [RoadPose(*map(float, pose)) for pose in poses]
    count, networks = len(nodes), np.unique(known)
    left = np.full((len(networks), count, count), np.inf)
    edge = np.full(left.shape, NO_EDGE, np.int32)
    ends: list[int] = []
    drives: list[Drive] = []
    for k, radius in enumerate(networks):
        chains = [
            chain_to_sweep(vehicle, len(walls))
            for vehicle, own in zip(vehicles, known, strict=True)
            if own == radius
        ]
        for one, other in np.argwhere(joins[:count]):
            drive = find_edge(
                *(chains, walls, nodes[one], nodes[other], roads.widening * radius),
                *(roads.clearance, roads.bend),
            )
            if drive is not None:
                left[k, one, other], edge[k, one, other] = drive.length, len(drives)
                drives.append(drive)
                ends.append(other)
        join_all(left[k], edge[k], joins[count])
    count_of, table = _tabulate(drives)
    widest = max(float(vehicle.shape[:, 0].max()) for vehicle in vehicles)
    grid, rows, columns = lay_grid(bounds, _CELL)
    return RoadNetworks(
        np.ascontiguousarray(poses[:, :3]),
        *(networks, left, edge, np.array(ends, np.int32), count_of, table),
        Walls(walls, measure_gaps(walls, grid, rows, columns), grid),
        widest + float(roads.clearance),
        float(roads.widening),
    )


def _check_curvatures(poses: np.ndarray, vehicles: Sequence[RoadVehicle]) -> None:
    """Check that all vehicles can follow the circles of all poses (P, 4) steadily."""
    most = min(map(tightest_curvature, vehicles))
    for x, y, heading, curvature in poses:
        if not abs(curvature) <= most * (1.0 + _ROUNDED):
            told = f"road pose [{x:.6g}, {y:.6g}, {heading:.6g}] has curvature {curvature:.6g} 1/m"
            rule = f"but must have one from {-most:.6g} to {most:.6g} 1/m"
            raise ValueError(f"{told}, {rule}: a tighter circle is beyond a HAV of the fleet")


def join_all(left: np.ndarray, edge: np.ndarray, through: np.ndarray) -> None:
    """Find all shortest paths by the algorithm of Floyd and Warshall, in place.

    Args:
        left: (P, P) lengths of edges [m], inf without an edge; then of the shortest paths.
        edge: (P, P) numbers of edges; then the first edge of the shortest path.
        through: (P,) bool: poses through which paths may lead.
    """
    for k in np.flatnonzero(through):
        longer = left[:, k, None] + left[None, k]
        shorter = longer < left
        left[shorter] = longer[shorter]
        edge[shorter] = np.broadcast_to(edge[:, k, None], edge.shape)[shorter]
    np.fill_diagonal(left, 0.0)
    np.fill_diagonal(edge, NO_EDGE)


def _tabulate(drives: Sequence[Drive]) -> tuple[np.ndarray, np.ndarray]:
    """Return the numbers of segments (E,), and the segments (E, M, 3) without empty ones."""
    count = np.zeros(len(drives), np.int32)
    table = np.zeros((len(drives), EDGE_SEGMENTS, 3))
    for number, drive in enumerate(drives):
        kept = np.array([segment for segment in drive.segments if segment[1] > 0.0])
        count[number] = len(kept)
        table[number, : len(kept), :2] = kept
        table[number, : len(kept), 2] = drive.length - np.cumsum(kept[:, 1])
    return count, table
