"""Draws are Random123's, have the stated distributions, and are independent of each other."""

import itertools

import numpy as np
import pytest
from scipy import stats

from hav_env.maths.random_numbers import normal, threefry, uniform
from tests.support.budgets import budget

ONES = 0xFFFFFFFF


@pytest.mark.parametrize(
    ("key", "counter", "answer"),
    [
        ((0, 0), (0, 0), (0x6B200159, 0x99BA4EFE)),
        ((ONES, ONES), (ONES, ONES), (0x1CB996FC, 0xBB002BE7)),
        ((0x13198A2E, 0x03707344), (0x243F6A88, 0x85A308D3), (0xC4923A9C, 0x483DF7A0)),
    ],
)
def test_threefry_gives_the_known_answers_of_random123(key, counter, answer):
    assert threefry(*key, *counter) == answer


SWEEPS = {
    "draws": lambda k: (1, 2, 3, k),
    "streams": lambda k: (1, 2, k, 3),
    "episodes": lambda k: (1, k, 2, 3),
    "seeds": lambda k: (k, 1, 2, 3),
}


@pytest.mark.parametrize("sweep", SWEEPS.values(), ids=SWEEPS)
def test_numbers_are_uniform_along_every_argument(sweep):
    numbers = [uniform(*sweep(k)) for k in range(budget(20_000, 3_000))]
    assert 0.0 <= min(numbers) <= max(numbers) < 1.0
    assert stats.kstest(numbers, "uniform").pvalue > 1e-3


@pytest.mark.parametrize("sweep", SWEEPS.values(), ids=SWEEPS)
def test_normal_numbers_are_normal_along_every_argument(sweep):
    # a normal number takes two draws
    numbers = [normal(*sweep(2 * k)) for k in range(budget(20_000, 3_000))]
    assert stats.kstest(numbers, "norm").pvalue > 1e-3


@pytest.mark.parametrize(
    ("one", "other"), list(itertools.combinations_with_replacement(SWEEPS.values(), 2))
)
def test_neighbouring_numbers_are_independent(one, other):
    count = budget(20_000, 4_000)
    a = np.array([uniform(*one(k)) for k in range(4, count)])
    b = np.array([uniform(*other(k + 1)) for k in range(4, count)])
    table = np.histogram2d(a, b, bins=8, range=[(0, 1), (0, 1)])[0]
    assert stats.chisquare(table.ravel()).pvalue > 1e-3
    assert abs(stats.spearmanr(a, b).statistic) < 4.0 / np.sqrt(len(a))


def test_a_number_has_53_random_bits():
    scaled = np.array([uniform(5, 6, 7, k) for k in range(2_000)]) * 2.0**53
    assert (scaled == np.floor(scaled)).all()
    assert 0.4 < np.mean(scaled % 2.0) < 0.6  # the last bit is used


def test_a_number_does_not_depend_on_the_numbers_before():
    forwards = [uniform(9, 8, 7, k) for k in range(50)]
    backwards = [uniform(9, 8, 7, k) for k in reversed(range(50))]
    assert forwards == backwards[::-1]
