"""Paths that may lead to a pose, each with a number.

The first are Dubins words of three radii; then come two words by way of a random place. Where none
of them serves, all sequences of arcs and straights are gone through in order, each with the
shortest path to the pose behind it: a last resort that leaves nothing out but what is finer than
its pieces, or longer than its sequences.
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

DIRECT = 18  # six words, three radii
_DRAWS = 8  # random numbers of a way by a random place
_PIECES = 7  # of a sequence
# up to the last sequence of so many pieces, each of three kinds
SEQUENCES = 3 * (3 ** (_PIECES + 1) - 1) // 2


@rare_kernel
def write_candidate(rows, number, x, y, heading):
    """Write one candidate into ``TRIAL_PATH``: empty when there is none."""
    rows[m.TRIAL_PATH + m.NUM_SEGMENTS] = 0.0
    radius = rows[m.OWN_CIRCLE_RADIUS]
    if number < DIRECT:
        word, size = number % 6, number // 6
        radius *= 1.0 if size == 0 else (1.5 if size == 1 else 2.5)
        first, middle, last = word_segments(word, x, y, heading, radius)
        if first < INFEASIBLE:
            _append_word(rows, word, radius * first, radius * middle, radius * last, radius)
        return
    seed, episode, stream, draw = random_key(rows, PLACES, _DRAWS * sizes.WAYPOINTS)
    draw += _DRAWS * (number - DIRECT)
    front = rows[m.OWN_FRONT_RADIUS]
    share = uniform(seed, episode, stream, draw)
    distance = math.sqrt(x * x + y * y)
    spread = (rows[m.OWN_FOOTPRINT] + 2.0 * front + 0.3 * distance) * uniform(
        seed, episode, stream, draw + 1
    )
    if number % 4 == 0:  # near the goal
        share, spread = 1.0, 2.0 * front
    via_x = share * x + spread * normal(seed, episode, stream, draw + 2)
    via_y = share * y + spread * normal(seed, episode, stream, draw + 4)
    via_heading = TWO_PI * uniform(seed, episode, stream, draw + 6)
    word, first, middle, last = shortest_path(via_x, via_y, via_heading, radius)
    _append_word(rows, word, first, middle, last, radius)
    sine, cosine = sincos(via_heading)
    forward, left = into_frame(x - via_x, y - via_y, cosine, sine)
    word, first, middle, last = shortest_path(forward, left, heading - via_heading, radius)
    _append_word(rows, word, first, middle, last, radius)


@kernel
def _append_word(rows, word, first, middle, last, radius):
    sides = turns(word)
    append(rows, m.TRIAL_PATH, sides[0] / radius, first)
    append(rows, m.TRIAL_PATH, sides[1] / radius if word >= RLR else 0.0, middle)
    append(rows, m.TRIAL_PATH, sides[2] / radius, last)


@rare_kernel
def write_sequence(rows, number, x, y, heading):
    """Write a sequence of pieces, and the shortest path from its end, into ``TRIAL_PATH``.

    Args:
        number: below ``SEQUENCES``: short sequences come first, each with pieces of three lengths.
        x, y, heading: where the path is to end [m, rad].
    """
    rows[m.TRIAL_PATH + m.NUM_SEGMENTS] = 0.0
    radius = rows[m.OWN_CIRCLE_RADIUS]
    size = number % 3
    length = radius * (0.4 if size == 0 else (0.8 if size == 1 else 1.6))
    rest = number // 3
    via_x, via_y, via_heading = 0.0, 0.0, 0.0
    while rest > 0:
        side = (rest - 1) % 3 - 1.0
        rest = (rest - 1) // 3
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
