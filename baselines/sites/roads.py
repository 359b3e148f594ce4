"""This module states the poses through which drives go from place to place on each site.

At a pose with three numbers the chain is straight. Near one with four it may be bent.
"""

import math
from collections.abc import Callable

import numpy as np

from hav_env.scenarios.site_poses import SitePoses

Poses = list[np.ndarray]
_ROUND_PILE = np.array([-55.0, 22.0, math.pi]), np.array([-118.0, 2.0, -math.pi / 2])
_RING = 11.5  # [m] radius of the ring of guides in a roundabout


def _through_gate(scenario: SitePoses, start: np.ndarray, goal: np.ndarray) -> Poses:
    side = math.copysign(1.0, goal[0])
    heading = 0.0 if side > 0.0 else math.pi
    return [np.array([x * side, 0.0, heading]) for x in (-9.0, 22.0)]


def _direct(scenario: SitePoses, start: np.ndarray, goal: np.ndarray) -> Poses:
    return []


def _across_junction(scenario: SitePoses, start: np.ndarray, goal: np.ndarray) -> Poses:
    """Enter in the right lane of an arm, and leave by the right lane of the arm of the goal."""
    come, leave = np.array([40.0, 2.0, math.pi]), np.array([42.0, -2.0, 0.0])
    return [_turned(come, start[2] - math.pi), _turned(leave, goal[2] - math.pi)]


def _along_haul_road(scenario: SitePoses, start: np.ndarray, goal: np.ndarray) -> Poses:
    """Keep to the right lane of the road: out of one loop, into the other."""
    out, into = np.array([38.0, -2.2, 0.0]), np.array([9.0, 2.2, math.pi])
    shift = np.array([90.0, -90.0, 0.0])  # of the dumping loop, which is turned by a quarter
    if start[2] < 1.0:
        loop = [_turned(pose, math.pi / 2) + shift for pose in (into, *_ROUND_PILE)]
        bend = _in_bend(47.8, -math.pi / 4)
        return [out, bend, loop[0], *(np.array([*pose, 1.0]) for pose in loop[1:])]
    bend, loop = _in_bend(52.2, 0.75 * math.pi), [np.array([*pose, 1.0]) for pose in _ROUND_PILE]
    return [_turned(out, math.pi / 2) + shift, bend, into, *loop]


def _in_bend(radius: float, heading: float) -> np.ndarray:
    """Return the middle of the bend of the haul road, in one of the lanes."""
    aside = radius * math.sqrt(0.5)
    return np.array([40.0 + aside, -50.0 + aside, heading, 1.0])


def _by_cross_aisle(scenario: SitePoses, start: np.ndarray, goal: np.ndarray) -> Poses:
    """Leave an aisle, follow the cross aisle at its end, and enter another aisle."""
    side, ahead = math.copysign(1.0, start[2]), math.copysign(1.0, goal[0] - start[0])
    y, heading = side * 14.2, 0.0 if ahead > 0.0 else math.pi
    first, last = (round(float(x), 6) for x in (start[0] + 2.7 * ahead, goal[0] - 2.7 * ahead))
    return [np.array([x, y, heading, 1.0]) for x in sorted({first, last}, reverse=ahead < 0.0)]


def _round_ring(scenario: SitePoses, start: np.ndarray, goal: np.ndarray) -> Poses:
    """Enter in the right lane, keep to the right round the island, leave by the right lane."""
    arm, last = start[2] - math.pi, goal[2] - math.pi
    quarters = round(((last - arm) % (2.0 * math.pi)) / (math.pi / 2))
    ring = [
        np.array([_RING * math.cos(angle), _RING * math.sin(angle), angle + math.pi / 2, 1.0])
        for angle in (arm + (k + 0.5) * math.pi / 2 for k in range(quarters))
    ]
    come, leave = np.array([45.0, 2.0, math.pi]), np.array([48.0, -2.0, 0.0])
    return [_turned(come, arm), *ring, _turned(leave, last)]


def _round_apron(scenario: SitePoses, start: np.ndarray, goal: np.ndarray) -> Poses:
    """Keep to the one-way round: behind the aircraft, between two wings, before the noses."""
    if goal[2] > 0.0:
        return [np.array([-48.0, -60.0, 0.0])]
    aircraft = round(float(start[0]) / 58.0)
    side = math.copysign(1.0, start[0] - 58.0 * aircraft)
    out = np.array([start[0] + 11.0 * side, -25.5, 0.0 if side > 0.0 else math.pi, 1.0])
    between = np.array([58.0 * aircraft + 29.0 * side, -12.0, math.pi / 2, 1.0])
    return [out, between, np.array([-58.0, 10.0, math.pi])]


def _turned(pose: np.ndarray, angle: float) -> np.ndarray:
    """Return a pose turned round the origin."""
    cosine, sine = math.cos(angle), math.sin(angle)
    x, y, heading = pose
    return np.array([cosine * x - sine * y, sine * x + cosine * y, heading + angle])


ROADS: dict[str, Callable[[SitePoses, np.ndarray, np.ndarray], Poses]] = {
    "gate-2": _through_gate,
    "docks-6": _direct,
    "junction-4": _across_junction,
    "parking-8": _direct,
    "aisles-6": _by_cross_aisle,
    "haul-road-4": _along_haul_road,
    "roundabout-6": _round_ring,
    "apron-6": _round_apron,
}
"""Poses between start and goal, for each site."""
