"""This module follows paths of arcs and straights, and returns the heading along them.

The paths are like Dubins words, but their arcs may have different radii. A HAV's memory holds a
path as segments, each with a curvature [1/m], positive to the left, and a length [m].
"""

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes
from hav_env.compiled import kernel, rare_kernel


@kernel
def append(rows, path, curvature, length):
    """Append a segment to a path, unless its length is 0."""
    count = int(rows[path + m.NUM_SEGMENTS])
    if length > 0.0:
        rows[path + m.CURVATURES + count] = curvature
        rows[path + m.LENGTHS + count] = length
        rows[path + m.NUM_SEGMENTS] = count + 1.0


@kernel
def total_length(rows, path):
    """Return the length of a path [m]."""
    total = 0.0
    for segment in range(int(rows[path + m.NUM_SEGMENTS])):
        total += rows[path + m.LENGTHS + segment]
    return total


@rare_kernel
def heading_at(rows, path, distance):
    """Return the change of heading [rad] along a path from its start to a distance [m]."""
    heading = 0.0
    for segment in range(int(rows[path + m.NUM_SEGMENTS])):
        if distance <= 0.0:
            break
        along = min(distance, rows[path + m.LENGTHS + segment])
        heading += rows[path + m.CURVATURES + segment] * along
        distance -= along
    return heading


@kernel
def copy_path(rows, path, source):
    """Copy the path ``source`` to the path ``path``."""
    for row in range(m.LENGTHS + sizes.MAX_SEGMENTS):
        rows[path + row] = rows[source + row]
