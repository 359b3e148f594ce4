"""Paths of arcs of two radii end where they should, and are Dubins paths when the radii agree."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from hav_env.maths.arcs import circles_path, tangent_path
from hav_env.maths.dubins import shortest_path

place = st.floats(-80.0, 80.0)
angle = st.floats(-3.1, 3.1)
radius = st.floats(2.0, 30.0)
sides = st.sampled_from([1.0, -1.0])


def drive(path):
    """Return where a path of (curvature, length) ends, by integration."""
    pose, heading = 0j, 0.0
    for curvature, length in path:
        if curvature == 0.0:
            pose += length * np.exp(1j * heading)
        else:
            then = heading + curvature * length
            pose += (np.exp(1j * then) - np.exp(1j * heading)) / (1j * curvature)
            heading = then
    return pose, heading


@given(sides, sides, place, place, angle, radius, radius)
def test_two_arcs_and_a_straight_end_at_the_pose(first_side, last_side, x, y, heading, r, q):
    pose = x, y, heading, math.cos(heading), math.sin(heading)
    a, b, c = tangent_path(first_side, last_side, *pose, r, q)
    assume(math.isfinite(a))
    assert min(a, b, c) >= 0.0
    end, turned = drive([(first_side / r, a), (0.0, b), (last_side / q, c)])
    assert end == pytest.approx(complex(x, y), abs=1e-5)
    assert math.cos(turned - heading) == pytest.approx(1.0, abs=1e-9)


@given(place, place, angle, radius)
def test_with_one_radius_none_is_shorter_than_the_dubins_path(x, y, heading, r):
    pose = x, y, heading, math.cos(heading), math.sin(heading)
    paths = [tangent_path(f, g, *pose, r, r) for f in (1.0, -1.0) for g in (1.0, -1.0)]
    paths += [circles_path(side, x, y, heading, r) for side in (1.0, -1.0)]
    _, *segments = shortest_path(x, y, heading, r)
    assert min(map(sum, paths)) == pytest.approx(sum(segments), abs=1e-5)
