"""This module finds the edges of a road network: drives between two poses, the shortest clear one.

A candidate is an arc, a straight and an arc, with two radii. At a pose where the chain is straight,
a straight may come before and after it: so the chain begins its turn later, and ends it earlier.
"""

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from hav_env.compiled import entry
from hav_env.guidance.roads.model import RoadVehicle
from hav_env.guidance.roads.sweeps import Ends, SweptChain, try_drives
from hav_env.maths.arcs import tangent_path
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import TWO_PI, into_frame
from hav_env.vehicles.steady_circles import least_radius

_STRAIGHTS = (0.0, 0.7, 1.4, 2.4, 3.2)  # beside turns, over the longest trailer or half the chain
RADIUS_SHARES = (1.0, 1.25, 1.6, 2.5, 4.0)  # of turns, over the least
_ARC_SIDES = ((1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0))
LONGEST_DRIVES = 2.0, 7.0  # a longer drive makes a loop: over the distance; least radii
JOINT_RESERVE = 0.05  # [rad], of joints to their limits
SHORTEST_SEGMENT = 1e-6  # [m]
EDGE_SEGMENTS = 5


class RoadPose(NamedTuple):
    """A pose that edges join, and the curvature of the road there."""

    x: float
    """[m]."""
    y: float
    """[m]."""
    heading: float
    """[rad]."""
    curvature: float
    """Left positive [1/m]; the chain follows this circle steadily. 0: it is straight."""


class Drive(NamedTuple):
    """An edge: curvatures [1/m] and lengths [m] of its segments."""

    segments: tuple[tuple[float, float], ...]
    length: float
    """[m]."""


def chain_to_sweep(vehicle: RoadVehicle, num_walls: int) -> SweptChain:
    """Return a vehicle with scratch for its postures."""
    units = len(vehicle.length)
    scratch = np.zeros(units), np.zeros((units, 6)), np.zeros((units, 4, 2)), np.zeros(num_walls)
    length, offset, limit, shape = (np.ascontiguousarray(part) for part in vehicle[:4])
    return SweptChain(length, offset, limit, shape, *scratch)


def tightest_curvature(vehicle: RoadVehicle) -> float:
    """Return the largest curvature of a road pose that a vehicle follows steadily [1/m].

    On it the wheels keep their limit, and all joints keep an edge's reserve to theirs.
    """
    limits = vehicle.limit - JOINT_RESERVE
    if not (limits[1:] > 0.0).all():
        return 0.0
    least = least_radius(vehicle.length, np.roll(vehicle.offset, 1), limits)
    return 1.0 / max(vehicle.radius, least)


def steady_bends(chain: SweptChain, curvature: float) -> np.ndarray:
    """Return the articulations (U,) with which a chain follows a circle steadily [rad].

    The truck of the circle's radius ends each unit at a hitch; angles follow from unit to unit.
    """
    bends = np.zeros(len(chain.length))
    ahead = abs(curvature)  # of the axle ahead [1/m]
    for unit in range(1, len(bends)):
        length, offset = chain.length[unit], chain.offset[unit - 1]
        # length * rate = speed * sin(bend) + offset * rate * cos(bend), at the hitch
        hitch = math.hypot(1.0, offset * ahead)
        sine = ahead * length / hitch
        if sine >= 1.0:
            return np.full(len(bends), math.inf)
        bends[unit] = math.asin(sine) + math.atan(offset * ahead)
        along = math.sqrt(hitch * hitch - ahead * ahead * length * length)
        ahead = ahead / along
    return -math.copysign(1.0, curvature) * bends


def find_edge(
    chains: Sequence[SweptChain],
    walls: np.ndarray,
    one: RoadPose,
    other: RoadPose,
    radius: float,
    clearance: float,
    bend: float,
) -> Drive | None:
    """Return the shortest candidate between two poses that is clear for all chains, or None.

    Args:
        chains: Vehicles with one turning radius.
        walls: (S, 4) x1, y1, x2, y2 [m].
        one: Pose at the start.
        other: Pose at the end.
        radius: Radius of the tightest turns [m], but for those at a bent pose on its own circle.
        clearance: Least distance of bodies from walls [m].
        bend: Largest difference of articulations at the end [rad].
    """
    ends = [
        Ends(
            np.array(one[:3]),
            steady_bends(chain, one.curvature),
            steady_bends(chain, other.curvature),
            *(bend, clearance, JOINT_RESERVE),
        )
        for chain in chains
    ]
    table, lengths = candidates(chains, one, other, radius)
    number, _ = find_clear(chains, walls, ends, table)
    return None if number < 0 else drive_of(table[number], float(lengths[number]))


