"""This module finds drives from place to place through road poses, with the posture of the chain.

An edge begins and ends with the chain of a steady pose; a long chain seldom has the space for that.
This search carries the posture that the chain has from leg to leg: a weighted A* over postures at
road poses. A leg is the shortest clear candidate of an edge, else the shortest clear detour.
"""

import heapq
import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from hav_env.guidance.roads.detours import detours
from hav_env.guidance.roads.edges import (
    JOINT_RESERVE,
    Drive,
    RoadPose,
    candidates,
    drive_of,
    find_clear,
)
from hav_env.guidance.roads.sweeps import Ends, SweptChain
from hav_env.maths.dubins import shortest_path
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import into_frame

_WEIGHT_AHEAD = 1.5  # of the lengths ahead: more finds a drive sooner, less a shorter one
_DETOUR = 10.0  # [radii] a detour counts longer
_MOST_POSTURES = 4  # at each road pose
_ALIKE = 0.05  # [rad]: postures with smaller differences count as one
_MOST_LEGS, _MOST_DETOURS = 600, 40  # tried from each start


class Survey(NamedTuple):
    """A site as a search sees it."""

    chains: Sequence[SweptChain]
    """Vehicles with one turning radius."""
    walls: np.ndarray  # (S, 4) [m]
    nodes: Sequence[RoadPose]
    joins: np.ndarray  # (P + 1, P) bool, see ``build_networks``
    radius: float
    """Radius of the tightest turns of edges [m]."""
    clearance: float
    """Least distance of bodies from walls [m]."""
    bend: float
    """Largest difference of articulations at a goal [rad]."""


class Connection(NamedTuple):
    """A drive from a place to another one, and the road poses on it."""

    drive: Drive
    passed: tuple[tuple[int, int], ...]
    """Number of each pose, and number of segments before it."""


class _Label(NamedTuple):
    """A posture at a pose, and the way there."""

    pose: int
    bends: list[np.ndarray]
    segments: tuple[tuple[float, float], ...]
    length: float
    passed: tuple[tuple[int, int], ...]


def dubins_lengths(nodes: Sequence[RoadPose], radius: float) -> np.ndarray:
    """Return the lengths (P, P) of the Dubins paths from pose to pose [m]."""
    found = np.zeros((len(nodes), len(nodes)))
    for k, one in enumerate(nodes):
        sine, cosine = sincos(one.heading)
        for m, other in enumerate(nodes):
            forward, left = into_frame(other.x - one.x, other.y - one.y, cosine, sine)
            path = shortest_path(forward, left, other.heading - one.heading, radius)
            found[k, m] = path[1] + path[2] + path[3]
    return found


def keeps_clear(survey: Survey, start: int, drive: Drive) -> bool:
    """Return whether a whole drive from a place is clear, and ends with a straight chain."""
    table = np.array(drive.segments).reshape(1, -1, 2)
    straight = [np.zeros(len(chain.length)) for chain in survey.chains]
    return _try(survey, start, straight, table, survey.bend)[0] == 0


def find_connections(
    survey: Survey, apart: np.ndarray, start: int, goals: Sequence[int]
) -> dict[int, Connection]:
    """Return drives from a place to others, by goal; goals without a drive are missing.

    Args:
        survey: The site.
        apart: (P, P) lengths of Dubins paths [m].
        start: Place with a straight chain.
        goals: Places.
    """
    found: dict[int, Connection] = {}
    reached: dict[int, list[_Label]] = {pose: [] for pose in range(len(survey.nodes))}
    left = apart[:, list(goals)].min(axis=1)
    left[list(goals)] = 0.0
    order, legs, rich = itertools.count(), 0, 0
    queue: list[tuple[float, int, _Label, int, bool]] = []

    def add_legs(label: _Label) -> None:
        ways = survey.joins[label.pose] & survey.joins[-1]
        ways[list(goals)] = survey.joins[label.pose, list(goals)]
        before = [pose for pose, _ in label.passed]
        for pose in np.flatnonzero(ways):
            if pose != start and pose not in before:
                length = label.length + apart[label.pose, pose] + _WEIGHT_AHEAD * left[pose]
                heapq.heappush(queue, (length, next(order), label, int(pose), False))

    straight = [np.zeros(len(chain.length)) for chain in survey.chains]
    add_legs(_Label(start, straight, (), 0.0, ()))
    while queue and len(found) < len(goals) and legs < _MOST_LEGS:
        length, _, label, pose, detour = heapq.heappop(queue)
        is_goal = pose in goals
        if pose in found or len(reached[pose]) >= _MOST_POSTURES:
            continue
        if detour and rich >= _MOST_DETOURS:
            continue
        legs, rich = legs + 1, rich + detour
        if not detour:
            later = length + _DETOUR * survey.radius
            heapq.heappush(queue, (later, next(order), label, pose, True))
        following = _drive_leg(survey, label, pose, is_goal, detour)
        if following is None:
            continue
        if is_goal:
            drive = Drive(following.segments, following.length)
            found[pose] = Connection(drive, following.passed[:-1])
        elif not any(_are_alike(following.bends, known.bends) for known in reached[pose]):
            reached[pose].append(following)
            add_legs(following)
    return found


def _drive_leg(
    survey: Survey, label: _Label, pose: int, is_goal: bool, detour: bool
) -> _Label | None:
    """Return the posture after the shortest clear drive to a pose, None without one."""
    find = detours if detour else candidates
    one, other = survey.nodes[label.pose], survey.nodes[pose]
    table, lengths = find(survey.chains, one, other, survey.radius)
    tolerance = survey.bend if is_goal else math.inf
    number, bends = _try(survey, label.pose, label.bends, table, tolerance)
    if number < 0:
        return None
    drive = drive_of(table[number], float(lengths[number]))
    segments = label.segments + drive.segments
    passed = (*label.passed, (pose, len(segments)))
    return _Label(pose, bends, segments, label.length + drive.length, passed)


def _try(
    survey: Survey, start: int, bends: list[np.ndarray], table: np.ndarray, tolerance: float
) -> tuple[int, list[np.ndarray]]:
    """Return the first clear drive of a table, and the articulations behind it.

    All articulations at the end are at most the tolerance [rad].
    """
    here = np.array(survey.nodes[start][:3])
    ends = [
        Ends(here, own, np.zeros(len(own)), tolerance, survey.clearance, JOINT_RESERVE)
        for own in bends
    ]
    return find_clear(survey.chains, survey.walls, ends, table)


def _are_alike(some: list[np.ndarray], others: list[np.ndarray]) -> bool:
    """Return whether two postures of the same chains are almost the same."""
    pairs = zip(some, others, strict=True)
    return all(float(np.abs(one - other).max()) < _ALIKE for one, other in pairs)
