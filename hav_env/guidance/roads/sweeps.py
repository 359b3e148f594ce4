"""This module checks drives of a whole chain: joints, and the distance of all bodies from walls.

The truck's rear axle follows straights and arcs exactly. The trailers follow the kinematics of the
general n-trailer (``hav_env.vehicles.off_axle``), integrated over the path by the midpoint rule.
Between two poses no point of a body is farther from both than half of its movement. So both poses
keep this half as well as the clearance. All guards also refuse what is not a number.
"""

import math
from typing import NamedTuple

import numpy as np

from hav_env.compiled import entry, kernel, rare_kernel
from hav_env.maths.dubins import pose_after_segment
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import point_segment_squared
from hav_env.maths.rectangles import nearest_on_rectangle, rectangle_gap
from hav_env.vehicles.off_axle import pull_unit

_STRIDE = 0.1  # [m] of the path, at most
_CURVED = 1.1  # path of a point over its chord, in a stride
_SOON = 0.1  # [m]: a wall is tested if so little more than half of a movement may be left


class SweptChain(NamedTuple):
    """A vehicle of U units, and scratch for its postures."""

    length: np.ndarray  # (U,) [m]
    offset: np.ndarray  # (U,) from a unit's axle to the hitch of its trailer behind it [m]
    limit: np.ndarray  # (U,) largest articulation of each trailer [rad]
    shape: np.ndarray  # (U, 3) half width, front and rear overhang [m]
    heading: np.ndarray  # (U,) scratch [rad]
    body: np.ndarray  # (U, 6) scratch: middle, cosine, sine, half length, half width
    corner: np.ndarray  # (U, 4, 2) scratch: corners of the bodies [m]
    free: np.ndarray  # (S,) scratch: movement up to which a wall surely stays clear [m]


class Ends(NamedTuple):
    """The poses and the postures at both ends of a drive."""

    start: np.ndarray  # (3,) x, y [m], heading [rad]
    start_bend: np.ndarray  # (U,) articulations [rad], that of the truck is 0
    goal_bend: np.ndarray  # (U,)
    tolerance: float
    """Largest difference of articulations at the end [rad]."""
    clearance: float
    """Least distance of bodies from walls [m]."""
    spare: float
    """Least distance of joints to their limits [rad]."""


@entry
def try_drives(first, last, chain, walls, ends, drives, found):
    """Find the first of some drives that is clear, keeps all joints and ends as wanted.

    Args:
        first: 0.
        last: 1, or 0 to do nothing.
        chain: the vehicle.
        walls: (S, 4) x1, y1, x2, y2 [m].
        ends: poses and postures at both ends.
        drives: (C, M, 2) curvature [1/m] and length [m] of each segment.
        found: (1,) int64, written: the index of the drive, -1 if there is none.
    """
    for _ in range(first, last):
        found[0] = -1
        for number in range(drives.shape[0]):
            if _is_clear(chain, walls, ends, drives[number]):
                found[0] = number
                break


@rare_kernel
def _is_clear(chain, walls, ends, drive):
    """Return whether a drive is clear, keeps all joints and ends as wanted."""
    units = chain.length.shape[0]
    x, y, heading = ends.start[0], ends.start[1], ends.start[2]
    before = 0.0
    for unit in range(units):
        before += ends.start_bend[unit]
        chain.heading[unit] = heading + before
    _place_bodies(chain, x, y)
    for s in range(chain.free.shape[0]):
        chain.free[s] = _SOON  # not tested yet: due at once
    moved = 0.0
    if not _keeps_clear(chain, walls, ends.clearance, moved, 0.0):
        return False
    for s in range(drive.shape[0]):
        curvature, length = drive[s, 0], drive[s, 1]
        steps = int(length / _STRIDE) + 1 if length > 0.0 else 0
        side = 0.0 if curvature == 0.0 else math.copysign(1.0, curvature)
        radius = 1.0 if curvature == 0.0 else 1.0 / abs(curvature)
        start_x, start_y, start = x, y, heading
        for step in range(1, steps + 1):
            x, y, heading = pose_after_segment(
                start_x, start_y, start, side, length * step / steps, radius
            )
            if not _pull_chain(chain, heading, curvature, length / steps, ends.spare):
                return False
            most = _place_bodies(chain, x, y)
            moved += _CURVED * most
            if not _keeps_clear(chain, walls, ends.clearance, moved, 0.5 * _CURVED * most):
                return False
    for unit in range(1, units):
        bend = chain.heading[unit] - chain.heading[unit - 1]
        if not abs(bend - ends.goal_bend[unit]) <= ends.tolerance:
            return False
    return True


