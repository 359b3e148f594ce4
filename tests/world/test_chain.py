"""The axles of a HAV have the same positions in the simulator and in drawings."""

import numpy as np
import pytest

from hav_env import OffAxle, Rectangles
from hav_env.world.arrays import allocate_worlds, turn_unit
from hav_env.world.chain import axles_of, corners_of, ends_behind, front_axle, fronts_of
from tests.support.worlds import catalogue_like, hitch, put

RANDOM = np.random.default_rng(7)


@pytest.fixture(scope="module")
def worlds():
    worlds = allocate_worlds(1, 1, 5, 1)
    worlds.fleet.num_trailers[:] = 3
    worlds.fleet.length[0, :, 0] = [4.0, 6.0, 2.5, 8.0, np.inf]
    worlds.state.x[:], worlds.state.y[:] = 120.0, -3.5
    for unit, heading in enumerate(RANDOM.uniform(-9.0, 9.0, 5)):
        turn_unit(worlds.state, 0, unit, 0, heading)
    return worlds


def test_numpy_and_the_kernels_agree(worlds):
    places = [front_axle(worlds, 0, 0)]
    for unit in range(4):
        places.append(ends_behind(worlds, 0, unit, 0, *places[-1])[:2])
    pose = 120.0, -3.5, worlds.state.heading[0, :4, 0], worlds.fleet.length[0, :4, 0]
    np.testing.assert_allclose(axles_of(*pose), places, atol=1e-12)
    assert ends_behind(worlds, 0, 4, 0, *places[-1]) == 2 * places[-1]


def test_many_chains_are_worked_out_together():
    x, y = RANDOM.uniform(-50.0, 50.0, (2, 7, 3))
    heading, length = RANDOM.uniform(-4.0, 4.0, (7, 3, 5)), RANDOM.uniform(1.0, 9.0, (3, 5))
    axles = axles_of(x, y, heading, length)
    assert axles.shape == (7, 3, 6, 2)
    np.testing.assert_allclose(axles[..., 1, :], np.stack([x, y], axis=-1), atol=1e-12)
    links = axles[..., :-1, :] - axles[..., 1:, :]
    np.testing.assert_allclose(
        np.hypot(*np.moveaxis(links, -1, 0)), np.broadcast_to(length, (7, 3, 5))
    )
    bearing = np.arctan2(links[..., 1], links[..., 0])
    np.testing.assert_allclose(np.cos(bearing - heading), 1.0)
    np.testing.assert_array_equal(axles[4, 1], axles_of(x[4, 1], y[4, 1], heading[4, 1], length[1]))


def test_hitches_off_the_axles_are_where_the_kernels_have_them():
    """A hitch behind the axle, on it, ahead of it; also of HAVs of other lengths."""
    worlds = catalogue_like(OffAxle(bodies=Rectangles())).worlds
    rng = np.random.default_rng(3)
    for _ in range(20):
        lengths, offsets = rng.uniform(1.0, 9.0, 4), rng.uniform(-3.0, 3.0, 3)
        put(worlds, lengths, *rng.uniform(-90.0, 90.0, 2), rng.uniform(-7.0, 7.0, 4))
        hitch(worlds, offsets)
        fleet, state = worlds.fleet, worlds.state
        pose = state.x[0, 0], state.y[0, 0], state.heading[0, :4, 0], lengths
        offset = fleet.joints.offset[0, :4, 0]
        axles, fronts = axles_of(*pose, offset), fronts_of(*pose, offset)
        place = front_axle(worlds, 0, 0)
        np.testing.assert_allclose(axles[0], place, atol=1e-12)
        np.testing.assert_allclose(axles[1], pose[:2], atol=1e-12)
        for unit in range(4):
            np.testing.assert_allclose(fronts[unit], place, atol=1e-12)
            *end, x, y = ends_behind(worlds, 0, unit, 0, *place)
            # the line of a unit ends at its axle, or at the hitch behind that
            beyond = max(offset[unit], 0.0) / lengths[unit]
            further = axles[unit + 1] + beyond * (axles[unit + 1] - fronts[unit])
            np.testing.assert_allclose(end, further, atol=1e-12)
            place = x, y


def test_corners_are_those_of_a_box_in_the_frame_of_its_axle():
    rng = np.random.default_rng(4)
    shape, length = rng.uniform(0.1, 3.0, (3, 3)), rng.uniform(2.0, 9.0, 3)
    pose = 5.0, -8.0, rng.uniform(-4.0, 4.0, (7, 3)), length, rng.uniform(-1.0, 1.0, 3)
    x, y = np.full(7, pose[0]), np.full(7, pose[1])
    corners, axles = corners_of(shape, x, y, *pose[2:]), axles_of(x, y, *pose[2:])
    assert corners.shape == (7, 3, 4, 2)
    away = corners - axles[:, 1:, None]
    seen = (away[..., 0] + 1j * away[..., 1]) * np.exp(-1j * pose[2])[..., None]
    half, ahead, behind = shape.T
    rear, front = -behind, length + ahead
    expected = np.stack([rear - 1j * half, front - 1j * half, front + 1j * half, rear + 1j * half])
    np.testing.assert_allclose(seen, np.broadcast_to(expected.T, seen.shape), atol=1e-12)
