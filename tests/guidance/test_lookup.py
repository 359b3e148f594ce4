"""A truck that follows a lattice reaches the goal on a path of the predicted length."""

import math

import numpy as np
import pytest

from hav_env.compiled import entry
from hav_env.guidance import Lattice, lattice_length, lattice_turn
from hav_env.guidance.lattice import check_arguments, search, table_of
from hav_env.guidance.search import IN_SIGHT
from hav_env.maths.dubins import path_length
from tests.guidance.sites import HEADINGS, drive, lines_of, trace, turned, walled_site
from tests.support.budgets import COMPARED, COMPILED, budget

SIZE, RADIUS = 40.0, 5.0
GOAL = (24.0, 22.0, 0.4)
BOUNDS = (0.0, 0.0, SIZE, SIZE)
LATTICE = Lattice(cell=1.5, headings=HEADINGS, clearance=1.1, direct=0.0)
TURN = 2.0 * math.pi / HEADINGS
WALLS = walled_site(SIZE, 3, 12)


def lattice_of(segments, direct):
    lattice = LATTICE._replace(direct=direct)
    found = search(lattice, *check_arguments(lattice, segments, GOAL, RADIUS, BOUNDS))
    return table_of(lattice, *found), found[2]


@entry
def read(first, last, table, poses, out):
    for i in range(first, last):
        x, y, heading = poses[0, i], poses[1, i], poses[2, i]
        out[0, i] = lattice_length(table, x, y, heading)
        out[1, i], out[2, i] = lattice_turn(table, x, y, heading)


def follow(table, pose, most, lines=None):
    """Drive turn by turn to the goal; return the length and the least gap, or None on the way."""
    driven, gap = 0.0, math.inf
    while driven <= most:
        near = math.hypot(pose[0] - GOAL[0], pose[1] - GOAL[1]) < 0.5
        if near and turned(pose[2], GOAL[2]) < 0.1:
            return driven, gap
        side, length = lattice_turn(table, *pose)
        if length == 0.0:
            return None
        if lines is not None:
            gap = min(gap, lines.distance(trace(pose, side, RADIUS, length)))
        pose = tuple(map(float, drive(pose, side, RADIUS, length)))
        driven += length
    return None


def test_from_nodes_trucks_reach_the_goal_by_a_drive_as_long_as_foretold_and_clear():
    table, nodes = lattice_of(WALLS, 0.0)
    lines, rng = lines_of(WALLS), np.random.default_rng(1)
    reached = rng.permutation(np.flatnonzero(np.isfinite(nodes.length)))
    longest = 0.0
    for node in reached[: budget(300, 60)]:
        pose = nodes.x[node], nodes.y[node], GOAL[2] + node % HEADINGS * TURN
        length = nodes.length[node]
        driven, gap = follow(table, pose, 1.01 * length, lines)
        # the last turn ends in the goal, that before it may be near enough
        assert driven <= length + 1e-6
        assert driven > length - 15.0 * RADIUS * TURN
        assert gap > LATTICE.clearance - 1e-3 or driven == 0.0
        longest = max(longest, driven)
    assert longest > 50.0


@pytest.mark.skipif(not COMPILED, reason=COMPARED)
@pytest.mark.parametrize(("walls", "least"), [(WALLS[:0], 0.95), (WALLS, 0.6)])
def test_from_anywhere_most_trucks_reach_the_goal_on_a_way_about_as_long(walls, least):
    table, _ = lattice_of(walls, 60.0)
    rng, ratios = np.random.default_rng(2), []
    found = rng.permutation(np.argwhere(np.isfinite(table.length)))[:400]
    for i, j, k in found:
        a, b, c = rng.uniform(0.0, 1.0, 3)
        pose = LATTICE.cell * (j + a), LATTICE.cell * (i + b), GOAL[2] + (k + c - 0.5) * TURN
        length = lattice_length(table, *pose)
        done = follow(table, pose, 4.0 * length + 20.0)
        ratios.append(done[0] / max(length, 1.0) if done else math.inf)
    ratios = np.array(ratios)
    assert (ratios <= 1.15).mean() > least
    assert np.median(ratios) < 1.02


@pytest.mark.skipif(not COMPILED, reason=COMPARED)
def test_where_the_goal_is_in_sight_length_and_turn_are_those_of_dubins():
    table, _ = lattice_of(WALLS[:0], 1e3)
    assert (table.side == IN_SIGHT).all()
    rng = np.random.default_rng(3)
    for _ in range(200):
        x, y, heading = *rng.uniform(1.0, SIZE - 1.0, 2), rng.uniform(-9.0, 9.0)
        away = (GOAL[0] - x + 1j * (GOAL[1] - y)) * np.exp(-1j * heading)
        expected = path_length(away.real, away.imag, GOAL[2] - heading, RADIUS)
        assert lattice_length(table, x, y, heading) == pytest.approx(expected, abs=1e-9)
        side, length = lattice_turn(table, x, y, heading)
        x, y, heading = drive((x, y, heading), side, RADIUS, length)
        away = (GOAL[0] - x + 1j * (GOAL[1] - y)) * np.exp(-1j * heading)
        left = path_length(away.real, away.imag, GOAL[2] - heading, RADIUS)
        assert left + length == pytest.approx(expected, abs=1e-6) or left > expected  # by a circle


def interpolate(table, x, y, heading):
    """Return the mean of the corners that are reached, weighed by distance along each axis."""
    rows, columns, headings = table.length.shape
    u, v = x / LATTICE.cell - 0.5, y / LATTICE.cell - 0.5
    w = (heading - GOAL[2]) / TURN
    weights = lengths = 0.0
    for i in (math.floor(v), math.floor(v) + 1):
        for j in (math.floor(u), math.floor(u) + 1):
            for k in (math.floor(w), math.floor(w) + 1):
                if 0 <= i < rows and 0 <= j < columns:
                    length = table.length[i, j, k % headings]
                    weight = (1 - abs(v - i)) * (1 - abs(u - j)) * (1 - abs(w - k))
                    if math.isfinite(length):
                        weights, lengths = weights + weight, lengths + weight * length
    return lengths / weights if weights > 0.0 else math.inf


def test_between_nodes_lengths_are_interpolated_and_infinite_where_none_is_reached():
    table, _ = lattice_of(WALLS, 0.0)
    rng, infinite = np.random.default_rng(4), 0
    for _ in range(500):
        pose = *rng.uniform(-3.0, SIZE + 3.0, 2), rng.uniform(-9.0, 9.0)
        expected = interpolate(table, *pose)
        if math.isinf(expected):
            infinite += 1
            assert lattice_length(table, *pose) == math.inf
            assert lattice_turn(table, *pose) == (0.0, 0.0)
        elif math.hypot(pose[0] - GOAL[0], pose[1] - GOAL[1]) > 3.0 * LATTICE.cell:
            assert lattice_length(table, *pose) == pytest.approx(expected, rel=1e-6)
    assert 20 < infinite < 400


@pytest.mark.skipif(not COMPILED, reason=COMPARED)
def test_compiled_and_plain_lookups_are_the_same_to_the_bit():
    table, _ = lattice_of(WALLS, 30.0)
    rng = np.random.default_rng(5)
    poses = np.array([*rng.uniform(-1.0, SIZE + 1.0, (2, 500)), rng.uniform(-9.0, 9.0, 500)])
    out = np.empty((3, 500))
    read(500, table, poses, out)
    for i, pose in enumerate(poses.T):
        assert out[0, i] == lattice_length(table, *map(float, pose))
        assert tuple(out[1:, i]) == lattice_turn(table, *map(float, pose))
