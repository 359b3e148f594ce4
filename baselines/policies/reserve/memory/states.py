"""This module numbers the states of a HAV under Reserve, and the purposes of its path.

The module ``multi_agent`` describes their transitions.
"""

# A HAV is in one of these states: the row ``MODE``.
STANDING = 0.0  # It has reserved nothing, and does not move.
RESERVED = 1.0  # It has reserved an outline, and moves only within that.
ARRIVED = 2.0  # It stops at its goal, within the outline that it has reserved.

# A path has one of these purposes: the row ``PURPOSE``.
GOAL_PATH = 0.0  # It leads to the goal.
PLACE_PATH = 1.0  # It leads to a random position, to give space to others.
CIRCLE_PATH = 2.0  # It is the circle that the HAV can drive on without end.
