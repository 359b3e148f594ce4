"""In random fields each HAV alone can reach its goals: SciPy and Shapely drive its path again."""

import numpy as np
import pytest
import shapely

from hav_env import Batch, Field
from hav_env.scenarios.presets import find_scenario
from hav_env.scenarios.sites.field import _NAMES
from hav_env.vehicles import VEHICLES
from hav_env.world.units.reading import limits_in
from tests.support.budgets import COMPILED, audited, budget
from tests.support.obstacles import touching_walls, wall_shapes
from tests.support.ways import least_gaps, way_bodies, way_of

FIELD = Field(num_havs=2)


@pytest.fixture(scope="module")
def worlds():
    batch = Batch(FIELD, budget(20, 2), vehicle=VEHICLES.make("realistic"))
    batch.reset(9)
    return batch.worlds


def test_no_wall_is_near_the_way_of_any_hav(worlds):
    walls, least = wall_shapes(worlds), []
    for w in range(worlds.lanes):
        tree = shapely.STRtree(walls[:, w])
        for agent in range(FIELD.num_havs):
            way = way_of(worlds, agent, w, FIELD.widening)
            bends = np.abs(np.diff(way[:, 2:], axis=1))
            limit = limits_in(worlds.fleet, w, worlds.fleet.limit[:, 2, w])[agent]
            assert (bends <= limit[1 : bends.shape[1] + 1]).all()
            bodies = way_bodies(worlds, agent, w, way)
            _, gaps = tree.query_nearest(bodies, all_matches=False, return_distance=True)
            least.append(gaps.min())
    assert min(least) > FIELD.margin - 0.01
    assert np.median(least) < FIELD.margin + 5.0


@pytest.mark.skipif(not COMPILED, reason="millions of strides")
@pytest.mark.exhaustive
@pytest.mark.parametrize("name", ["field-1", "field-4"])
def test_no_wall_is_near_a_way_in_many_worlds(name):
    """NumPy drives all chains; Shapely measures gaps every half metre of the way.

    With HAV_AUDIT=1 in 10,000 worlds. Between two looks no corner moves as far as the margin.
    """
    field, least = find_scenario(name), []
    for begin in range(0, audited(10_000, 200), 100):
        batch = Batch(field, 100, vehicle=VEHICLES.make("realistic"))
        batch.reset(2026, np.arange(begin, begin + 100))
        least.append(least_gaps(batch.worlds, _NAMES, field.widening).min())
    assert min(least) > field.margin - 0.01
    assert min(least) < field.margin + 0.1


def test_nobody_starts_at_a_wall_and_walls_are_as_long_as_they_should_be(worlds):
    assert not touching_walls(worlds).any()
    lengths = shapely.length(wall_shapes(worlds))
    assert FIELD.min_wall - 1e-9 <= lengths.min() < lengths.max() <= FIELD.max_wall + 1e-9
    assert (worlds.place.count == FIELD.num_segments).all()


def test_walls_shorter_than_the_shortest_are_refused():
    with pytest.raises(ValueError, match=r"max_wall is 2\.0, but must be at least min_wall"):
        Batch(Field(max_wall=2.0), 1, vehicle=VEHICLES.make("realistic"))


def test_a_field_without_room_says_so():
    crowded = Field(num_havs=4, side=20.0, pose_attempts=5, world_attempts=3)
    with pytest.raises(ValueError, match="have no space"):
        Batch(crowded, 1, vehicle=VEHICLES.make("realistic")).reset(0)
