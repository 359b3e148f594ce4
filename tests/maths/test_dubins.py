"""Dubins paths end at their goal, and no path with the same largest curvature is shorter."""

import cmath
import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.optimize import brentq

from hav_env.maths.dubins import (
    WORDS,
    path_length,
    pose_on_path,
    shortest_path,
    turns,
    word_segments,
)
from tests.support.budgets import budget

RNG = np.random.default_rng(4)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)

places = st.floats(-20.0, 20.0, allow_subnormal=False)
headings = st.floats(-math.pi, math.pi, allow_subnormal=False)
radii = st.floats(0.5, 8.0)
goals = st.tuples(places, places, headings)


def random_goals(count, size=6.0):
    return np.column_stack([RNG.uniform(-size, size, (count, 2)), RNG.uniform(-9, 9, count)])


def drive(curvatures, lengths):
    """Integrate a path by quadrature: return its end (complex) and heading."""
    place, heading = 0j, 0.0
    for curvature, length in zip(curvatures, lengths, strict=True):
        on_way = 0.5 * length * (NODES + 1.0)
        place += 0.5 * length * (WEIGHTS * np.exp(1j * (heading + curvature * on_way))).sum()
        heading += curvature * length
    return place, heading


def assert_same_pose(place, heading, goal, tolerance=1e-9):
    assert abs(place - complex(goal[0], goal[1])) < tolerance
    assert abs(cmath.exp(1j * heading) - cmath.exp(1j * goal[2])) < tolerance


def lengths_of(word, goal, radius):
    """Return the segments [m] of a word, or None if it does not reach the goal."""
    first, second, third = word_segments(word, *goal, radius)
    return None if math.isinf(first) else (first * radius, second * radius, third * radius)


@pytest.mark.parametrize("word", range(6), ids=WORDS)
@given(goal=goals, radius=radii)
def test_every_word_that_is_feasible_ends_at_the_goal(word, goal, radius):
    lengths = lengths_of(word, goal, radius)
    assume(lengths is not None)
    assert min(lengths) >= 0.0
    curvatures = [turn / radius for turn in turns(word)]
    assert_same_pose(*drive(curvatures, lengths), goal)
    forward, left, heading = pose_on_path(word, *lengths, radius, sum(lengths))
    assert_same_pose(complex(forward, left), heading, goal)


@given(goals, radii)
def test_the_shortest_path_is_the_shortest_word(goal, radius):
    word, *lengths = shortest_path(*goal, radius)
    others = [lengths_of(other, goal, radius) for other in range(6)]
    assert min(sum(each) for each in others if each) == pytest.approx(sum(lengths), abs=1e-9)
    assert lengths == pytest.approx(lengths_of(word, goal, radius), abs=1e-7)
    assert path_length(*goal, radius) == sum(lengths)


def test_every_word_is_the_shortest_somewhere_and_named_by_its_turns():
    shortest = {shortest_path(*goal, 1.5)[0] for goal in random_goals(2_000)}
    assert shortest == set(range(6))
    for word, letters in enumerate(WORDS):
        assert turns(word) == tuple("RSL".index(letter) - 1.0 for letter in letters)


# An oracle without a closed form: it searches the first arc numerically, on the condition that the
# rest (straight or arc, then arc) can end in the goal's heading at the goal.


def after(place, heading, side, angle):
    """Drive an arc of radius 1."""
    return place + side * 1j * (cmath.exp(1j * heading) - np.exp(1j * (heading + side * angle)))


def candidates(goal):
    """Yield the lengths of all paths of two arcs round a straight or an arc, radius 1."""
    end, end_heading = complex(goal[0], goal[1]), goal[2]
    grid = np.linspace(0.0, math.tau, 721)
    for first, last in itertools.product([1, -1], repeat=2):
        centre = end + last * 1j * cmath.exp(1j * end_heading)

        def straight_misses(angle, first=first, last=last, centre=centre):
            """Return by how much the tangent after the first arc misses the goal's circle."""
            to_centre = centre - after(0j, 0.0, first, angle)
            return (to_centre * np.exp(-1j * first * angle)).imag - last

        for angle in roots(straight_misses, grid):
            heading = first * angle
            to_centre = (centre - after(0j, 0.0, first, angle)) * cmath.exp(-1j * heading)
            if to_centre.real >= 0.0:
                yield angle + to_centre.real + (last * (end_heading - heading)) % math.tau

        if first != last:
            continue

        def arc_misses(angle, first=first, centre=centre):
            """Return how far the circle of the second arc is from touching the goal's circle."""
            place = after(0j, 0.0, first, angle)
            middle = place - first * 1j * np.exp(1j * first * angle)
            return abs(centre - middle) - 2.0

        for angle in roots(arc_misses, grid):
            place = after(0j, 0.0, first, angle)
            middle = place - first * 1j * cmath.exp(1j * first * angle)
            touching = 0.5 * (middle + centre)
            turned = cmath.phase((touching - middle) / (place - middle))
            second = (-first * turned) % math.tau
            heading = first * (angle - second)
            yield angle + second + (last * (end_heading - heading)) % math.tau


def roots(function, grid):
    values = function(grid)
    for k in np.flatnonzero(values[:-1] * values[1:] <= 0.0):
        yield brentq(function, grid[k], grid[k + 1], xtol=1e-13)


@pytest.mark.parametrize("size", [1.0, 2.5, 8.0])
def test_a_search_over_first_arcs_finds_the_same_shortest_length(size):
    for goal in random_goals(budget(100, 30), size):
        assert path_length(*goal, 1.0) == pytest.approx(min(candidates(goal)), abs=1e-7)


