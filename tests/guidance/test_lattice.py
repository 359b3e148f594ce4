"""Lengths of a lattice are those of clear drives and, on its graph, the shortest."""

import math

import numpy as np
import pytest
import shapely
from scipy.sparse import csr_array
from scipy.sparse.csgraph import bellman_ford

from hav_env.guidance import Lattice, find_lengths
from hav_env.guidance.lattice import check_arguments, search, table_of
from hav_env.guidance.search import IN_SIGHT, UNREACHED
from hav_env.maths.dubins import path_length
from tests.guidance.sites import HEADINGS, drive, lines_of, trace, walled_site
from tests.support.budgets import COMPARED, COMPILED, budget

OPEN = np.zeros((0, 4))
SIZE, RADIUS = 30.0, 5.0
GOAL = (17.0, 16.0, 0.4)
SMALL = Lattice(cell=1.5, headings=HEADINGS, clearance=1.1, direct=0.0)
TURN = 2.0 * math.pi / HEADINGS


def search_small(segments, **changes):
    lattice = SMALL._replace(**changes)
    bounds = (0.0, 0.0, SIZE, SIZE)
    return search(lattice, *check_arguments(lattice, segments, GOAL, RADIUS, bounds))


def place_of(x, y, heading_cell):
    """Return the node of a pose; None outside the grid."""
    side = math.ceil(SIZE / SMALL.cell)
    i, j = math.floor(y / SMALL.cell), math.floor(x / SMALL.cell)
    inside = 0 <= i < side and 0 <= j < side
    return (i * side + j) * HEADINGS + heading_cell % HEADINGS if inside else None


def drives_to(nodes, node):
    """Yield the drives that end in the pose of a node: pose, side and node of their start."""
    k = node % HEADINGS
    for side in (-1, 0, 1):
        # backwards is forwards with the truck turned round and the other side
        back = nodes.x[node], nodes.y[node], GOAL[2] + k * TURN + math.pi
        x, y, _ = drive(back, -side, RADIUS, RADIUS * TURN)
        before = place_of(x, y, k - side)
        if before is not None:
            yield (x, y, GOAL[2] + (k - side) * TURN), side, before


def test_lengths_in_the_open_are_those_of_bellman_and_ford():
    _, drives, nodes, _ = search_small(OPEN)
    reached = np.flatnonzero(np.isfinite(nodes.length))
    edges = [(node, before) for node in reached for _, _, before in drives_to(nodes, node)]
    ends, starts = np.unique(np.array(edges), axis=0).T
    count = nodes.length.size
    graph = csr_array((np.full(ends.size, drives.step), (ends, starts)), shape=(count, count))
    goal = int(np.flatnonzero(nodes.side == IN_SIGHT)[0])
    expected = bellman_ford(graph, indices=goal)
    assert drives.step == pytest.approx(RADIUS * TURN)
    np.testing.assert_allclose(nodes.length, expected, rtol=1e-12)
    assert reached.size > 0.5 * count


@pytest.mark.parametrize("direct", [0.0, 25.0])
def test_among_walls_no_drive_is_missing_and_none_hits(direct):
    segments = walled_site(SIZE, 2, 8)
    lines = lines_of(segments)
    _, drives, nodes, _ = search_small(segments, direct=direct)
    reached = np.flatnonzero(np.isfinite(nodes.length))
    assert reached.size > 500
    assert (nodes.side[reached] != UNREACHED).all()
    taken = set()
    for node in np.random.default_rng(4).permutation(reached)[: budget(2_000, 400)]:
        for pose, side, before in drives_to(nodes, node):
            length = nodes.length[node] + drives.step
            own = np.hypot(pose[0] - nodes.x[before], pose[1] - nodes.y[before]) < 1e-9
            taken_here = own and side == nodes.side[before]
            seen = nodes.side[before] == IN_SIGHT
            if not taken_here and (seen or nodes.length[before] <= length + 1e-9):
                continue  # there is a path at least as short
            gap = lines.distance(trace(pose, side, RADIUS, drives.step))
            if taken_here:
                taken.add(before)
                assert gap > SMALL.clearance - 1e-3
                assert nodes.length[before] == pytest.approx(length)
            else:
                assert gap < SMALL.clearance + 0.051
    assert len(taken) > 100


