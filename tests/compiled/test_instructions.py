"""LLVM instructions that Python lacks give the same results in both."""

import numpy as np

from hav_env.compiled import entry, take
from tests.support.budgets import budget


@entry
def take_numbers(first, last, counter, taken):
    """Write a number that no other thread takes into each place."""
    for place in range(first, last):
        taken[place] = take(counter)


def test_every_number_is_taken_once():
    counter, taken = np.zeros(1, np.int64), np.zeros(budget(200_000, 500), np.int64)
    take_numbers(taken.size, counter, taken, threads=4)
    assert counter[0] == taken.size
    assert np.array_equal(np.sort(taken), np.arange(taken.size))
