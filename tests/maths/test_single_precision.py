"""Kernels in single precision: near the exact values, the same bits in lanes as in Python."""

import math

import numpy as np
import pytest

from hav_env.compiled import (
    TILE_SIDE,
    entry,
    fma,
    kernel,
    like,
    single,
    split_power,
    transpose_tile,
)
from hav_env.maths.dubins import shortest_path_towards, word_segments
from hav_env.maths.elementary import atan2, atan2_positive, exp, floor, log, sincos, sqrt
from tests.support.budgets import budget

SAMPLES = budget(20_000, 500)
LOGARITHM, ANGLE, POSITIVE, FUSED, POWER, MANTISSA = range(6)
SINE, COSINE, EXPONENTIAL, ROOT, SHARE, RESULTS = range(6, 12)
_THIRD = 1.0 / 3.0


@kernel
def angle_of(x):
    """Return a number clipped to an angle [rad]."""
    return like(min(max(x, -900.0), 900.0), x)


@kernel
def share_of(x):
    """Return pi x / 3, by a constant of the module, one of ``math`` and one in the text."""
    return _THIRD * (math.pi * x) + 0.1


@entry
def evaluate(first, last, a, b, results):
    """Fill results (RESULTS, W), float32 like a and b (W,)."""
    for w in range(first, last):
        results[LOGARITHM, w] = log(abs(a[w]) + single(1.0))
        results[ANGLE, w] = atan2(a[w], b[w])
        results[POSITIVE, w] = atan2_positive(abs(a[w]), abs(b[w]))
        results[FUSED, w] = fma(a[w], b[w], a[w])
        results[POWER, w], results[MANTISSA, w] = split_power(abs(a[w]) + single(1e-20))
        results[SINE, w], results[COSINE, w] = sincos(angle_of(a[w]))
        results[EXPONENTIAL, w] = exp(angle_of(a[w]))
        results[ROOT, w] = sqrt(abs(a[w]))
        results[SHARE, w] = share_of(a[w])


@entry
def find_paths(first, last, goals, results):
    """Fill results (4, W) with words and segments of the paths to goals (6, W), all float32."""
    for w in range(first, last):
        word, one, two, three = shortest_path_towards(
            goals[0, w], goals[1, w], goals[2, w], goals[3, w], goals[4, w], goals[5, w]
        )
        results[0, w] = word
        results[1, w], results[2, w], results[3, w] = one, two, three


@entry
def turn_over(first, last, columns, rows):
    """Write rows (W, D) from columns (D, W), whole tiles of both."""
    for lane in range(first, last, TILE_SIDE):
        for column in range(0, columns.shape[0], TILE_SIDE):
            transpose_tile(columns, column, lane, rows, lane, column)


def numbers():
    """Return float32 of all sizes side by side, zeros among them."""
    rng = np.random.default_rng(5)
    a, b = rng.choice([-1.0, 1.0], (2, SAMPLES)) * 10.0 ** rng.uniform(-12, 12, (2, SAMPLES))
    b[::7], a[::11], b[::13] = a[::7], 0.0, 0.0
    return a.astype(np.float32), b.astype(np.float32)


def goals():
    """Return goals near and far: forward, left, heading, its direction, radius of the circles."""
    rng = np.random.default_rng(6)
    heading = rng.uniform(-math.pi, math.pi, SAMPLES)
    place = 10.0 ** rng.uniform(-1, 3, SAMPLES) * np.exp(1j * rng.uniform(-4, 4, SAMPLES))
    radius = rng.uniform(3, 40, SAMPLES)
    rows = [place.real, place.imag, heading, np.cos(heading), np.sin(heading), radius]
    return np.array(rows, np.float32)


def test_lanes_give_the_bits_of_calls():
    a, b = numbers()
    found = np.zeros((RESULTS, SAMPLES), np.float32)
    evaluate(SAMPLES, a, b, found)
    one = np.float32(1.0)
    called = [
        (
            log(abs(x) + one),
            atan2(x, y),
            atan2_positive(abs(x), abs(y)),
            fma(x, y, x),
            *split_power(abs(x) + np.float32(1e-20)),
            *sincos(angle_of(x)),
            exp(angle_of(x)),
            sqrt(abs(x)),
            share_of(x),
        )
        for x, y in zip(a, b, strict=True)
    ]
    assert {type(value) for values in called for value in values} == {np.float32}
    assert found.tobytes() == np.array(called, np.float32).T.tobytes()


