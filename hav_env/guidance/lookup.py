"""This module looks up in a lattice the remaining length from a pose, and the first turn.

The kernels are scalar functions of floats. Loops over lanes may call them, because one table serves
all lanes. A pose lies between eight nodes: two in x, two in y, two headings. Unreached nodes do not
count. If all eight are unreached, the length is infinite, and the turn is straight ahead with a
length of 0.
"""

import math

from hav_env.compiled import kernel
from hav_env.guidance.search import IN_SIGHT, UNREACHED
from hav_env.guidance.segments import segment_to_begin_with
from hav_env.maths.dubins import shortest_path
from hav_env.maths.elementary import floor, sincos
from hav_env.maths.geometry import TWO_PI, into_frame


@kernel
def _look_round(table, x, y, heading):
    """Interpolate the nodes around a pose.

    Returns:
        (length, direct, side, steps): the linearly interpolated length [m]; whether all reached
        nodes are direct; side and steps of the nearest reached node.
    """
    rows, columns, headings = table.length.shape
    per_cell = 1.0 / table.grid.cell
    u, v = (x - table.grid.x) * per_cell - 0.5, (y - table.grid.y) * per_cell - 0.5
    turned = (heading - table.goal[2]) * (headings / TWO_PI)
    west, south, right = floor(u), floor(v), floor(turned)
    east, north, left = u - west, v - south, turned - right
    j, i = int(west), int(south)
    k = int(right - headings * floor(right / headings))
    total, mean, direct, most, side, steps = 0.0, 0.0, True, 0.0, UNREACHED, 0
    for corner in range(8):
        a, b, c = corner & 1, (corner >> 1) & 1, corner >> 2
        inside = (i + a >= 0) & (i + a < rows) & (j + b >= 0) & (j + b < columns)
        row, column = min(max(i + a, 0), rows - 1), min(max(j + b, 0), columns - 1)
        turn = k + c - headings if k + c >= headings else k + c
        weight = (north if a else 1.0 - north) * (east if b else 1.0 - east)
        weight = weight * (left if c else 1.0 - left)
        found, its_side = table.length[row, column, turn], table.side[row, column, turn]
        counts = inside & (its_side != UNREACHED)
        weight = weight if counts else 0.0
        total += weight
        mean += weight * (found if counts else 0.0)
        direct = direct & ((its_side == IN_SIGHT) | (not counts))
        nearer = weight > most
        side = its_side if nearer else side
        steps = table.steps[row, column, turn] if nearer else steps
        most = max(most, weight)
    return mean / total if total > 0.0 else math.inf, direct & (total > 0.0), side, steps


@kernel
def _path_to_goal(table, x, y, heading):
    """Return ``shortest_path`` from a pose to the goal."""
    sine, cosine = sincos(heading)
    forward, left = into_frame(table.goal[0] - x, table.goal[1] - y, cosine, sine)
    return shortest_path(forward, left, table.goal[2] - heading, table.radius)


@kernel
def lattice_length(table, x, y, heading):
    """Return the remaining length of the drive to the goal [m].

    If all nodes around the pose are direct, it is the length of the Dubins path from the exact
    pose. Otherwise it is interpolated linearly; unreached nodes do not count.

    Args:
        table: a ``LatticeTable``.
        x: x of the truck's rear axle [m].
        y: y of the truck's rear axle [m].
        heading: heading of the truck [rad].
    """
    length, direct, _, _ = _look_round(table, x, y, heading)
    _, first, second, third = _path_to_goal(table, x, y, heading)
    return first + second + third if direct else length


@kernel
def lattice_turn(table, x, y, heading):
    """Return the side of the first turn of the drive to the goal, and its length [m].

    It is the turn of the nearest reached node. If this node is direct, it is the first segment of
    the Dubins path from the exact pose; the truck must then drive this path to its end. From the
    pose of a node, a truck that drives each turn for its whole length ends exactly in the goal. A
    truck that looks up the turn again before its end may get turns of other nodes, and make
    detours.

    Args:
        table: a ``LatticeTable``.
        x: x of the truck's rear axle [m].
        y: y of the truck's rear axle [m].
        heading: heading of the truck [rad].

    Returns:
        (side, length): 1.0 left, -1.0 right, 0.0 straight.
    """
    _, _, side, steps = _look_round(table, x, y, heading)
    word, first, second, third = _path_to_goal(table, x, y, heading)
    towards, length = segment_to_begin_with(word, first, second, third)
    stays = steps * (table.radius * TWO_PI / table.length.shape[2])
    known = side != UNREACHED
    side, stays = (side * 1.0 if known else 0.0), (stays if known else 0.0)
    return (towards, length) if side == IN_SIGHT else (side, stays)