def test_direct_nodes_have_the_length_of_a_dubins_path_that_keeps_clear():
    segments = walled_site(SIZE, 2, 8)
    site, drives, nodes, goal = search_small(segments, direct=25.0)
    table = table_of(SMALL, site, drives, nodes, goal)
    found = np.argwhere(table.side == IN_SIGHT)
    assert len(found) > 300
    for i, j, k in found:
        x, y, heading = SMALL.cell * (j + 0.5), SMALL.cell * (i + 0.5), GOAL[2] + k * TURN
        away = (GOAL[0] - x + 1j * (GOAL[1] - y)) * np.exp(-1j * heading)
        length = path_length(away.real, away.imag, GOAL[2] - heading, RADIUS)
        assert table.length[i, j, k] == pytest.approx(length, rel=1e-6)
        assert length <= 25.0


@pytest.mark.skipif(not COMPILED, reason=COMPARED)
@pytest.mark.parametrize(("direct", "least", "most"), [(0.0, 0.94, 1.06), (60.0, 0.97, 1.03)])
def test_in_the_open_lengths_are_near_those_of_dubins(direct, least, most):
    rng, count, radius = np.random.default_rng(5), 2_000, 12.0
    lattice = Lattice(cell=2.0, headings=HEADINGS, clearance=2.0, direct=direct)
    goal = (100.0, 100.0, 0.3)
    table = find_lengths(lattice, OPEN, goal, radius, (0.0, 0.0, 200.0, 200.0))
    ratios = []
    for _ in range(count):
        i, j = rng.integers(20, 80, 2)
        k = rng.integers(HEADINGS)
        x, y, heading = 2.0 * j + 1.0, 2.0 * i + 1.0, 0.3 + k * TURN
        away = (goal[0] - x + 1j * (goal[1] - y)) * np.exp(-1j * heading)
        length = path_length(away.real, away.imag, goal[2] - heading, radius)
        ratios.append(table.length[i, j, k] / length)
    reached = np.isfinite(ratios)
    assert reached.mean() > least
    assert 0.99 < np.median(np.array(ratios)[reached]) < most


def test_without_room_at_the_goal_nothing_is_reached():
    wall = np.array([[16.0, 10.0, 16.0, 20.0]])
    for direct in (0.0, 20.0):
        table = find_lengths(SMALL._replace(direct=direct), wall, GOAL, RADIUS)
        assert not np.isfinite(table.length).any()


def test_bounds_are_those_of_walls_and_goal_by_default():
    table = find_lengths(SMALL, np.array([[0.0, 3.0, 30.0, 3.0]]), GOAL, RADIUS)
    assert table.length.shape == (9, 20, HEADINGS)
    assert table.grid == (0.0, 3.0, 1.5)


REFUSED = [
    ({"segments": np.zeros((3, 3))}, r"segments is of shape \(3, 3\), but must be"),
    ({"segments": np.full((1, 4), np.nan)}, "segments is .*, but must be"),
    ({"goal": (1.0, math.inf, 0.0)}, "goal y is inf, but must be"),
    ({"radius": 0.0}, r"radius is 0\.0, but must be"),
    ({"bounds": (0.0, 0.0, 5.0, 5.0)}, "goal is .*, but must be inside the bounds"),
    ({"lattice": SMALL._replace(cell=2.0)}, r"lattice cell is 2\.0, but must be at most 1\.4"),
    ({"lattice": SMALL._replace(headings=7)}, "lattice headings is 7, but must be at least 8"),
    ({"bounds": (0.0, 0.0, 1e7, 1e7)}, "number of nodes of the lattice is .*, but must"),
]


@pytest.mark.parametrize(("change", "told"), REFUSED)
def test_wrong_arguments_are_refused_by_name(change, told):
    given = {"lattice": SMALL, "segments": OPEN, "goal": GOAL, "radius": RADIUS, "bounds": None}
    with pytest.raises(ValueError, match=f"^{told}"):
        find_lengths(**given | change)


def test_shapely_agrees_with_the_truck_of_these_tests():
    arc = trace((1.0, 2.0, 0.0), 1, 3.0, 1.5 * math.pi)
    assert shapely.get_point(arc, -1).coords[0] == pytest.approx((4.0, 5.0))
