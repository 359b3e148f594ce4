"""Fleets are drawn as section V of the paper states."""

import math

import numpy as np
import pytest
from scipy import stats

from hav_env import Batch, RandomFleet, RandomPoses
from hav_env.compiled import canonical
from hav_env.scenarios import Explicit, Field, RandomSitePoses, SitePoses, populate
from tests.support.budgets import budget
from tests.support.worlds import sample

MANY = budget(4_000, 300)
DRAWN = [kind for kind in populate.table if kind not in (Explicit, RandomSitePoses, SitePoses)]


def rayleigh(low, high):
    return stats.rayleigh.cdf(high, scale=3.0) - stats.rayleigh.cdf(low, scale=3.0)


COUNTS = np.arange(1, 11)
INSIDE = rayleigh(COUNTS, COUNTS + 1)
CLIPPED = np.r_[rayleigh(0, 2), INSIDE[1:-1], rayleigh(10, np.inf)]
ROUNDED = np.r_[rayleigh(0, 1.5), rayleigh(COUNTS - 0.5, COUNTS + 0.5)[1:-1], rayleigh(9.5, np.inf)]


@pytest.mark.parametrize(
    ("options", "shares"),
    [
        ({"trailer_offset": 0.0, "trailer_redraw": False}, CLIPPED),
        ({"trailer_offset": 0.5, "trailer_redraw": False}, ROUNDED),
        ({"trailer_offset": 0.0, "trailer_redraw": True}, INSIDE / INSIDE.sum()),
    ],
    ids=["cut", "rounded", "redrawn"],
)
def test_trailer_counts_have_the_rayleigh_distribution(options, shares):
    counts = sample(RandomPoses(fleet=RandomFleet(**options)), MANY).fleet.num_trailers.ravel()
    found = np.bincount(counts, minlength=11)
    assert found[0] == 0
    assert len(found) == 11
    assert stats.chisquare(found[1:], shares * MANY).pvalue > 1e-3


def test_truck_lengths_have_the_truncated_mixture_of_normals():
    def below(length):
        return 0.5 * stats.norm.cdf(length, 4.0, 0.6) + 0.5 * stats.norm.cdf(length, 10.7, 1.2)

    trucks = sample(RandomPoses(num_havs=2), MANY).fleet.length[:, 0].ravel()
    assert trucks.min() >= 2.0
    assert trucks.max() < 12.0
    truncated = stats.kstest(
        trucks, lambda length: (below(length) - below(2.0)) / (below(12.0) - below(2.0))
    )
    assert truncated.pvalue > 1e-3


def test_trailer_lengths_are_uniform_and_independent():
    fleet = sample(RandomPoses(), MANY).fleet
    lengths, num_trailers = fleet.length[0, 1:], fleet.num_trailers[0]
    present = np.arange(1, 11)[:, None] <= num_trailers
    assert stats.kstest((lengths[present] - 2.0) / 10.0, "uniform").pvalue > 1e-3
    assert np.isinf(lengths[~present]).all()
    long = num_trailers >= 2
    for one in (fleet.length[0, 0], num_trailers, lengths[1]):
        correlation = stats.spearmanr(one[long], lengths[0][long]).statistic
        assert abs(correlation) < 4.0 / math.sqrt(long.sum())


@pytest.mark.parametrize(
    "kind",
    [pytest.param(kind, marks=[pytest.mark.exhaustive] if kind is Field else []) for kind in DRAWN],
)
def test_a_fleet_is_the_same_in_every_scenario(kind):
    fleet = RandomFleet(max_trailers=4, speed_max=2.0, footprint_truck_share=0.3)
    found, expected = (
        sample(scenario, budget(20, 3)).fleet
        for scenario in (kind(num_havs=3, fleet=fleet), RandomPoses(num_havs=3, fleet=fleet))
    )
    for one, other in zip(found, expected, strict=True):
        assert np.array_equal(one, other)
    assert kind(fleet=fleet).max_trailers == 4
    assert kind(fleet=fleet).articulation_max == fleet.articulation_max


@pytest.mark.parametrize("kind", DRAWN)
@pytest.mark.parametrize(
    ("field", "value"),
    [
        *((field, math.nan) for field in RandomFleet._fields if field != "trailer_redraw"),
        ("min_trailers", 0),
        ("max_trailers", 0),
        ("trailer_sigma", 0.0),
        ("min_length", 0.0),
        ("max_length", 2.0),
        ("max_length", math.inf),
        ("short_truck_mean", 0.5),
        ("short_truck_mean", 13.5),
        ("long_truck_mean", -10.7),
        ("short_truck_deviation", 0.0),
        ("long_truck_deviation", -1.0),
        ("footprint_truck_share", -0.1),
        ("footprint_truck_share", 1.1),
        ("speed_max", 0.0),
        ("steering_max", 0.0),
        ("steering_max", math.pi / 2),
        ("articulation_max", 0.0),
        ("articulation_max", 3.2),
    ],
)
def test_a_bad_parameter_of_a_fleet_is_named(kind, field, value):
    fleet = RandomFleet()._replace(**{field: value})
    with pytest.raises(ValueError, match=f"fleet {field} is {value}, but must be"):
        Batch(kind(fleet=fleet))


@pytest.mark.parametrize("fleet", [None, 3, "long", (1, 10)])
def test_what_is_no_fleet_is_an_error(fleet):
    with pytest.raises(TypeError, match=r"fleet is .*, but must be a RandomFleet"):
        Batch(RandomPoses(fleet=fleet))


def test_whole_numbers_in_a_fleet_become_floats():
    model = canonical(RandomPoses(area_factor=4, fleet=RandomFleet(max_length=12)))
    assert isinstance(model.area_factor, float)
    assert isinstance(model.fleet.max_length, float)
    assert isinstance(model.fleet.max_trailers, int)
    assert model == RandomPoses()