def find_clear(
    chains: Sequence[SweptChain], walls: np.ndarray, ends: Sequence[Ends], table: np.ndarray
) -> tuple[int, list[np.ndarray]]:
    """Return the number of the first drive that is clear for all chains, -1 if there is none.

    The second value holds the articulations (U,) of each chain at the end of that drive [rad].

    Args:
        chains: Vehicles with one turning radius.
        walls: (S, 4) x1, y1, x2, y2 [m].
        ends: Postures of each chain at both ends.
        table: (C, M, 2) Drives.
    """
    at = 0
    while at < len(table):
        bends, number, part = [], at, table[at:]
        for chain, own in zip(chains, ends, strict=True):
            found = np.array([-1])
            try_drives(1, chain, walls, own, part, found)
            if found[0] < 0:
                break
            number += int(found[0])
            part = table[number : number + 1]
            bends.append(np.diff(chain.heading, prepend=chain.heading[0]))
        if len(bends) == len(chains) or not bends:
            return (number if bends else -1), bends
        at = number + 1
    return -1, []


def drive_of(row: np.ndarray, length: float) -> Drive:
    """Return a row (M, 2) of a table of drives, without empty segments."""
    kept = tuple((float(side), float(way)) for side, way in row if way > 0.0)
    return Drive(kept, length)


def candidates(
    chains: Sequence[SweptChain], one: RoadPose, other: RoadPose, radius: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return drives (C, EDGE_SEGMENTS, 2) between two poses, and their lengths; shortest first.

    No drive is empty: where both poses are the same, each is a loop.
    """
    straights = straights_beside_turns(chains)
    distance = math.hypot(other.x - one.x, other.y - one.y)
    out = straights if one.curvature == 0.0 else [0.0]
    back = straights if other.curvature == 0.0 else [0.0]
    choices = np.array(
        [
            (*ways, *radii, *sides)
            for ways in itertools.product(out, back)
            for radii in _pairs_of_radii(one, other, radius)
            for sides in _ARC_SIDES
        ]
    )
    table, lengths = np.zeros((len(choices), EDGE_SEGMENTS, 2)), np.zeros(len(choices))
    join_poses(1, np.array(one), np.array(other), choices, table, lengths)
    most = LONGEST_DRIVES[0] * distance + LONGEST_DRIVES[1] * radius + choices[:, 0] + choices[:, 1]
    order = np.argsort(lengths, kind="stable")
    order = order[(lengths <= most)[order] & (table[order, :, 1] > 0.0).any(axis=1)]
    return table[order], lengths[order]


def straights_beside_turns(chains: Sequence[SweptChain]) -> list[float]:
    """Return the lengths of straights beside turns [m]."""
    longest = max(float(chain.length[1:].max()) for chain in chains)
    longest = max(longest, *(0.5 * float(chain.length[1:].sum()) for chain in chains))
    return [share * longest for share in _STRAIGHTS]


def _pairs_of_radii(one: RoadPose, other: RoadPose, radius: float) -> list[tuple[float, float]]:
    """Return the radii of the first and of the last arc: equal, or also those of bent poses."""
    shared = [share * radius for share in RADIUS_SHARES]
    first = [1.0 / abs(one.curvature)] if one.curvature != 0.0 else []
    last = [1.0 / abs(other.curvature)] if other.curvature != 0.0 else []
    bent = list(itertools.product(first + shared, last + shared)) if first or last else []
    return bent or [(share, share) for share in shared]


@entry
def join_poses(first, last, start, goal, choices, drives, lengths):
    """Join two poses by a straight, an arc, a straight, an arc and a straight, in many ways.

    Args:
        first: 0.
        last: 1, or 0 to do nothing.
        start: (4,) x, y [m], heading [rad], curvature [1/m].
        goal: (4,) likewise.
        choices: (C, 6) lengths of the first and of the last straight [m]; radii of both arcs [m];
            their sides, 1.0 left, -1.0 right.
        drives: (C, EDGE_SEGMENTS, 2) curvatures [1/m] and lengths [m], written.
        lengths: (C,) of the drives [m], written: infinite where there is none, or where it turns by
            more than a whole turn.
    """
    for _ in range(first, last):
        sine, cosine = sincos(start[2])
        goal_sine, goal_cosine = sincos(goal[2])
        heading = goal[2] - start[2]
        turn_sine, turn_cosine = sincos(heading)
        for number in range(choices.shape[0]):
            choice, drive = choices[number], drives[number]
            out, back = choice[0], choice[1]
            dx = goal[0] - back * goal_cosine - start[0] - out * cosine
            dy = goal[1] - back * goal_sine - start[1] - out * sine
            forward, left = into_frame(dx, dy, cosine, sine)
            one, middle, other = tangent_path(
                *(choice[4], choice[5], forward, left, heading, turn_cosine, turn_sine),
                *(choice[2], choice[3]),
            )
            turned = one / choice[2] + other / choice[3]
            drive[0, 1], drive[2, 1], drive[4, 1] = out, middle, back
            drive[1, 0], drive[3, 0] = choice[4] / choice[2], choice[5] / choice[3]
            drive[1, 1], drive[3, 1] = one, other
            length = 0.0
            for k in range(drive.shape[0]):
                length += drive[k, 1]
                drive[k, 1] = drive[k, 1] if drive[k, 1] > SHORTEST_SEGMENT else 0.0
            lengths[number] = length if turned <= TWO_PI else math.inf
