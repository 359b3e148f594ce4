"""The axles of a HAV are in the same places for the simulator and for all that is drawn."""

import numpy as np
import pytest

from hav_env.world.arrays import allocate_worlds, turn_unit
from hav_env.world.chain import axles_of, ends_behind, front_axle

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
