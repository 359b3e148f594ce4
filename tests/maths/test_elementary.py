"""Sine, cosine, arctangent, exponential and rounding are near the exact values, everywhere alike.

Exact values come from mpmath. The worst errors found in 20 million samples where they are
largest, in units in the last place (ulp): sine and cosine 1.45 up to pi, 1.59 up to 1e3, 1.59 up to
1e6; arctangent 2.56; exponential 1.09; logarithm 1.05. The bounds here are these, rounded up.
"""

import math
import struct

import mpmath
import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from hav_env.maths.elementary import atan2, exp, floor, log, sincos, small_sincos
from tests.support.budgets import budget
from tests.support.policies import evaluate

EXACT = mpmath.mp.clone()
EXACT.prec = 250  # 1e6 next to a multiple of pi / 2 costs some 80 bits
QUARTER = math.pi / 2
SAMPLES = budget(4_000, 400)

angles = st.floats(-1e6, 1e6)
places = st.floats(1e-280, 1e300) | st.floats(-1e300, -1e-280)


def ulps(found, exact) -> float:
    """Return the largest error of numbers, in units in the last place of the exact ones."""
    pairs = zip(found, exact, strict=True)
    return max(float(abs(EXACT.mpf(a) - b)) / math.ulp(float(b)) for a, b in pairs)


def signs(rng, shape=SAMPLES):
    return rng.choice([-1.0, 1.0], shape)


def everywhere(rng, limit):
    return rng.uniform(-limit, limit, SAMPLES)


def around_quarters(rng, limit):
    """Return angles at all small distances from the multiples of pi / 2."""
    quarters = rng.integers(-int(limit / QUARTER) + 1, int(limit / QUARTER), SAMPLES)
    return quarters * QUARTER + signs(rng) * 10.0 ** rng.uniform(-17, -1, SAMPLES)


def next_to_quarters(rng, limit):
    """Return the floats nearest to multiples of pi / 2, and their neighbours."""
    quarters = rng.integers(-int(limit / QUARTER) + 1, int(limit / QUARTER), SAMPLES) * QUARTER
    return quarters * (1.0 + rng.integers(-3, 4, SAMPLES) * 2.0**-52)


def where_errors_count_double(rng, limit):
    """Return angles beyond a multiple of pi / 2 by hardly more than a power of two.

    The sine of such a rest is less than that power: its last place is worth half as much.
    """
    quarters = rng.integers(-int(limit / QUARTER) + 1, int(limit / QUARTER), SAMPLES)
    power = 2.0 ** rng.integers(-3, 0, SAMPLES)
    return quarters * QUARTER + signs(rng) * rng.uniform(power, np.arcsin(power))


@pytest.mark.parametrize(("limit", "bound"), [(math.pi, 1.5), (1e3, 1.6), (1e6, 1.6)])
@pytest.mark.parametrize(
    "sample", [everywhere, around_quarters, next_to_quarters, where_errors_count_double]
)
def test_sine_and_cosine_are_exact_but_for_a_few_units_in_the_last_place(sample, limit, bound):
    sampled = sample(np.random.default_rng(1), limit).tolist()
    sines, cosines = zip(*map(sincos, sampled), strict=True)
    assert ulps(sines, map(EXACT.sin, sampled)) < bound
    assert ulps(cosines, map(EXACT.cos, sampled)) < bound


def test_small_angles_have_the_same_bits_without_reduction():
    rng, end = np.random.default_rng(2), 0.25 * math.pi
    tiny = signs(rng) * 10.0 ** rng.uniform(-323, -1, SAMPLES)
    ends = [0.0, 5e-324, 1e-310, 2.0**-1022, math.nextafter(end, 0.0), end]
    for angle in [*ends, *rng.uniform(-end, end, SAMPLES).tolist(), *tiny.tolist()]:
        for r in (angle, -angle):
            assert struct.pack("2d", *small_sincos(r)) == struct.pack("2d", *sincos(r))


def test_tiny_angles_are_their_own_sines():
    for angle in (5e-324, 1e-310, 2.3e-308, 1e-200, 1e-9):
        assert sincos(angle) == (angle, 1.0)
    assert sincos(0.0) == (0.0, 1.0)


