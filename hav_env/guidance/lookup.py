"""This module reads a lattice: the length that is left from a pose, and the turn to begin with.

The kernels are scalar functions of floats; loops over lanes may call them, for one table serves all
lanes. A pose lies between eight nodes: two in x, two in y, two headings. Those that are not reached
do not count. Where none is, the length is infinite, and the turn straight ahead and of no length.
"""

import math

from hav_env.compiled import kernel
from hav_env.guidance.search import IN_SIGHT, UNREACHED
from hav_env.maths.dubins import shortest_path, turns
from hav_env.maths.elementary import floor, sincos
from hav_env.maths.geometry import TWO_PI, into_frame

_NEGLIGIBLE = 1e-3  # [m], a segment of a Dubins path that is none


@kernel
def _look_round(table, x, y, heading):
    """Return what the nodes round a pose say.

    Returns:
        (length, direct, side, steps): the mean of the lengths [m], weighed as linear interpolation
        does; whether all are direct; side and steps of the nearest node that is reached.
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
    """Return the length of the drive that is left to the goal [m].

    It is that of the Dubins path from the very pose where all nodes round it are direct. Elsewhere
    it is interpolated linearly; nodes that are not reached do not count.

    Args:
        table: a ``LatticeTable``.
        x: of the truck's rear axle [m].
        y: of it [m].
        heading: of the truck [rad].
    """
    length, direct, _, _ = _look_round(table, x, y, heading)
    _, first, second, third = _path_to_goal(table, x, y, heading)
    return first + second + third if direct else length


@kernel
def lattice_turn(table, x, y, heading):
    """Return the side to which the drive begins, and how long it stays [m].

    It is that of the nearest node that is reached. Where that is direct, it is the first segment of
    the Dubins path from the very pose, which then has to be driven to its end. From the pose of a
    node, turns that are driven one after the other for their whole lengths end exactly in the goal.
    A truck that asks again before the end of a turn may meet nodes with other turns, and make
    detours.

    Args:
        table: a ``LatticeTable``.
        x: of the truck's rear axle [m].
        y: of it [m].
        heading: of the truck [rad].

    Returns:
        (side, length): 1.0 left, -1.0 right, 0.0 straight.
    """
    _, _, side, steps = _look_round(table, x, y, heading)
    word, first, second, third = _path_to_goal(table, x, y, heading)
    one, two, three = turns(word)
    towards = two if second >= _NEGLIGIBLE else three
    towards = one if first >= _NEGLIGIBLE else towards
    length = second if second >= _NEGLIGIBLE else third
    length = first if first >= _NEGLIGIBLE else length
    stays = steps * (table.radius * TWO_PI / table.length.shape[2])
    known = side != UNREACHED
    side, stays = (side * 1.0 if known else 0.0), (stays if known else 0.0)
    return (towards, length) if side == IN_SIGHT else (side, stays)
