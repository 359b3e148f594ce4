"""Positions that the guidance considers clear are clear by Shapely's measure."""

import math

import numpy as np
import pytest
import shapely

from hav_env.guidance import clearance_of
from hav_env.guidance.walls import (
    CHECKED_EVERY,
    Grid,
    Walls,
    gap_of_point,
    lay_grid,
    measure_gaps,
    path_keeps_clear,
)
from hav_env.maths.dubins import shortest_path, turns
from tests.guidance.sites import drive, lines_of, trace, walled_site
from tests.support.budgets import budget


def site_of(segments, size, cell):
    grid, rows, columns = lay_grid((0.0, 0.0, size, size), cell)
    return Walls(segments, measure_gaps(segments, grid, rows, columns), grid)


def test_gaps_are_those_of_shapely():
    segments = np.vstack([walled_site(30.0, 6, 1), [[11.0, 12.0, 11.0, 12.0]]])
    site, lines = site_of(segments, 30.0, 1.5), lines_of(segments)
    point = shapely.Point(11.0, 12.0)
    for i, j in np.ndindex(site.gaps.shape):
        middle = shapely.Point(1.5 * (j + 0.5), 1.5 * (i + 0.5))
        expected = min(lines.distance(middle), point.distance(middle))
        assert site.gaps[i, j] == pytest.approx(expected, abs=1e-9)
        assert gap_of_point(segments, middle.x, middle.y) == pytest.approx(expected, abs=1e-9)
    assert gap_of_point(np.zeros((0, 4)), 1.0, 2.0) == math.inf


def test_a_grid_covers_its_rectangle():
    assert lay_grid((-3.0, 1.0, 4.0, 2.0), 2.0) == (Grid(-3.0, 1.0, 2.0), 2, 4)


def test_paths_that_keep_clear_do_so_by_shapely():
    rng, radius, clearance = np.random.default_rng(2), 4.0, 1.5
    segments = walled_site(40.0, 5, 3)
    site, lines = site_of(segments, 40.0, 2.0), lines_of(segments)
    found = {True: 0, False: 0}
    for _ in range(budget(1_500, 1_500)):
        x, y, heading = *rng.uniform(0.0, 40.0, 2), rng.uniform(-4.0, 4.0)
        word, *lengths = shortest_path(*rng.uniform(-15.0, 15.0, 2), rng.uniform(-4, 4), radius)
        gap, pose = math.inf, (x, y, heading)
        for side, length in zip(turns(word), lengths, strict=True):
            gap = min(gap, lines.distance(trace(pose, side, radius, length)))
            pose = drive(pose, side, radius, length)
        start = x, y, math.cos(heading), math.sin(heading)
        clear = path_keeps_clear(site, clearance, *start, radius, word, *lengths)
        found[clear] += 1
        assert not (clear and gap < clearance - 1e-3)
        assert clear or gap < clearance + 0.5 * CHECKED_EVERY + 1e-3
    assert min(found.values()) > 100


def test_the_clearance_of_a_truck_alone_is_that_of_its_corners():
    radius, wheelbase, half, front, rear = 9.0, 5.0, 1.25, 1.4, 1.0
    outer = math.hypot(wheelbase + front, radius + half) - radius
    found = clearance_of(radius, [wheelbase], [0.0], [half], [front], [rear])
    assert found == pytest.approx(outer)


def test_trailers_need_room_inside():
    lengths, zeros = [4.0, 8.0], [0.0, 0.0]
    half = [1.2, 1.2]
    inner = math.sqrt(12.0**2 - 8.0**2) - 1.2  # of the trailer's axle, less half its width
    assert clearance_of(12.0, lengths, zeros, half, zeros, zeros) == pytest.approx(12.0 - inner)
    with pytest.raises(ValueError, match=r"radius is 7\.0 m"):
        clearance_of(7.0, lengths, zeros, half, zeros, zeros)
