"""The paper's scenario: poses are uniform in a square, apart from each other, or it fails."""

import itertools
import math

import numpy as np
import pytest
from scipy import stats

from hav_env import Batch, PlacementError, RandomPoses
from hav_env.world.arrays import FOOTPRINT
from tests.support.budgets import budget
from tests.support.worlds import places_of, sample

MANY = budget(4_000, 300)


@pytest.mark.parametrize("factor", [4.0, 2.0])
def test_poses_of_a_single_hav_are_uniform_in_a_square_of_four_footprints(factor):
    worlds = sample(RandomPoses(area_factor=factor), MANY)
    side = np.sqrt(factor * math.pi * worlds.fleet.radius[0, FOOTPRINT] ** 2)
    sizes = side, side, math.tau
    poses = [(worlds.state.x[0], worlds.state.y[0], worlds.state.heading[0, 0])]
    poses += [tuple(worlds.goals[0, g]) for g in range(2)]
    shares = [part / size for pose in poses for part, size in zip(pose, sizes, strict=True)]
    for share in shares:
        assert stats.kstest(share, "uniform").pvalue > 1e-3
    for one, other in itertools.combinations(shares, 2):
        assert abs(stats.spearmanr(one, other).statistic) < 4.0 / math.sqrt(MANY)


@pytest.mark.parametrize(("num_havs", "compiled", "pure"), [(2, 3000, 150), (5, 1500, 40)])
@pytest.mark.parametrize("factor", [4.0, 2.5])
def test_nobody_starts_or_ends_beyond_the_square(num_havs, compiled, pure, factor):
    scenario = RandomPoses(num_havs=num_havs, num_goals=3, area_factor=factor)
    worlds = sample(scenario, budget(compiled, pure), seed=7)
    places, radius = places_of(worlds), worlds.fleet.radius[:, FOOTPRINT]
    assert (places >= 0.0).all()
    assert (places <= np.sqrt(factor * math.pi * (radius**2).sum(axis=0))).all()


def test_a_density_out_of_reach_is_an_error_that_says_so():
    crowded = RandomPoses(num_havs=20, area_factor=0.3, pose_attempts=10, world_attempts=2)
    with pytest.raises(PlacementError, match=r"3 of 3 worlds have no space for 20 HAVs.*0\.3"):
        Batch(crowded, 3).reset(0)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("area_factor", math.inf),
        ("area_factor", 0.0),
        ("pose_attempts", 0),
        ("world_attempts", 0),
    ],
)
def test_a_bad_parameter_of_the_square_is_named(field, value):
    with pytest.raises(ValueError, match=f"scenario {field} is {value}, but must be"):
        Batch(RandomPoses()._replace(**{field: value}))