@rare_kernel
def _pull_chain(chain, heading, curvature, distance, spare):
    """Move the chain behind its truck; return whether all joints keep their limits."""
    speed, rate = 1.0, curvature  # halfway, for each metre
    ahead = 0.5 * (chain.heading[0] + heading)
    chain.heading[0] = heading
    for unit in range(1, chain.length.shape[0]):
        own, length, offset = chain.heading[unit], chain.length[unit], chain.offset[unit - 1]
        speed, rate, ahead, chain.heading[unit] = pull_unit(
            own, ahead, speed, rate, offset, length, distance
        )
        bend = chain.heading[unit] - chain.heading[unit - 1]
        if not abs(bend) <= chain.limit[unit] - spare:
            return False
    return True


@rare_kernel
def _place_bodies(chain, x, y):
    """Write the bodies of the chain; return the largest movement of a corner [m]."""
    most = 0.0
    for unit in range(chain.length.shape[0]):
        sine, cosine = sincos(chain.heading[unit])
        if unit > 0:
            x -= chain.length[unit] * cosine
            y -= chain.length[unit] * sine
        width = chain.shape[unit, 0]
        front, rear = chain.length[unit] + chain.shape[unit, 1], chain.shape[unit, 2]
        middle, half = 0.5 * (front - rear), 0.5 * (front + rear)
        body = chain.body[unit]
        body[0], body[1] = x + middle * cosine, y + middle * sine
        body[2], body[3], body[4], body[5] = cosine, sine, half, width
        for number in range(4):
            along = half if number < 2 else -half
            aside = width if number % 2 == 0 else -width
            corner = chain.corner[unit, number]
            corner_x = body[0] + along * cosine - aside * sine
            corner_y = body[1] + along * sine + aside * cosine
            dx, dy = corner_x - corner[0], corner_y - corner[1]
            most = max(most, math.sqrt(dx * dx + dy * dy))
            corner[0], corner[1] = corner_x, corner_y
        x -= chain.offset[unit] * cosine
        y -= chain.offset[unit] * sine
    return most


@rare_kernel
def _keeps_clear(chain, walls, clearance, moved, between):
    """Return whether all bodies keep a distance from all walls, here and since the last pose.

    Args:
        chain: its bodies, and the movement up to which each wall surely stays clear.
        walls: (S, 4) x1, y1, x2, y2 [m].
        clearance: the distance [m].
        moved: movement so far [m].
        between: half of the movement since the last pose [m].
    """
    for s in range(walls.shape[0]):
        left = chain.free[s] - moved
        if not left > -between:  # the last pose was nearer than half of this movement
            return False
        if left <= between + _SOON:
            gap = math.inf
            for unit in range(chain.length.shape[0]):
                gap = min(gap, gap_of_body(chain.body[unit], chain.corner[unit], walls[s]))
            if not clearance + between < gap < math.inf:
                return False
            chain.free[s] = moved + gap - clearance
    return True


@rare_kernel
def gap_of_body(body, corner, wall):
    """Return the distance of a body from a wall [m], 0 if they touch.

    Args:
        body: (6,) a rectangle, see ``hav_env.maths.rectangles``.
        corner: (4, 2) its corners [m].
        wall: (4,) x1, y1, x2, y2 [m].
    """
    dx, dy = 0.5 * (wall[2] - wall[0]), 0.5 * (wall[3] - wall[1])
    half = math.sqrt(dx * dx + dy * dy)
    cosine, sine = (dx / half, dy / half) if half > 0.0 else (1.0, 0.0)
    rectangle = body[0], body[1], body[2], body[3], body[4], body[5]
    middle = 0.5 * (wall[0] + wall[2]), 0.5 * (wall[1] + wall[3])
    if rectangle_gap(rectangle, (middle[0], middle[1], cosine, sine, half, 0.0)) <= 0.0:
        return 0.0
    least = math.inf
    for k in range(4):
        least = min(
            least,
            point_segment_squared(corner[k, 0], corner[k, 1], wall[0], wall[1], wall[2], wall[3]),
        )
    for k in range(2):
        least = min(least, _squared_from(rectangle, wall[2 * k], wall[2 * k + 1]))
    return math.sqrt(least)


@kernel
def _squared_from(rectangle, x, y):
    """Return the squared distance [m^2] of a point from a rectangle."""
    near_x, near_y = nearest_on_rectangle(rectangle, x, y)
    return (near_x - x) * (near_x - x) + (near_y - y) * (near_y - y)