def test_they_are_near_what_double_precision_gives():
    a, b = numbers()
    found = np.zeros((RESULTS, SAMPLES), np.float32)
    evaluate(SAMPLES, a, b, found)
    x, y = a.astype(float), b.astype(float)
    exact = np.log(np.float32(abs(a) + np.float32(1.0)).astype(float))
    assert found[LOGARITHM] == pytest.approx(exact, rel=2.5e-7, abs=1e-12)
    angle = np.where(x == 0.0, np.where(y < 0.0, math.pi, 0.0), np.arctan2(x, y))
    assert found[ANGLE] == pytest.approx(angle, rel=3e-7)
    assert found[POSITIVE] == pytest.approx(np.arctan2(abs(x), abs(y)), rel=3e-7)
    turned = np.float32(np.clip(x, -900.0, 900.0)).astype(float)
    assert found[SINE] == pytest.approx(np.sin(turned), abs=2e-7)
    assert found[COSINE] == pytest.approx(np.cos(turned), abs=2e-7)
    assert found[EXPONENTIAL] == pytest.approx(np.exp(np.clip(turned, -87.0, 88.0)), rel=4e-7)
    assert found[ROOT] == pytest.approx(np.sqrt(abs(x)), rel=1e-7)
    assert found[SHARE] == pytest.approx(math.pi / 3.0 * x + 0.1, rel=3e-7, abs=3e-8)
    given = np.float32(abs(a) + np.float32(1e-20))
    assert (np.ldexp(found[MANTISSA], found[POWER].astype(int)) == given).all()
    assert ((found[MANTISSA] >= np.float32(math.sqrt(0.5))) & (found[MANTISSA] < 1.4143)).all()


def test_a_product_and_a_sum_are_rounded_once():
    x = np.float32(1.0 + 2.0**-12)
    assert fma(x, x, np.float32(-1.0)) == np.float32(2.0**-11 + 2.0**-24)
    assert np.float32(x * x) - np.float32(1.0) == np.float32(2.0**-11)


def test_paths_in_lanes_are_those_of_calls():
    given = goals()
    found = np.zeros((4, SAMPLES), np.float32)
    find_paths(SAMPLES, given, found)
    called = np.array([shortest_path_towards(*goal) for goal in given.T], np.float32)
    assert found.tobytes() == called.T.tobytes()


def test_paths_are_as_short_as_in_double_precision():
    given = goals()
    for goal in given[:, : budget(3_000, 300)].T:
        word, *segments = shortest_path_towards(*goal)
        forward, left, heading, _, _, radius = map(float, goal)
        direction = math.cos(heading), math.sin(heading)
        _, *exact = shortest_path_towards(forward, left, heading, *direction, radius)
        assert sum(segments) == pytest.approx(sum(exact), rel=1e-5, abs=2e-4 * radius)
        own = word_segments(int(word), forward, left, heading, radius)
        turned = [
            (x * radius - y) % (math.tau * radius) for x, y in zip(own, segments, strict=True)
        ]
        off = [min(x, math.tau * radius - x) for x in turned]
        assert max(off) < 0.05 * radius  # circles that hardly touch: the root of a rounding


@pytest.mark.parametrize("shape", [(16, 16), (48, 32), (16, 80)])
def test_a_tile_is_turned_over(shape):
    columns = np.arange(np.prod(shape), dtype=np.float32).reshape(shape)
    rows = np.full(shape[::-1], np.nan, np.float32)
    turn_over(shape[1], columns, rows, threads=1)
    assert np.array_equal(rows, columns.T)


def test_floor_is_that_of_numpy():
    numbers = np.random.default_rng(3).uniform(-4e6, 4e6, SAMPLES // 50).astype(np.float32)
    assert all(floor(number) == np.floor(number) for number in numbers)
    small = np.float32([-1.5, -1.0, -0.25, 0.0, 0.75, 1.0, 17.999])
    assert [floor(number) for number in small] == np.floor(small).tolist()
