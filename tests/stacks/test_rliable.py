"""Interquartile means, their intervals and profiles are those of rliable (Agarwal et al. 2021).

rliable resamples the runs of every task. A task is here a stratum with one world.
"""

import numpy as np
import pytest
from rliable import library, metrics

from hav_env.evaluation.bootstrap import bootstrap, interquartile_mean, performance_profile

RESAMPLES = 2_000


@pytest.fixture(scope="module")
def scores():
    """Draw the scores of eight runs at twelve tasks."""
    rng = np.random.default_rng(0)
    return rng.gamma(2.0, 0.5, (1, 12)) + rng.normal(0.0, 0.3, (8, 12))


@pytest.fixture(scope="module")
def strata(scores):
    return [column[:, None] for column in scores.T]


def test_the_interquartile_mean_and_its_interval_are_rliables(scores, strata):
    values, intervals = library.get_interval_estimates(
        {"ours": scores}, lambda x: np.array([metrics.aggregate_iqm(x)]), reps=RESAMPLES
    )
    low, high = intervals["ours"].ravel()
    ours = bootstrap(strata, interquartile_mean, RESAMPLES)
    assert ours.value == pytest.approx(float(values["ours"].item()), rel=1e-12)
    assert (ours.low, ours.high) == pytest.approx((low, high), abs=0.1 * (high - low))


def test_the_profile_and_its_band_are_rliables(scores, strata):
    limits = np.linspace(0.0, 3.0, 13)
    shares, bands = library.create_performance_profile({"ours": scores}, limits, reps=RESAMPLES)
    ours = performance_profile(strata, limits, RESAMPLES)
    # theirs are of scores above a limit
    assert ours.share == pytest.approx(1.0 - shares["ours"])
    assert ours.low == pytest.approx(1.0 - bands["ours"][1], abs=0.03)
    assert ours.high == pytest.approx(1.0 - bands["ours"][0], abs=0.03)
