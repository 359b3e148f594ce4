"""This module lists candidates: numbered paths that may lead to a pose.

The first ones are Dubins words of three radii. The next ones consist of two Dubins words with a
random pose between them. The last resort are sequences of arcs and straights, in order of their
number, each with the shortest path to the pose behind it. They leave out only sequences finer than
their pieces, or longer than their sequences.
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes
from baselines.policies.reserve.memory.random_numbers import PLACES, random_key
from baselines.policies.reserve.prediction.paths import append
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.dubins import INFEASIBLE, RLR, shortest_path, turns, word_segments
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import TWO_PI, into_frame
from hav_env.maths.random_numbers import normal, uniform

_NUM_WORDS = 6  # Dubins words
_WORD_RADII = (1.0, 1.5, 2.5)  # of direct candidates [radii of the endless circle]: tight to wide
DIRECT = _NUM_WORDS * len(_WORD_RADII)  # candidates of one Dubins word

_DRAWS_PER_WAYPOINT = 8  # share, spread, 2 for each normal coordinate, heading; one is spare
# The largest standard deviation of a waypoint's place: the footprint, and
_SPREAD_CIRCLES = 2.0  # radii of the nose's circle: enough to drive round another HAV's circle
_SPREAD_SHARE = 0.3  # of the distance to the goal: a long path may lead farther round
_LENGTH_ROUNDING = 1e-6  # [m] far more than the rounding of lengths
_NEAR_GOAL_EVERY = 4  # candidates: one of these has its waypoint near the goal

_PIECE_KINDS = 3  # of a piece: arc to the right, straight, arc to the left
_PIECES = 7  # most pieces of a sequence: with the word behind it, it fills a path
_PIECE_LENGTHS = (0.4, 0.8, 1.6)  # [radii of the endless circle]: a small, a medium, a large turn
_NUM_LENGTHS = len(_PIECE_LENGTHS)
# The number of sequences: each length, with 0 to ``_PIECES`` pieces.
SEQUENCES = _NUM_LENGTHS * (_PIECE_KINDS ** (_PIECES + 1) - 1) // (_PIECE_KINDS - 1)


@rare_kernel
def write_candidate(rows, number, x, y, heading, most):
    """Write a candidate to a pose into ``TRIAL_PATH``.

    The path is empty if the candidate does not exist, or if straight lines already show that it is
    too long.

    Args:
        rows: The HAV's memory.
        number: Number of the candidate.
        x: Forward coordinate of the pose [m].
        y: Left coordinate of the pose [m].
        heading: Heading of the pose [rad].
        most: Length [m] from which a candidate is too long.
    """
    rows[m.TRIAL_PATH + m.NUM_SEGMENTS] = 0.0
    radius = rows[m.OWN_CIRCLE_RADIUS]
    if number < DIRECT:
        word = number % _NUM_WORDS
        radius *= _WORD_RADII[number // _NUM_WORDS]
        first, middle, last = word_segments(word, x, y, heading, radius)
        if first < INFEASIBLE:
            _append_word(rows, word, radius * first, radius * middle, radius * last, radius)
        return
    seed, episode, stream, draw = random_key(rows, PLACES, _DRAWS_PER_WAYPOINT * sizes.WAYPOINTS)
    draw += _DRAWS_PER_WAYPOINT * (number - DIRECT)
    front = rows[m.OWN_FRONT_RADIUS]
    share = uniform(seed, episode, stream, draw)
    distance = math.sqrt(x * x + y * y)
    spread = rows[m.OWN_FOOTPRINT] + _SPREAD_CIRCLES * front + _SPREAD_SHARE * distance
    spread *= uniform(seed, episode, stream, draw + 1)
    if number % _NEAR_GOAL_EVERY == 0:
        share, spread = 1.0, _SPREAD_CIRCLES * front
    via_x = share * x + spread * normal(seed, episode, stream, draw + 2)
    via_y = share * y + spread * normal(seed, episode, stream, draw + 4)
    rest = math.sqrt((x - via_x) * (x - via_x) + (y - via_y) * (y - via_y))
    # no path is shorter than a straight line, but for rounding
    if math.sqrt(via_x * via_x + via_y * via_y) + rest > most + _LENGTH_ROUNDING:
        return
    via_heading = TWO_PI * uniform(seed, episode, stream, draw + 6)
    word, first, middle, last = shortest_path(via_x, via_y, via_heading, radius)
    if first + middle + last + rest > most + _LENGTH_ROUNDING:
        return
    _append_word(rows, word, first, middle, last, radius)
    sine, cosine = sincos(via_heading)
    forward, left = into_frame(x - via_x, y - via_y, cosine, sine)
    word, first, middle, last = shortest_path(forward, left, heading - via_heading, radius)
    _append_word(rows, word, first, middle, last, radius)


@kernel
def _append_word(rows, word, first, middle, last, radius):
    """Append a Dubins word with segments of these lengths [m] to ``TRIAL_PATH``."""
    sides = turns(word)
    append(rows, m.TRIAL_PATH, sides[0] / radius, first)
    append(rows, m.TRIAL_PATH, sides[1] / radius if word >= RLR else 0.0, middle)
    append(rows, m.TRIAL_PATH, sides[2] / radius, last)


@rare_kernel
def write_sequence(rows, number, x, y, heading):
    """Write a sequence of pieces, and the shortest path from its end, into ``TRIAL_PATH``.

    Args:
        rows: The HAV's memory.
        number: Number of the sequence, below ``SEQUENCES``. Sequences of few pieces come first.
        x: Forward coordinate of the pose at the end [m].
        y: Left coordinate of the pose at the end [m].
        heading: Heading of the pose at the end [rad].
    """
    rows[m.TRIAL_PATH + m.NUM_SEGMENTS] = 0.0
    radius = rows[m.OWN_CIRCLE_RADIUS]
    length = radius * _PIECE_LENGTHS[number % _NUM_LENGTHS]
    rest = number // _NUM_LENGTHS
    via_x, via_y, via_heading = 0.0, 0.0, 0.0
    while rest > 0:
        side = (rest - 1) % _PIECE_KINDS - 1.0
        rest = (rest - 1) // _PIECE_KINDS
        append(rows, m.TRIAL_PATH, side / radius, length)
        half = 0.5 * side * length / radius
        sine, cosine = sincos(half)
        chord = length if side == 0.0 else length * sine / half
        sine, cosine = sincos(via_heading + half)
        via_x, via_y = via_x + chord * cosine, via_y + chord * sine
        via_heading += 2.0 * half
    sine, cosine = sincos(via_heading)
    forward, left = into_frame(x - via_x, y - via_y, cosine, sine)
    word, first, middle, last = shortest_path(forward, left, heading - via_heading, radius)
    _append_word(rows, word, first, middle, last, radius)