@given(angles)
@example(math.pi)
@example(QUARTER)
@example(QUARTER / 2)
def test_the_sine_is_odd_and_the_cosine_even_and_they_lie_on_the_circle(angle):
    sine, cosine = sincos(angle)
    assert sincos(-angle) == (-sine, cosine)
    assert abs(sine) <= 1.0
    assert abs(cosine) <= 1.0
    assert abs(sine * sine + cosine * cosine - 1.0) <= 2.0**-52


@pytest.mark.parametrize("angle", [math.inf, -math.inf])
def test_what_is_no_angle_has_neither_sine_nor_cosine(angle):
    assert np.isnan(sincos(angle)).all()


def test_not_a_number_stays_so():
    nan = math.nan
    assert np.isnan([*sincos(nan), exp(nan), floor(nan)]).all()


def plane(rng):
    return rng.normal(size=(2, SAMPLES))


def all_ratios(rng):
    return signs(rng, (2, SAMPLES)) * 10.0 ** rng.uniform(-280, 300, (2, SAMPLES))


def beside(slope):
    """Return a sampler of points close to the lines of a slope, and some way off."""

    def sample(rng):
        x = signs(rng) * 10.0 ** rng.uniform(-3, 3, SAMPLES)
        off = 10.0 ** rng.uniform(-17, -1, SAMPLES)
        return np.stack([signs(rng) * slope * x * (1.0 + signs(rng) * off), x])

    return sample


def first_eighth(rng):
    x = rng.uniform(1.0, 2.0, SAMPLES)
    return np.stack([x * rng.uniform(math.tan(math.pi / 8), 0.5, SAMPLES), x])


SLOPES = {"slope_1": 1.0, "tan_pi_8": math.tan(math.pi / 8), "tan_3_pi_8": 1 + math.sqrt(2)}
POINTS = {"plane": plane, "all_ratios": all_ratios, "first_eighth": first_eighth}
POINTS |= {name: beside(slope) for name, slope in SLOPES.items()}


@pytest.mark.parametrize("sample", POINTS.values(), ids=POINTS)
def test_the_arctangent_is_exact_but_for_a_few_units_in_the_last_place(sample):
    y, x = sample(np.random.default_rng(2)).tolist()
    assert ulps(map(atan2, y, x), map(EXACT.atan2, y, x)) < 2.6


@pytest.mark.parametrize("size", [1e-280, 1e-9, 1.0, 3.0, 1e300])
def test_the_arctangent_on_the_axes_and_diagonals_is_the_nearest_float(size):
    assert [atan2(0.0, size), atan2(size, 0.0), atan2(0.0, -size)] == [0.0, QUARTER, math.pi]
    assert atan2(-size, 0.0) == -QUARTER
    assert [atan2(size, size), atan2(size, -size)] == [0.25 * math.pi, 0.75 * math.pi]
    assert [atan2(-size, size), atan2(-size, -size)] == [-0.25 * math.pi, -0.75 * math.pi]
    for least in (5e-324, 1e-310):
        assert atan2(least, size) == math.atan2(least, size)
        assert [atan2(size, least), atan2(size, -least)] == [QUARTER, QUARTER]
        assert [atan2(least, -size), atan2(-least, -size)] == [math.pi, -math.pi]


def test_a_zero_has_no_sign_for_the_arctangent():
    for y in (0.0, -0.0):
        assert [atan2(y, 0.0), atan2(y, -0.0), atan2(y, 1.0)] == [0.0, 0.0, 0.0]
        assert atan2(y, -1.0) == math.pi


@given(places, places)
def test_the_arctangent_is_odd_and_mirrored_at_a_quarter_turn(y, x):
    angle = atan2(y, x)
    assert atan2(-y, x) == -angle
    assert math.copysign(1.0, angle) == math.copysign(1.0, y)
    assert abs(angle) <= math.pi
    assert atan2(y, -x) == pytest.approx(math.copysign(math.pi, y) - angle, abs=1e-15)


def beside_halves(rng):
    """Return exponents about halfway between multiples of log 2, where the power of two changes."""
    halves = (rng.integers(-1_020, 1_021, SAMPLES) + 0.5) * math.log(2)
    return halves + signs(rng) * 10.0 ** rng.uniform(-17, -1, SAMPLES)


def beyond_halves(rng):
    """Return exponents slightly beyond: there errors are largest for their last place."""
    return (rng.integers(-1_020, 1_021, SAMPLES) + rng.uniform(0.5, 0.65, SAMPLES)) * math.log(2)


