"""This module lists the tight paths that a HAV may take, the shortest first.

Candidates are two arcs of different radii with a straight between them, and three arcs of one
radius. They lead to poses throughout the tolerance of the goal. Their lengths are computed for all
radii of the last arc side by side.
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes
from baselines.policies.reserve.memory.shortlist import insert
from baselines.policies.reserve.perception.own_state import sensed_goal
from baselines.policies.reserve.prediction.paths import append
from baselines.policies.reserve.prediction.trials import measure_last_turns
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.arcs import circles_path, tangent_path
from hav_env.maths.elementary import sincos

# Aims: forward and left of the goal [distance tolerances], turn to the left [heading tolerances].
_AIM_FORWARD = (-0.5, -0.2, -0.2, -0.5, -0.2, -0.2, -0.5, -0.2, -0.2)
_AIM_LEFT = (0.0, 0.7, -0.7, 0.0, 0.7, -0.7, 0.0, 0.7, -0.7)
_AIM_HEADING = (0.0, 0.0, 0.0, 0.9, 0.9, 0.9, -0.9, -0.9, -0.9)
AIMS = len(_AIM_HEADING)
_AIM_STRIDE = 3  # aims of which a HAV among others uses one: the heading matters most
_SIDE_PAIRS = 4  # left or right, then left or right
_TANGENTS = sizes.TURN_RADII * sizes.ENDINGS  # two arcs and a straight
PER_AIM = _TANGENTS + 2 * sizes.TURN_RADII  # candidates of an aim: those, and three arcs

_TRUCK_FACTOR = 1.0 + 1e-6  # of the truck's tightest radius: steering can follow despite rounding
_TRAILER_FACTOR = 1.001  # of the least radius of the trailers: they can follow without end
LAST_TURN_FACTOR = 1.1  # of the longest turn from a straight chain: it may be bent the other way


@rare_kernel
def write_radii(rows):
    """Write the radii of arcs, from the truck's tightest to one for the trailers.

    The curvatures are evenly spaced.
    """
    tightest = rows[m.OWN_TRUCK_RADIUS] * _TRUCK_FACTOR
    widest = max(_TRAILER_FACTOR * rows[m.OWN_TRAILER_RADIUS], tightest)
    for number in range(sizes.TURN_RADII):
        share = number / (sizes.TURN_RADII - 1.0)
        rows[m.RADII + number] = 1.0 / ((1.0 - share) / tightest + share / widest)


@rare_kernel
def write_endings(rows, factor):
    """Write the endings of candidates with a straight: the quantities of their last arc.

    Args:
        rows: The HAV's memory.
        factor: Longest last arc, over that of a straight chain.
    """
    for ending in range(sizes.ENDINGS):
        last, sides = ending // _SIDE_PAIRS, ending % _SIDE_PAIRS
        radius = rows[m.RADII + last]
        rows[m.ENDING_RADII + ending] = radius
        rows[m.ENDING_FIRST_SIDES + ending] = _first_side(sides)
        rows[m.ENDING_LAST_SIDES + ending] = _last_side(sides)
        rows[m.ENDING_LONGEST + ending] = factor * rows[m.LAST_TURNS + last] * radius


@rare_kernel
def list_shortest(policy, rows, beyond, most, stride, size):
    """List the shortest candidates.

    Args:
        policy: The Reserve.
        rows: The HAV's memory.
        beyond: Candidates are longer than that [m].
        most: Candidates are shorter than that [m].
        stride: Each aim of that many is used, from the first one.
        size: Most candidates in the list.

    Returns:
        The number of candidates in the list.
    """
    count = 0
    for aim in range(0, AIMS, stride):
        x, y, heading, cosine, sine = _aim(policy, rows, aim)
        for first in range(sizes.TURN_RADII):
            _measure_tangents(rows, x, y, heading, cosine, sine, first)
            number = aim * PER_AIM + first * sizes.ENDINGS
            count = _insert_measured(rows, count, beyond, most, number, sizes.ENDINGS, size)
        if stride > 1:
            continue
        _measure_circles(rows, x, y, heading)
        number = aim * PER_AIM + _TANGENTS
        count = _insert_measured(rows, count, beyond, most, number, 2 * sizes.TURN_RADII, size)
    return count


@rare_kernel
def measure_arcs(rows):
    """Measure the arcs of tight paths once, before the HAV writes slots into the same rows."""
    write_radii(rows)
    measure_last_turns(rows)
    write_endings(rows, 1.0)


@rare_kernel
def list_tight(policy, rows, most):
    """List the shortest tight paths to the goal that a HAV among others tries.

    Args:
        policy: The Reserve.
        rows: The HAV's memory.
        most: Candidates are shorter than that [m].

    Returns:
        Their number.
    """
    for number in range(sizes.TURN_RADII):
        longest = rows[m.LAST_TURNS + number]
        rows[m.FIRST_TURNS_LEFT + number], rows[m.FIRST_TURNS_RIGHT + number] = longest, longest
    return list_shortest(policy, rows, -1.0, most, _AIM_STRIDE, sizes.TIGHT_PATHS)


@kernel
def _first_side(sides):
    """Return the side of the first arc, 1.0 left, -1.0 right."""
    return 1.0 if sides < 2 else -1.0


@kernel
def _last_side(sides):
    """Return the side of the last arc, 1.0 left, -1.0 right."""
    return 1.0 if sides % 2 == 0 else -1.0


@rare_kernel
def _measure_tangents(rows, x, y, heading, cosine, sine, first):
    """Write the lengths [m] of candidates with a straight and one first radius, for all endings.

    The length is infinite if the chain cannot follow one of the arcs.
    """
    first_radius = rows[m.RADII + first]
    longest_left = rows[m.FIRST_TURNS_LEFT + first] * first_radius
    longest_right = rows[m.FIRST_TURNS_RIGHT + first] * first_radius
    for ending in range(sizes.ENDINGS):
        side = rows[m.ENDING_FIRST_SIDES + ending]
        a, b, c = tangent_path(
            *(side, rows[m.ENDING_LAST_SIDES + ending]),
            *(x, y, heading, cosine, sine),
            *(first_radius, rows[m.ENDING_RADII + ending]),
        )
        longest = longest_left if side > 0.0 else longest_right
        total = a + b + c
        cannot = (a > longest) | (c > rows[m.ENDING_LONGEST + ending])
        rows[m.TOTAL_LENGTHS + ending] = math.inf if cannot else total


@rare_kernel
def _measure_circles(rows, x, y, heading):
    """Write the lengths [m] of candidates of three arcs, for all radii: left, then right."""
    for number in range(sizes.TURN_RADII):
        radius = rows[m.RADII + number]
        a, b, c = circles_path(1.0, x, y, heading, radius)
        rows[m.TOTAL_LENGTHS + 2 * number] = a + b + c
        a, b, c = circles_path(-1.0, x, y, heading, radius)
        rows[m.TOTAL_LENGTHS + 2 * number + 1] = a + b + c


@rare_kernel
def _insert_measured(rows, count, beyond, most, number, measured, size):
    """Insert the candidates whose lengths have just been written into the list.

    Args:
        rows: The HAV's memory.
        count: Number of candidates in the list.
        beyond: Candidates are longer than that [m].
        most: Candidates are shorter than that [m].
        number: Number of the first candidate that was measured.
        measured: Number of candidates that were measured.
        size: Most candidates in the list.

    Returns:
        The number of candidates in the list afterwards.
    """
    for k in range(measured):
        total = rows[m.TOTAL_LENGTHS + k]
        if beyond < total < most:
            count = insert(rows, count, total, number + k, size)
    return count


@kernel
def _aim(policy, rows, aim):
    """Return a pose within the goal's tolerances: x, y [m], heading [rad], its cosine and sine."""
    x, y, heading = sensed_goal(rows)
    cosine, sine = rows[m.OWN_GOAL + 3], rows[m.OWN_GOAL + 4]
    forward = _AIM_FORWARD[aim] * policy.distance_tolerance
    left = _AIM_LEFT[aim] * policy.distance_tolerance
    x, y = x + forward * cosine - left * sine, y + forward * sine + left * cosine
    heading = heading + _AIM_HEADING[aim] * policy.heading_tolerance
    sine, cosine = sincos(heading)
    return x, y, heading, cosine, sine


@rare_kernel
def write_tight_path(policy, rows, number, path):
    """Write a candidate into the path that begins at the row ``path``."""
    aim, rest = number // PER_AIM, number % PER_AIM
    x, y, heading, cosine, sine = _aim(policy, rows, aim)
    rows[path + m.NUM_SEGMENTS] = 0.0
    if rest < _TANGENTS:
        pair, sides = rest // _SIDE_PAIRS, rest % _SIDE_PAIRS
        first_radius = rows[m.RADII + pair // sizes.TURN_RADII]
        last_radius = rows[m.RADII + pair % sizes.TURN_RADII]
        first_side, last_side = _first_side(sides), _last_side(sides)
        a, b, c = tangent_path(
            first_side, last_side, x, y, heading, cosine, sine, first_radius, last_radius
        )
        append(rows, path, first_side / first_radius, a)
        append(rows, path, 0.0, b)
        append(rows, path, last_side / last_radius, c)
    else:
        radius = rows[m.RADII + (rest - _TANGENTS) // 2]
        side = _last_side(rest)
        a, b, c = circles_path(side, x, y, heading, radius)
        append(rows, path, side / radius, a)
        append(rows, path, -side / radius, b)
        append(rows, path, side / radius, c)
