"""LLVM instructions that Python lacks give the same results in both."""

import fractions
import random

import numpy as np

from hav_env.compiled import entry, fma, lowest_bit, take
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


def test_a_product_and_a_sum_are_rounded_once():
    """A float of a fraction is the nearest one."""
    draw = random.Random(3)
    for _ in range(2_000):
        x, y, z = (draw.uniform(-1.0, 1.0) * 2.0 ** draw.randint(-60, 60) for _ in range(3))
        z = draw.choice([z, -x * y, x * y * 2.0**-50])
        exact = fractions.Fraction(x) * fractions.Fraction(y) + fractions.Fraction(z)
        for number in (float, np.float64):
            assert fma(number(x), number(y), number(z)) == float(exact)


@entry
def find_lowest_bits(first, last, numbers, places):
    """Write the place of the lowest bit of each number."""
    for k in range(first, last):
        places[k] = lowest_bit(numbers[k])


def test_the_lowest_bit_of_every_place_is_found():
    expected = np.arange(64).repeat(4)
    numbers = np.random.default_rng(4).integers(-(2**63), 2**63, expected.size) | 1
    numbers, places = numbers << expected, np.zeros(expected.size, np.int64)
    find_lowest_bits(expected.size, numbers, places)
    assert np.array_equal(places, expected)
