"""In every scenario with walls, first hits are those of a brute force.

With HAV_AUDIT=1 there are a thousand worlds of each. HAVs drive at random. Shapely compares all
bodies with all segments after each step, until each HAV has hit one.
"""

import numpy as np
import pytest

from hav_env import Batch, Field
from hav_env.scenarios.presets import SITES
from hav_env.vehicles import VEHICLES
from hav_env.world.arrays import NEVER, OBSTACLE, WHEN
from tests.support.budgets import COMPILED, audited
from tests.support.obstacles import first_touches, wall_shapes

WORLDS, STEPS = audited(1_000, 30), 400
KEPT = 10  # steps for which commands are kept
SCENARIOS = {"field-1": Field(num_havs=1), "field-4": Field(num_havs=4), **SITES}


@pytest.mark.skipif(not COMPILED, reason="millions of steps")
@pytest.mark.exhaustive
@pytest.mark.parametrize("name", SCENARIOS)
def test_first_hits_are_those_of_a_brute_force_in_every_step(name):
    batch = Batch(SCENARIOS[name], WORLDS, vehicle=VEHICLES.make("realistic"))
    batch.reset(8)
    worlds, rng = batch.worlds, np.random.default_rng(8)
    shape, walls = worlds.state.x.shape, wall_shapes(batch.worlds)
    expected = np.full(shape, NEVER)
    free = np.argwhere(expected == NEVER)
    assert not first_touches(worlds, walls, free).any()
    for step in range(1, STEPS + 1):
        if step % KEPT == 1:
            speed = rng.uniform(0.0, 5.0, shape)
            steering = rng.uniform(-0.6, 0.6, shape)
        batch.step(speed, steering)
        agent, w = free[first_touches(worlds, walls, free)].T
        expected[agent, w] = step
        assert np.array_equal(worlds.record.first[:, OBSTACLE, WHEN], expected), step
        free = np.argwhere(expected == NEVER)
    assert (expected != NEVER).mean() > 0.3
