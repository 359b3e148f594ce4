"""Sites hold the given outlines; positions on them are those of Shapely."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from hav_env.models.checks import check_fields
from hav_env.places import (
    BOUNDARY,
    LINE,
    NOWHERE,
    POLYGON,
    Site,
    build_site,
    chains_of,
    is_inside,
)
from hav_env.places.areas import covered_area, free_area
from hav_env.places.contact import place_is_inside, touched_segment
from hav_env.places.site import MOST_SEGMENTS, join_outlines
from hav_env.world.chain import corners_of
from tests.places.shapes import CHAINS, POINTS, lines_of, stars
from tests.support.budgets import budget

SQUARE = [[0, 0], [10, 0], [10, 10], [0, 10]]


@settings(max_examples=budget(100, 30))
@given(stars(most=100.0), st.lists(stars(), max_size=3), st.lists(CHAINS, max_size=2), st.data())
def test_a_place_is_inside_where_shapely_has_it(boundary, polygons, lines, data):
    site = build_site(boundary, polygons, lines)
    free = shapely.Polygon(boundary).difference(
        shapely.union_all(list(map(shapely.Polygon, polygons)))
    )
    for x, y in data.draw(st.lists(POINTS, max_size=5)):
        if lines_of(site).distance(shapely.Point(x, y)) > 1e-9:
            inside = free.contains(shapely.Point(x, y))
            assert place_is_inside(site, x, y) == inside
            assert is_inside(site, x, y) == inside
    assert free_area(site).symmetric_difference(free).area < 1e-6


def test_holes_and_rings_in_holes_are_inside_in_turn():
    rings = [np.array([[-r, -r], [r, -r], [r, r], [-r, r], [-r, -r]]) for r in (9.0, 6.0, 3.0)]
    site = join_outlines([(POLYGON, rings), (LINE, [rings[0] * 3])])
    assert site.kind.tolist() == [POLYGON, LINE]
    inside = {r: place_is_inside(site, r, 0.1) for r in (1.0, 4.0, 7.0, 10.0, 30.0)}
    assert inside == {1.0: False, 4.0: True, 7.0: False, 10.0: True, 30.0: True}
    assert inside == {r: is_inside(site, r, 0.1) for r in inside}
    assert covered_area(site).area == pytest.approx(18**2 - 12**2 + 6**2)
    assert free_area(site) is None
    assert [len(points) for _, points in chains_of(site)] == [5, 5, 5, 5]


def test_the_area_of_a_ring_that_crosses_itself_is_what_it_surrounds_once():
    bow = build_site(polygons=[[[0, 0], [2, 2], [2, 0], [0, 2]]])
    assert covered_area(bow).area == pytest.approx(2.0)
    angles = 0.8 * math.pi * np.arange(5)
    star = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    pentagram = build_site(polygons=[star])
    assert place_is_inside(pentagram, 0.0, 0.0)
    lines = shapely.union_all(shapely.LineString([*star, star[0]]))
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(lines)))
    tips = [face for face in faces if not face.contains(shapely.Point(0, 0))]
    assert len(tips) == 5
    assert covered_area(pentagram).area == pytest.approx(sum(tip.area for tip in tips))


@settings(max_examples=budget(300, 60))
@given(
    st.lists(CHAINS, min_size=1, max_size=3),
    POINTS,
    st.floats(-4.0, 4.0),
    st.floats(0.1, 40.0),
    st.sampled_from([0.0, 1.25]),
)
def test_bodies_touch_what_they_share_a_point_with(chains, place, heading, length, half):
    site = build_site(lines=chains)
    shape = np.array([[half, 0.5 * half, half], [half, 0.0, 0.0]])
    lengths = np.array([length, 0.7 * length])
    corners = corners_of(shape, *place, heading + np.array([0.0, 0.4]), lengths)
    touched = touched_segment(site, corners)
    bodies = shapely.union_all([shapely.MultiPoint(body).convex_hull for body in corners])
    distance = bodies.distance(lines_of(site))
    # rounding decides if an end only just touches
    ends = shapely.MultiPoint(site.segment.reshape(-1, 2))
    rims = shapely.union_all([shapely.LinearRing(body) for body in corners])
    near = min(
        rims.distance(ends), lines_of(site).distance(shapely.MultiPoint(corners.reshape(-1, 2)))
    )
    if touched is None and near < 1e-9:
        return
    if touched is None:
        assert distance > 0.0
    else:  # for a touch, Shapely's result is only a rounding error
        ends = shapely.LineString(site.segment[touched].reshape(2, 2))
        assert bodies.distance(ends) < 1e-9


def test_points_and_lines_as_bodies_touch_what_they_lie_on():
    site = build_site(lines=[[[0, 0], [10, 0]]])
    line = np.array([[[11.0, 0], [15, 0], [15, 0], [11, 0]]])
    assert touched_segment(site, line) is None
    assert touched_segment(site, line - [1, 0]) == 0
    point = np.full((1, 4, 2), 5.0)
    assert touched_segment(site, point) is None
    assert touched_segment(site, point * [1, 0]) == 0
    assert touched_segment(site, point * [2.2, 0]) is None
    assert touched_segment(NOWHERE, line) is None


@given(stars(), CHAINS)
def test_outlines_come_back(ring, chain):
    site = build_site(ring, [ring], [chain])
    (kind, first), (_, second), (last, points) = chains_of(site)
    assert (kind, last) == (BOUNDARY, LINE)
    np.testing.assert_array_equal(first, second)
    np.testing.assert_array_equal(first, [*ring, ring[0]])
    np.testing.assert_array_equal(points, chain)
    np.testing.assert_allclose(site.bounds, lines_of(site).bounds)


def test_circles_are_held_by_their_polygons():
    site = build_site(circles=[[3, 4, 2]])
    polygon, circle = covered_area(site), shapely.Point(3, 4).buffer(2.0 - 1e-9, quad_segs=64)
    assert polygon.contains(circle)
    assert shapely.hausdorff_distance(polygon, circle) < 0.041
    assert site.num_segments == 16


def test_nothing_gives_nowhere():
    assert build_site() is NOWHERE
    assert NOWHERE.bounds == (math.inf, math.inf, -math.inf, -math.inf)
    assert chains_of(NOWHERE) == []
    assert is_inside(NOWHERE, 0.0, 0.0)
    assert place_is_inside(NOWHERE, 0.0, 0.0)
    check_fields("site", NOWHERE)


def test_corners_that_coincide_count_once():
    site = build_site([*SQUARE, [0, 10], [0, 0]])
    assert site.num_segments == 4


@pytest.mark.parametrize(
    ("given", "error", "message"),
    [
        ({"boundary": 5}, TypeError, "boundary is 5, but must be a list of points"),
        ({"boundary": "square"}, TypeError, "boundary is 'square', but must be a list"),
        ({"boundary": [[0, 0], [1, 1]]}, ValueError, "boundary is .* at least 3 different corners"),
        ({"boundary": [[0, 0], [1, 1], [0, 0]]}, ValueError, "at least 3 different corners"),
        (
            {"polygons": [SQUARE, []]},
            ValueError,
            r"polygons\[1\] is \[\], but must have at least 3",
        ),
        (
            {"polygons": [[[0, 0], [1, 1, 1], [2, 0]]]},
            TypeError,
            r"polygons\[0\]\[1\] is \[1, 1, 1\]",
        ),
        (
            {"polygons": [[[0, 0], [1, "1"], [2, 0]]]},
            TypeError,
            r"polygons\[0\]\[1\] is \[1, '1'\]",
        ),
        ({"polygons": [[[0, 0], [1, True], [2, 0]]]}, TypeError, r"\[1\] is \[1, True\]"),
        ({"lines": [[[0, 0]]]}, ValueError, r"lines\[0\] is .* at least 2 different points"),
        ({"lines": [[[0, 0], [0, 0]]]}, ValueError, "at least 2 different points"),
        ({"lines": [[[0, 0], [0, math.nan]]]}, ValueError, r"lines\[0\]\[1\] holds nan, but must"),
        ({"lines": [[[0, 0], [0, 2e8]]]}, ValueError, "at least -1e.08 m and at most 1e.08 m"),
        ({"lines": [[[0, 0], [0, 10**400]]]}, ValueError, r"lines\[0\]\[1\] holds 1000"),
        (
            {"circles": [[0, 0]]},
            TypeError,
            r"circles\[0\] is \[0, 0\], but must be \[x, y, radius\]",
        ),
        (
            {"circles": [[0, 0, 0]]},
            ValueError,
            r"circles\[0\] has radius 0, but must have one above",
        ),
        ({"circles": [[0, 0, math.inf]]}, ValueError, r"circles\[0\] holds inf"),
    ],
)
def test_what_is_no_outline_is_named(given, error, message):
    with pytest.raises(error, match=message) as told:
        build_site(**given)
    assert "\n" not in str(told.value)


def test_a_site_of_too_many_segments_is_refused():
    line = np.stack([np.arange(MOST_SEGMENTS + 2.0), np.zeros(MOST_SEGMENTS + 2)], axis=1)
    with pytest.raises(ValueError, match="100001 segments, but must have at most 100000"):
        build_site(lines=[line])


SEGMENTS, WHOLE = np.array([[0.0, 0, 1, 0], [0, 1, 1, 1]]), np.array([0, 1])


@pytest.mark.parametrize(
    ("fields", "error"),
    [
        ((SEGMENTS[0], WHOLE, WHOLE), ValueError),
        ((SEGMENTS[:, :3], WHOLE, WHOLE), ValueError),
        ((SEGMENTS * np.nan, WHOLE, WHOLE), ValueError),
        ((SEGMENTS * 1e9, WHOLE, WHOLE), ValueError),
        ((SEGMENTS, WHOLE[:1], WHOLE), ValueError),
        ((SEGMENTS, WHOLE[::-1], WHOLE), ValueError),
        ((SEGMENTS, WHOLE + 1, WHOLE), ValueError),
        ((SEGMENTS, WHOLE * 1.0, WHOLE), ValueError),
        ((SEGMENTS, WHOLE, WHOLE[:1]), ValueError),
        ((SEGMENTS, WHOLE, WHOLE + 2), ValueError),
        ((SEGMENTS, WHOLE, [0, 1]), TypeError),
        ((None, WHOLE, WHOLE), TypeError),
    ],
)
def test_a_site_that_was_not_built_is_checked(fields, error):
    check_fields("site", Site(SEGMENTS, WHOLE, WHOLE))
    with pytest.raises(error, match="site"):
        check_fields("site", Site(*fields))
