"""This module searches a lattice of poses backwards from a goal: Dijkstra over drives on circles.

A node is a cell in x, y and heading, with the pose in it that the search reached. The search does
not round poses to cells: drives lead exactly from node to node. A node is direct if a Dubins path
from the middle of its cell to the goal keeps clear; its pose is that middle. All drives have one
length. So a first-in, first-out queue, merged with the direct nodes in order of length, replaces
the heap of Dijkstra's algorithm.
"""

import math
from typing import NamedTuple

import numpy as np

from hav_env.compiled import entry, rare_kernel
from hav_env.guidance.walls import path_keeps_clear
from hav_env.maths.dubins import LSL, RSR, shortest_path
from hav_env.maths.geometry import TWO_PI, into_frame

DRIVE_SIDES = (
    0,
    -1,
    1,
)  # of a drive: straight ahead, right, left; the first one wins a tie
IN_SIGHT, UNREACHED = 2, 3  # instead of a side
_OUTSIDE = -1
_MOST_STEPS = 255


class Drives(NamedTuple):
    """The drives from node to node, and their limits."""

    radius: float
    """Radius of the turns [m]."""
    step: float
    """Length of each drive [m]; a turn of this length turns by one heading cell."""
    clearance: float
    """Distance to keep from walls [m]."""
    direct: float
    """Length up to which Dubins paths count [m]."""
    directions: np.ndarray  # (2, H) cosine and sine of the headings
    backwards: np.ndarray  # (3, 2, H) from the end of a drive to its start [m], by side and heading


class Nodes(NamedTuple):
    """The ny * nx * H nodes after the search; the headings of a cell are contiguous."""

    length: np.ndarray  # from the node's pose to the goal [m]; inf: not reached
    x: np.ndarray  # of the node's pose [m]
    y: np.ndarray
    side: np.ndarray  # int8 of its drive: -1 right, 0 straight, 1 left; IN_SIGHT or UNREACHED
    steps: np.ndarray  # uint8, number of consecutive drives to that side, including the first
    queue: np.ndarray  # int32 scratch


@entry
def find_direct(first, last, site, drives, nodes, goal):
    """Find the direct nodes of a range of rows.

    Args:
        first: row of the range.
        last: the row after the range.
        site: the walls.
        drives: radius, clearance and greatest length.
        nodes: to be written.
        goal: (3,) x, y [m] and heading [rad], the first of the headings.
    """
    columns, headings = site.gaps.shape[1], drives.directions.shape[1]
    for i in range(first, last):
        y = site.grid.y + (i + 0.5) * site.grid.cell
        for j in range(columns):
            x = site.grid.x + (j + 0.5) * site.grid.cell
            dx, dy = goal[0] - x, goal[1] - y
            far = dx * dx + dy * dy > drives.direct * drives.direct
            if far or site.gaps[i, j] < drives.clearance:
                continue
            for k in range(headings):
                length = _see_goal(site, drives, x, y, k, dx, dy)
                if length < math.inf:
                    node = (i * columns + j) * headings + k
                    nodes.length[node], nodes.side[node] = length, IN_SIGHT
                    nodes.x[node], nodes.y[node] = x, y


@rare_kernel
def _see_goal(site, drives, x, y, heading, dx, dy):
    """Return the length of the Dubins path to the goal [m]; infinity if too long or not clear."""
    cosine, sine = drives.directions[0, heading], drives.directions[1, heading]
    forward, left = into_frame(dx, dy, cosine, sine)
    turn = -heading * (TWO_PI / drives.directions.shape[1])
    word, first, second, third = shortest_path(forward, left, turn, drives.radius)
    length = first + second + third
    counts = length <= drives.direct and path_keeps_clear(
        site, drives.clearance, x, y, cosine, sine, drives.radius, word, first, second, third
    )
    return length if counts else math.inf


@entry
def spread_backwards(first, last, site, drives, nodes, seeds):
    """Find the nodes from which drives lead to the seeds, on the shortest path.

    Args:
        first: 0.
        last: 1, or 0 to do nothing.
        site: the walls.
        drives: from node to node.
        nodes: written, except for the seeds.
        seeds: (K,) int64 nodes of known length, in ascending order of length.
    """
    for _ in range(first, last):
        length = nodes.length
        head = tail = taken = 0
        while taken < seeds.shape[0] or head < tail:
            from_seeds = head == tail
            if not from_seeds and taken < seeds.shape[0]:
                from_seeds = length[seeds[taken]] <= length[nodes.queue[head]]
            node = seeds[taken] if from_seeds else nodes.queue[head]
            if from_seeds:
                taken += 1
            else:
                head += 1
            for side in DRIVE_SIDES:
                before = _reach(site, drives, nodes, node, side)
                if before != _OUTSIDE:
                    nodes.queue[tail] = before
                    tail += 1


@rare_kernel
def _reach(site, drives, nodes, node, side):
    """Reach the node that begins a drive to a side which ends in the pose of another node.

    Returns:
        Index of the node; -1 if the search has reached it before, if it is outside the grid, or if
        the drive is not clear.
    """
    rows, columns = site.gaps.shape
    headings, grid = drives.directions.shape[1], site.grid
    k = node % headings
    x = nodes.x[node] + drives.backwards[side, 0, k]
    y = nodes.y[node] + drives.backwards[side, 1, k]
    j, i = math.floor((x - grid.x) / grid.cell), math.floor((y - grid.y) / grid.cell)
    if i < 0 or j < 0 or i >= rows or j >= columns:
        return _OUTSIDE
    k = (k - side) % headings
    before = (i * columns + j) * headings + k
    if nodes.length[before] < math.inf or not _drive_keeps_clear(site, drives, k, x, y, side):
        return _OUTSIDE
    nodes.length[before] = nodes.length[node] + drives.step
    nodes.x[before], nodes.y[before], nodes.side[before] = x, y, side
    goes_on = nodes.side[node] == side
    nodes.steps[before] = min(int(nodes.steps[node]) + 1, _MOST_STEPS) if goes_on else 1
    return before


@rare_kernel
def _drive_keeps_clear(site, drives, heading, x, y, side):
    """Return whether the drive from a pose to a side keeps clear."""
    word = RSR if side < 0 else LSL
    turned = 0.0 if side == 0 else drives.step
    cosine, sine = drives.directions[0, heading], drives.directions[1, heading]
    straight = drives.step - turned
    return path_keeps_clear(
        site, drives.clearance, x, y, cosine, sine, drives.radius, word, turned, straight, 0.0
    )