@given(
    st.lists(st.tuples(st.floats(-1.0, 1.0), st.floats(0.01, 4.0)), min_size=1, max_size=6), radii
)
def test_no_path_that_turns_as_little_is_shorter(segments, radius):
    curvatures, lengths = zip(*segments, strict=True)
    place, heading = drive([curvature / radius for curvature in curvatures], lengths)
    # rounding may miss paths at the limit of a word: avoid it
    assume(all(abs(curvature) < 0.999 for curvature in curvatures))
    assert path_length(place.real, place.imag, heading, radius) <= sum(lengths) + 1e-6


ARCS = [0.0, 0.3, 1.0, math.pi / 2, 2.5, math.pi, 4.0, 6.0]


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("angle", ARCS)
@pytest.mark.parametrize("radius", [0.7, 1.0, 9.0])
def test_a_goal_on_the_own_circle_is_reached_along_it(side, angle, radius):
    place, heading = drive([side / radius], [angle * radius])
    length = path_length(place.real, place.imag, heading, radius)
    assert length == pytest.approx(angle * radius, abs=1e-9)


@pytest.mark.parametrize("distance", [0.0, 1e-9, 0.5, 1.0, 3.99, 4.0, 1e6])
def test_straight_ahead_is_straight(distance):
    word, first, second, third = shortest_path(distance, 0.0, 0.0, 2.0)
    if distance:
        assert turns(word)[1] == 0
    assert (first, second, third) == (0.0, distance, 0.0)


@pytest.mark.parametrize("turns", [-2, -1, 1, 2])
@pytest.mark.parametrize("distance", [0.0, 3.0])
def test_whole_turns_of_the_goal_change_nothing(distance, turns):
    assert path_length(distance, 0.0, turns * math.tau, 2.0) == pytest.approx(distance, abs=1e-12)


THIRD = math.pi / 3


@pytest.mark.parametrize(
    ("goal", "length"),
    [
        ((0.0, 2.0, math.pi), math.pi),  # opposite, one circle away
        ((0.0, -2.0, -math.pi), math.pi),
        ((0.0, 0.0, math.pi), 7 * THIRD),  # about turn: 60, 300 and 60 degrees
        ((-4.0, 0.0, math.pi), 4.0 + 7 * THIRD),  # drive past and about turn, or the reverse
        ((0.0, 4.0, math.pi), 2.0 + math.pi),  # round two circles and a straight
        ((0.0, 4.0, 0.0), math.tau),  # half a circle and half a circle
        ((2.0, 2.0, 0.0), math.pi),  # a quarter and a quarter
        ((0.0, 2.0, 0.0), None),  # within two radii
        ((0.5, 0.3, 2.0), None),
        ((-1.0, 0.0, 0.0), None),  # behind
        ((-3.0, 0.0, 0.0), None),
        ((-1e-3, 0.0, 0.0), None),
    ],
)
@pytest.mark.parametrize("radius", [0.5, 1.0, 7.0])
def test_special_goals_are_reached_by_the_known_length(goal, length, radius):
    found = path_length(radius * goal[0], radius * goal[1], goal[2], radius) / radius
    if length is None or goal[0] == -4.0:
        oracle = min(candidates(goal))
        assert found == pytest.approx(oracle, abs=1e-7)
    else:
        assert found == pytest.approx(length, abs=1e-9)


@pytest.mark.parametrize("first_side", [1, -1])
@pytest.mark.parametrize("radius", [0.7, 1.0, 9.0])
def test_two_arcs_are_not_made_longer_by_rounding(first_side, radius):
    arcs = [first_side / radius, -first_side / radius]
    for first, second in itertools.product([0.4, 1.0, 1.5], [0.3, 0.9, 1.4]):
        place, heading = drive(arcs, [first * radius, second * radius])
        length = path_length(place.real, place.imag, heading, radius)
        assert length <= radius * (first + second) * (1.0 + 1e-6), (first, second)


@given(goals, radii)
def test_the_mirror_image_is_as_long(goal, radius):
    forward, left, heading = goal
    assert path_length(forward, -left, -heading, radius) == pytest.approx(
        path_length(*goal, radius), abs=1e-9
    )


@pytest.mark.parametrize("goal", random_goals(20, 10.0))
@pytest.mark.parametrize("radius", [0.3, 1.0, 4.0])
def test_the_way_back_with_both_headings_reversed_is_as_long(goal, radius):
    # the start as seen from the goal, with both turned about
    start = -complex(goal[0], goal[1]) * cmath.exp(-1j * (goal[2] + math.pi))
    back = path_length(start.real, start.imag, -goal[2], radius)
    assert back == pytest.approx(path_length(*goal, radius), abs=1e-9)


@pytest.mark.parametrize("goal", random_goals(20, 10.0))
@pytest.mark.parametrize("scale", [1e-3, 3.0, 1e4])
def test_a_larger_plane_has_longer_paths(goal, scale):
    forward, left, heading = goal
    scaled = shortest_path(scale * forward, scale * left, heading, 2.0 * scale)
    word, *lengths = shortest_path(*goal, 2.0)
    assert scaled[0] == word
    assert np.array(scaled[1:]) == pytest.approx(scale * np.array(lengths), rel=1e-9)


@given(goals, radii, st.floats(-0.5, 1.5))
def test_a_pose_on_the_path_is_as_far_from_the_goal_as_is_left_of_the_path(goal, radius, share):
    word, *lengths = shortest_path(*goal, radius)
    total = sum(lengths)
    forward, left, heading = pose_on_path(word, *lengths, radius, share * total)
    done = min(max(share, 0.0), 1.0) * total
    edges = np.concatenate([[0.0], np.cumsum(lengths)])
    driven = np.diff(np.minimum(edges, done))
    place, there = drive([turn / radius for turn in turns(word)], driven)
    assert_same_pose(complex(forward, left), heading, (place.real, place.imag, there), 1e-8)
