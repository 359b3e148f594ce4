"""This module names the scratch rows in which kernels compute the observation of a HAV.

Each row holds one number for every lane of a block. Float32 rows keep single-precision lane loops
free of doubles, which would halve the number of lanes per instruction.
"""

from typing import NamedTuple

import numpy as np

# of a path: side and length of its first segment, length of the whole path [m]
TURN, FIRST, LENGTH = range(3)
TO_GOAL, TO_APPROACH = 0, 3
# the goal and the point before it in the truck's frame [m]; the next rows hold the relative heading
# [rad] and its direction
GOAL_FORWARD, GOAL_LEFT, APPROACH_FORWARD, APPROACH_LEFT = range(6, 10)
GOAL_HEADING, GOAL_COSINE, GOAL_SINE = range(10, 13)
# radii of the circles of the paths to the two points, truck's length [m]; maximum steering [rad]
DRIVABLE_RADIUS, STABLE_RADIUS, WHEELBASE, STEERING_MAX = range(13, 17)
# of a segment: squared distance [m^2], index
SEEN_SQUARED, SEEN_NUMBER = 17, 18
# the curvature that keeps to the route if it is held for the next metre, left positive [1/m]
HELD_CURVATURE, SCRATCH_ROWS = range(19, 21)


class Scratch(NamedTuple):
    """Scratch of one HAV at a time, for the lanes of a block."""

    rows: np.ndarray
    """(SCRATCH_ROWS, L) float32."""
    chain: np.ndarray
    """(CHAIN_ROWS, L) for ``find_nearest_points``."""
