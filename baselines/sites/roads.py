"""This module says by which poses drives go from place to place on each site.

At a pose with three numbers the chain is straight. Near one with four it may be bent.
"""

import math
from collections.abc import Callable

import numpy as np

from hav_env.scenarios.site_poses import SitePoses

Poses = list[np.ndarray]


def _through_gate(scenario: SitePoses, start: np.ndarray, goal: np.ndarray) -> Poses:
    side = math.copysign(1.0, goal[0])
    heading = 0.0 if side > 0.0 else math.pi
    return [np.array([x * side, 0.0, heading]) for x in (-9.0, 22.0)]


def _direct(scenario: SitePoses, start: np.ndarray, goal: np.ndarray) -> Poses:
    return []


def _across_junction(scenario: SitePoses, start: np.ndarray, goal: np.ndarray) -> Poses:
    """Come in the right lane of an arm, and leave by the right lane of the arm of the goal."""
    come, leave = np.array([40.0, 2.0, math.pi]), np.array([42.0, -2.0, 0.0])
    return [_turned(come, start[2] - math.pi), _turned(leave, goal[2] - math.pi)]


def _by_cross_aisle(scenario: SitePoses, start: np.ndarray, goal: np.ndarray) -> Poses:
    """Leave an aisle, go along the cross aisle at its end, and enter another."""
    side, ahead = math.copysign(1.0, start[2]), math.copysign(1.0, goal[0] - start[0])
    y, heading = side * 14.2, 0.0 if ahead > 0.0 else math.pi
    first, last = (round(float(x), 6) for x in (start[0] + 2.7 * ahead, goal[0] - 2.7 * ahead))
    return [np.array([x, y, heading, 1.0]) for x in sorted({first, last}, reverse=ahead < 0.0)]


def _turned(pose: np.ndarray, angle: float) -> np.ndarray:
    """Return a pose turned round the origin."""
    cosine, sine = math.cos(angle), math.sin(angle)
    x, y, heading = pose
    return np.array([cosine * x - sine * y, sine * x + cosine * y, heading + angle])


ROADS: dict[str, Callable[[SitePoses, np.ndarray, np.ndarray], Poses]] = {
    "gate-2": _through_gate,
    "docks-6": _direct,
    "junction-4": _across_junction,
    "aisles-6": _by_cross_aisle,
}
"""The poses between start and goal, for each site."""
