"""This module makes drives between two poses by a third one: straights and two Dubins paths.

The third poses fill the space between both poses and the space round each of them evenly: they
follow the additive recurrence of Roberts (2018), "The Unreasonable Effectiveness of Quasirandom
Sequences". So all searches try the same drives.
"""

import math
from collections.abc import Sequence

import numpy as np

from hav_env.compiled import entry
from hav_env.guidance.roads.edges import (
    LONGEST_DRIVES,
    RADIUS_SHARES,
    SHORTEST_SEGMENT,
    RoadPose,
    straights_beside_turns,
)
from hav_env.guidance.roads.sweeps import SweptChain
from hav_env.maths.dubins import shortest_path, turns
from hav_env.maths.elementary import atan2, sincos
from hav_env.maths.geometry import TWO_PI, into_frame

_NUMBER = 2_000  # of third poses
_TIGHTEST = 0.96  # radius of the tightest turns, over the radius of the tightest on edges
_STRAIGHTS_BEFORE = 3  # how many of the straights may come first
_STEPS = (  # of the recurrence in seven dimensions: powers of the root of x^8 = x + 1, inverted
    *(0.9115923534820549, 0.8310006189269519, 0.7575338099526643, 0.690562028656977),
    *(0.629511064928756, 0.5738574732213994, 0.5231240845771608),
)
# of eight third poses, so many are between both poses, then so many round the goal; others are
# round the start
_FAMILIES, _BETWEEN, _AT_GOAL = 8, 4, 3
_BEYOND, _ASIDE = 0.2, (0.3, 2.0)  # shares of the distance; share of the distance, radii
_AROUND = 4.0  # radii
_SEGMENTS = 8


def detours(
    chains: Sequence[SweptChain], one: RoadPose, other: RoadPose, radius: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return drives (C, M, 2) between two poses by a third one, and their lengths; shortest first.

    Args:
        chains: Vehicles with one turning radius.
        one: Pose at the start.
        other: Pose at the end.
        radius: Radius of the tightest turns on edges [m].
    """
    straights = np.array(straights_beside_turns(chains))
    radii = radius * np.array([_TIGHTEST, *RADIUS_SHARES])
    points = np.mod(0.5 + np.outer(np.arange(1.0, _NUMBER + 1.0), np.array(_STEPS)), 1.0)
    table, lengths = np.zeros((_NUMBER, _SEGMENTS, 2)), np.zeros(_NUMBER)
    join_by_third(1, np.array(one), np.array(other), straights, radii, points, table, lengths)
    most = (
        LONGEST_DRIVES[0] * math.hypot(other.x - one.x, other.y - one.y)
        + LONGEST_DRIVES[1] * radius
    )
    order = np.argsort(lengths, kind="stable")
    order = order[(lengths <= most + table[:, 0, 1] + table[:, -1, 1])[order]]
    return table[order], lengths[order]


@entry
def join_by_third(first, last, start, goal, straights, radii, points, drives, lengths):
    """Join two poses by a straight, two Dubins paths that meet in a third pose, and a straight.

    Args:
        first: 0.
        last: 1, or 0 to do nothing.
        start: (4,) x, y [m], heading [rad], curvature [1/m].
        goal: (4,) likewise.
        straights: lengths of the straights [m].
        radii: radii of turns [m]; the second is that of the tightest on edges.
        points: (C, 7) from 0 to 1: choices of both straights and radii, and of the third pose.
        drives: (C, 8, 2) curvatures [1/m] and lengths [m], written.
        lengths: (C,) of the drives [m], written.
    """
    for _ in range(first, last):
        sine, cosine = sincos(start[2])
        goal_sine, goal_cosine = sincos(goal[2])
        dx, dy = goal[0] - start[0], goal[1] - start[1]
        apart, line = math.sqrt(dx * dx + dy * dy), atan2(dy, dx)
        line_sine, line_cosine = sincos(line)
        for number in range(points.shape[0]):
            point, drive, family = points[number], drives[number], number % _FAMILIES
            out = straights[int(point[0] * _STRAIGHTS_BEFORE)]
            back = straights[int(point[1] * straights.shape[0])]
            from_x, from_y = start[0] + out * cosine, start[1] + out * sine
            to_x, to_y = goal[0] - back * goal_cosine, goal[1] - back * goal_sine
            side, turned = 2.0 * point[5] - 1.0, 2.0 * point[6] - 1.0
            if family < _BETWEEN:
                along = ((1.0 + 2.0 * _BEYOND) * point[4] - _BEYOND) * apart
                aside = side * abs(side) * (_ASIDE[0] * apart + _ASIDE[1] * radii[1])
                x = start[0] + along * line_cosine - aside * line_sine
                y = start[1] + along * line_sine + aside * line_cosine
                heading = line + 0.5 * TWO_PI * turned * abs(turned)
            else:
                away = _AROUND * radii[1] * math.sqrt(point[4])
                from_sine, from_cosine = sincos(0.5 * TWO_PI * side)
                at_goal = family < _BETWEEN + _AT_GOAL
                x = (to_x if at_goal else from_x) + away * from_cosine
                y = (to_y if at_goal else from_y) + away * from_sine
                heading = 0.5 * TWO_PI * turned
            third_sine, third_cosine = sincos(heading)
            length = out + back
            for half in range(2):
                tail_x, tail_y = (from_x, from_y) if half == 0 else (x, y)
                head_x, head_y = (x, y) if half == 0 else (to_x, to_y)
                c, s = (cosine, sine) if half == 0 else (third_cosine, third_sine)
                turn = heading - start[2] if half == 0 else goal[2] - heading
                radius = radii[int(point[2 + half] * radii.shape[0])]
                forward, left = into_frame(head_x - tail_x, head_y - tail_y, c, s)
                path = shortest_path(forward, left, turn, radius)
                sides = turns(path[0])
                for k in range(3):
                    row = 1 + 3 * half + k
                    part = sides[0] if k == 0 else sides[1] if k == 1 else sides[2]
                    way = path[1] if k == 0 else path[2] if k == 1 else path[3]
                    drive[row, 0], drive[row, 1] = part / radius, way
                    length += way
            drive[0, 0], drive[0, 1] = 0.0, out
            drive[_SEGMENTS - 1, 0], drive[_SEGMENTS - 1, 1] = 0.0, back
            for k in range(drive.shape[0]):
                drive[k, 1] = drive[k, 1] if drive[k, 1] > SHORTEST_SEGMENT else 0.0
            lengths[number] = length