EXPONENTS = {
    "all": lambda rng: rng.uniform(-708, 709, SAMPLES),
    "small": lambda rng: rng.uniform(-1, 1, SAMPLES),
    "tiny": lambda rng: signs(rng) * 10.0 ** rng.uniform(-20, 0, SAMPLES),
    "halves": beside_halves,
    "beyond": beyond_halves,
}


@pytest.mark.parametrize("sample", EXPONENTS.values(), ids=EXPONENTS)
def test_the_exponential_is_exact_but_for_about_one_unit_in_the_last_place(sample):
    exponents = sample(np.random.default_rng(3)).clip(-708, 709).tolist()
    assert ulps(map(exp, exponents), map(EXACT.exp, exponents)) < 1.1


def test_the_exponential_is_cut_where_its_value_ceases_to_be_normal():
    lowest, highest = exp(-708.0), exp(709.0)
    assert ulps([lowest, highest, exp(0.0)], [EXACT.exp(-708), EXACT.exp(709), EXACT.mpf(1)]) < 1.1
    assert [exp(x) for x in (-708.1, -1e300, -math.inf)] == [lowest] * 3
    assert [exp(x) for x in (709.1, 1e300, math.inf)] == [highest] * 3
    assert [exp(x) for x in (0.0, -0.0, 5e-324, 1e-20)] == [1.0] * 4


NUMBERS = {
    "all": lambda rng: 10.0 ** rng.uniform(-300, 300, SAMPLES),
    "usual": lambda rng: 10.0 ** rng.uniform(-3, 5, SAMPLES),
    "near one": lambda rng: 1.0 + signs(rng) * 10.0 ** rng.uniform(-15, -0.5, SAMPLES),
    "powers of two": lambda rng: (
        math.sqrt(0.5) * 2.0 ** rng.integers(-900, 900, SAMPLES) + signs(rng) * 1e-280
    ),
}


@pytest.mark.parametrize("sample", NUMBERS.values(), ids=NUMBERS)
def test_the_logarithm_is_exact_but_for_about_one_unit_in_the_last_place(sample):
    numbers = sample(np.random.default_rng(5)).tolist()
    assert ulps(map(log, numbers), map(EXACT.log, numbers)) < 1.1
    assert log(1.0) == 0.0


@given(st.integers(1 - 2**50, 2**50 - 1), st.integers(-2, 2))
def test_rounding_down_is_exact_at_wholes_and_halves_and_beside_them(twice, steps):
    for x in (0.5 * twice, float(twice)):
        beside = x + steps * math.ulp(x)
        assert floor(beside) == math.floor(beside)


@given(st.floats(-(2.0**51), 2.0**51, exclude_min=True, exclude_max=True))
@example(-5e-324)
@example(5e-324)
@example(-0.0)
@example(2.0**51 - 0.5)
@example(0.5 - 2.0**51)
@example(math.nextafter(0.5, 0.0))
@example(math.nextafter(-0.5, -1.0))
def test_rounding_down_is_exact_for_all_sizes(x):
    assert floor(x) == math.floor(x)


LANES = budget(10_000, 300)


def in_python(a, b):
    """Return the results of ``evaluate``, from calls for one number at a time."""
    rows = [
        [*sincos(x), atan2(x, y), exp(x), floor(x), log(abs(x) + 1.0)]
        for x, y in zip(a.tolist(), b.tolist(), strict=True)
    ]
    return np.array(rows).T


@pytest.fixture(scope="module")
def numbers():
    """Return numbers of all sizes side by side, so neighbouring lanes take different paths."""
    rng = np.random.default_rng(4)
    a, b = signs(rng, (2, LANES + 7)) * 10.0 ** rng.uniform(-12, 6, (2, LANES + 7))
    a[::5] = rng.integers(-40, 40, len(a[::5])) * (QUARTER / 2)
    b[::7] = a[::7]
    a[::11], b[::13] = 0.0, -0.0
    return a, b, in_python(a, b)


@pytest.mark.parametrize("lanes", [1, 2, 3, 5, 8, 15, 17, 100, LANES, LANES + 1, LANES + 7])
@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("first", [0, 1])
def test_every_lane_of_a_loop_gets_the_bits_of_a_call(numbers, lanes, threads, first):
    a, b, expected = (array[..., first : lanes + first].copy() for array in numbers)
    lanes = a.size
    results = np.full((6, lanes), np.nan)
    evaluate(lanes, a, b, results, threads=threads)
    assert results.tobytes() == expected.tobytes()
