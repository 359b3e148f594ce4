"""This module names the rows of scratch in which a HAV's observation is worked out.

Each row holds one number for every lane of a block. Rows of float32 keep lane loops of single
precision free of doubles, which would halve the number of lanes that an instruction works on.
"""

from typing import NamedTuple

import numpy as np

# of a path: side of its first segment, length of that segment and of the whole path [m]
TURN, FIRST, LENGTH = range(3)
TO_GOAL, TO_APPROACH = 0, 3
# the goal and the point before it in the truck's frame [m]; relative heading [rad], its direction
GOAL_FORWARD, GOAL_LEFT, APPROACH_FORWARD, APPROACH_LEFT = range(6, 10)
GOAL_HEADING, GOAL_COSINE, GOAL_SINE = range(10, 13)
# radii of the circles of the paths to the two points, truck's length [m]; steepest steering [rad]
DRIVABLE_RADIUS, STABLE_RADIUS, WHEELBASE, STEERING_MAX = range(13, 17)
# of a segment: the square of how far it is [m^2], its number; as seen from the truck its middle,
# and from there to one end [m]; which rays may meet it; directions of rays, which are no lanes
SEEN_SQUARED, SEEN_NUMBER, SEEN_X, SEEN_Y, SEEN_HALF_X, SEEN_HALF_Y = range(17, 23)
FIRST_RAY, RAY_COUNT, RAY_COSINE, RAY_SINE, SCRATCH_ROWS = range(23, 28)


class Scratch(NamedTuple):
    """The scratch of one HAV at a time, for the lanes of a block."""

    rows: np.ndarray
    """(SCRATCH_ROWS, L) float32."""
    chain: np.ndarray
    """(CHAIN_ROWS, L) for ``find_nearest_points``."""
