"""Rectangles share a point, and have their nearest points, where Shapely finds them."""

import numpy as np
import pytest
import shapely

from hav_env.maths.rectangles import nearest_on_rectangle, rectangle_gap
from tests.support.budgets import budget

RNG = np.random.default_rng(16)
COUNT = budget(100_000, 5_000)


def rectangles(count, thinnest):
    """Return random rectangles (count, 6) near the origin, and their shapes."""
    angle = RNG.uniform(-np.pi, np.pi, count)
    sizes = RNG.uniform(thinnest, [6.0, 1.5], (count, 2))
    numbers = np.c_[RNG.uniform(-6, 6, (count, 2)), np.cos(angle), np.sin(angle), sizes]
    return numbers, shapely.polygons(corners_of(numbers))


def corners_of(numbers):
    """Return the corners (count, 4, 2)."""
    middle, along = numbers[:, :2], numbers[:, 2:4]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    return np.stack(
        [
            middle + one * numbers[:, 4:5] * along + other * numbers[:, 5:6] * across
            for one, other in ((1, 1), (1, -1), (-1, -1), (-1, 1))
        ],
        axis=1,
    )


@pytest.mark.parametrize("thinnest", [0.3, 1e-3])
def test_no_pair_differs_from_shapely(thinnest):
    (one, first), (other, second) = rectangles(COUNT, thinnest), rectangles(COUNT, thinnest)
    gap = np.array([rectangle_gap(*pair) for pair in zip(one, other, strict=True)])
    back = np.array([rectangle_gap(*pair) for pair in zip(other, one, strict=True)])
    np.testing.assert_allclose(gap, back, atol=1e-12)
    expected, distance = shapely.intersects(first, second), shapely.distance(first, second)
    clear = abs(gap) > 1e-9  # rounding decides where they just touch
    assert clear.mean() > 0.999
    assert 0.1 < expected.mean() < 0.9
    assert ((gap <= 0.0) == expected)[clear].all()
    assert (gap <= distance + 1e-9)[~expected].all()


def test_the_gap_is_the_distance_where_a_side_faces_a_corner():
    one, other = (0.0, 0.0, 1.0, 0.0, 2.0, 1.0), (0.5, 4.0, np.sqrt(0.5), np.sqrt(0.5), 1.0, 1.0)
    assert rectangle_gap(one, other) == pytest.approx(3.0 - np.sqrt(2.0), abs=1e-12)


def test_a_rectangle_without_width_is_a_segment_and_without_length_a_point():
    cross = (0.0, 0.0, 1.0, 0.0, 1.0, 0.0), (0.5, 0.0, 0.0, 1.0, 1.0, 0.0)
    assert rectangle_gap(*cross) <= 0.0
    assert rectangle_gap(cross[0], (0.5, 1e-9, 1.0, 0.0, 0.0, 0.0)) == pytest.approx(1e-9)
    assert rectangle_gap(cross[0], (0.5, 0.0, 1.0, 0.0, 0.0, 0.0)) <= 0.0


def test_nearest_points_are_shapelys():
    numbers, shapes = rectangles(COUNT // 5, 0.3)
    places = RNG.uniform(-9, 9, (len(numbers), 2))
    nearest = np.array(
        [nearest_on_rectangle(row, *place) for row, place in zip(numbers, places, strict=True)]
    )
    points = shapely.points(places)
    distance = np.hypot(*(nearest - places).T)
    np.testing.assert_allclose(distance, shapely.distance(shapes, points), atol=1e-9)
    assert (shapely.distance(shapes, shapely.points(nearest)) < 1e-9).all()
