"""Outlines contain the included points, and gaps between them are at most Shapely's distance."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from hav_env.maths.geometry import segments_apart
from hav_env.maths.kdop import (
    SIDES,
    clear_outline,
    corner,
    include_both,
    include_disc,
    include_point,
    outline_gap,
    turn_outline,
)

# rounded: squares of numbers slightly above zero vanish
place = st.tuples(*[st.floats(-30.0, 30.0).map(lambda number: round(number, 9))] * 2)
disc = st.tuples(st.floats(-30.0, 30.0), st.floats(-30.0, 30.0), st.floats(0.01, 20.0))
content = st.tuples(st.lists(place, max_size=6), st.lists(disc, min_size=1, max_size=2))
ROUNDING = 1e-9  # [m]


def outline_of(points, discs, at=0) -> np.ndarray:
    rows = np.zeros(at + SIDES)
    clear_outline(rows, at)
    for point in points:
        include_point(rows, at, *point)
    for one in discs:
        include_disc(rows, at, *one)
    return rows


def polygon_of(rows, at=0):
    corners = [corner(rows, at, side) for side in range(SIDES)]
    return shapely.MultiPoint(corners).convex_hull.buffer(ROUNDING)


@given(content)
def test_an_outline_holds_all_that_was_included_and_little_more(included):
    points, discs = included
    polygon = polygon_of(outline_of(*included))
    assert all(polygon.covers(shapely.Point(point)) for point in points)
    round_parts = [shapely.Point(x, y).buffer(r, quad_segs=64) for x, y, r in discs]
    assert all(polygon.covers(part) for part in round_parts)
    hull = shapely.union_all([shapely.Point(p) for p in points] + round_parts).convex_hull
    size = shapely.minimum_bounding_radius(hull)
    # no corner is farther out than where two sides meet that touch the ends of one segment
    assert shapely.hausdorff_distance(polygon, hull) <= 2 * size * math.tan(math.pi / SIDES) + 0.01


@given(content, place, place)
def test_two_points_are_included_as_one_after_the_other(included, a, b):
    rows = np.concatenate([outline_of(*included)] * 2)
    include_both(rows, 0, *a, *b)
    include_point(rows, SIDES, *a)
    include_point(rows, SIDES, *b)
    assert np.array_equal(rows[:SIDES], rows[SIDES:])


@given(content, content)
def test_a_gap_is_no_wider_than_the_distance(one, other):
    rows = np.concatenate([outline_of(*one), outline_of(*other)])
    gap = outline_gap(rows, 0, SIDES)
    distance = shapely.distance(polygon_of(rows), polygon_of(rows, SIDES))
    assert gap <= distance + 3 * ROUNDING
    assert gap == pytest.approx(outline_gap(rows, SIDES, 0), abs=1e-12)


@given(content, place, st.floats(-4.0, 4.0))
def test_a_turned_outline_holds_the_one_that_was_turned(included, at, heading):
    cosine, sine = math.cos(heading), math.sin(heading)
    rows = outline_of(*included, at=SIDES)
    turn_outline(rows, 0, rows, SIDES, *at, cosine, sine)
    polygon = polygon_of(rows).buffer(ROUNDING)
    for side in range(SIDES):
        x, y = corner(rows, SIDES, side)
        moved = at[0] + x * cosine - y * sine, at[1] + y * cosine + x * sine
        assert polygon.covers(shapely.Point(moved))


@given(place, place, place, place, st.floats(0.0, 5.0))
def test_segments_are_apart_when_shapely_says_so(a, b, c, d, margin):
    distance = shapely.distance(shapely.LineString([a, b]), shapely.LineString([c, d]))
    if abs(distance - margin) > ROUNDING:
        assert segments_apart(*a, *b, *c, *d, margin) == (distance > margin)
