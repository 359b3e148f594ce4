"""This module builds the road networks of a site: edges, and all shortest paths once."""

import logging
from collections.abc import Iterator, Sequence

import numpy as np

from hav_env.guidance.roads.connections import (
    Connection,
    Survey,
    dubins_lengths,
    find_connections,
    keeps_clear,
)
from hav_env.guidance.roads.edges import (
    Drive,
    RoadPose,
    chain_to_sweep,
    find_edge,
    tightest_curvature,
)
from hav_env.guidance.roads.model import NO_EDGE, RoadNetworks, Roads, RoadVehicle
from hav_env.guidance.walls import Walls, lay_grid, measure_gaps

_log = logging.getLogger(__name__)
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
    through the places where HAVs stop. A path between places is clear as a whole: the chain begins
    straight, and no edge assumes another posture than the chain has.

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
        own = [vehicle for vehicle, its in zip(vehicles, known, strict=True) if its == radius]
        chains = [chain_to_sweep(vehicle, len(walls)) for vehicle in own]
        widened = float(roads.widening * radius)
        limits = float(roads.clearance), float(roads.bend)
        survey = Survey(chains, walls, nodes, joins, widened, *limits)
        for one, other in np.argwhere(joins[:count]):
            drive = find_edge(chains, walls, nodes[one], nodes[other], widened, *limits)
            if drive is not None:
                _add(left[k], edge[k], ends, drives, int(one), int(other), drive)
        join_all(left[k], edge[k], joins[count])
        _connect_places(survey, left[k], edge[k], ends, drives)
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


def _add(
    left: np.ndarray,
    edge: np.ndarray,
    ends: list[int],
    drives: list[Drive],
    one: int,
    other: int,
    drive: Drive,
) -> None:
    """Make a drive the edge between two poses of a network (P, P)."""
    left[one, other], edge[one, other] = drive.length, len(drives)
    drives.append(drive)
    ends.append(other)


def _connect_places(
    survey: Survey, left: np.ndarray, edge: np.ndarray, ends: list[int], drives: list[Drive]
) -> None:
    """Find drives between the places that no path joins, or one that is not clear as a whole.

    The rest of such a drive behind a road pose serves that pose if it has no path to the goal.
    """
    places = ~survey.joins[-1]
    wanted = survey.joins[:-1] & places & places[:, None]
    for one, other in np.argwhere(wanted & np.isfinite(left)):
        parts, at = [], int(one)
        while at != other:
            number = edge[at, other]
            parts.append(drives[number])
            at = ends[number]
        if len(parts) > 1:
            whole = tuple(segment for part in parts for segment in part.segments)
            if not keeps_clear(survey, int(one), Drive(whole, float(left[one, other]))):
                left[one, other], edge[one, other] = np.inf, NO_EDGE
    missing = wanted & ~np.isfinite(left)
    if missing.any():
        told = "hav_env finds drives between %d pairs of places: some minutes at most, once ..."
        _log.warning(told, np.count_nonzero(missing))
    apart = dubins_lengths(survey.nodes, survey.radius)
    tails: list[tuple[int, int, Drive]] = []
    for start in np.flatnonzero(missing.any(axis=1)):
        goals = np.flatnonzero(missing[start]).tolist()
        for goal, connection in find_connections(survey, apart, int(start), goals).items():
            _add(left, edge, ends, drives, int(start), goal, connection.drive)
            tails += [(pose, goal, rest) for pose, rest in _rests_of(connection)]
    for pose, goal, rest in tails:
        if not np.isfinite(left[pose, goal]):
            _add(left, edge, ends, drives, pose, goal, rest)


def _rests_of(connection: Connection) -> Iterator[tuple[int, Drive]]:
    """Yield the rest of a drive behind each road pose on it."""
    for pose, before in connection.passed:
        rest = connection.drive.segments[before:]
        yield pose, Drive(rest, sum(length for _, length in rest))


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
    count = np.array([len(drive.segments) for drive in drives], np.int32)
    table = np.zeros((len(drives), max(count, default=1), 3))
    for number, drive in enumerate(drives):
        kept = np.array(drive.segments)
        table[number, : len(kept), :2] = kept
        table[number, : len(kept), 2] = drive.length - np.cumsum(kept[:, 1])
    return count, table
