"""This module computes sine, cosine, arctangent, exponential and rounding on several lanes at once.

The C library's functions take one number at a time, and differ between platforms. These consist of
additions, multiplications (fused where the code says so), divisions and selections. A compiler
therefore turns a loop over lanes into vector instructions. Results are bit-equal everywhere:
compiled for any processor, or in plain Python.

Errors are in units in the last place (ulp) of the result, measured against exact values by
tests/maths/test_elementary.py.
"""

import math

from hav_env.compiled import either, fma, kernel, like, rounder_of, split_power, two_to, whole_in

_QUARTER_TURNS = 2.0 / math.pi
# Pairs are constants in double and in single precision, see ``either``.
# pi / 2 in 159 bits: some numbers are within 1e-17 of its multiples
_QUARTER_HIGH = 0.5 * math.pi
_QUARTER_MIDDLE = 6.123233995736766e-17, -4.371138828673793e-08
_QUARTER_LOW = -1.4973849048591833e-33, -1.7151245100058819e-15
_TAN_PI_8 = 0.41421356237309503
_SMALLEST = 1e-300, 1e-37  # avoids 0 / 0
_LOG2_E = 1.4426950408889634
_LN_2_HIGH, _LN_2_LOW = 0.6931471805599453, (2.3190468138462996e-17, -1.904654323148236e-09)
_EXP_LOW, _EXP_HIGH = (-708.0, -87.0), (709.0, 88.0)  # there the result is a normal number


@kernel
def sqrt(x):
    """Return the square root of a number, as precise as the number."""
    return like(math.sqrt(x), x)


@kernel
def floor(x):
    """Return the greatest whole number that is not above x, for |x| < 2**51, as a float.

    In single precision |x| must be below 2**22.
    """
    nearest = nearest_whole(x)
    return nearest - 1.0 if nearest > x else nearest


@kernel
def nearest_whole(x):
    """Return the whole number nearest to x, of two the even one, with the limits of ``floor``."""
    return (x + rounder_of(x)) - rounder_of(x)


@kernel
def sincos(angle):
    """Return sine and cosine of an angle [rad]: within 2 ulp for |angle| up to 1e6.

    The angle is reduced to [-pi / 4, pi / 4]; ``small_sincos`` does the rest. Beyond 1e6 the
    reduction loses digits, and beyond about 1e15 the result is meaningless; NaN stays NaN.
    """
    shifted = fma(angle, _QUARTER_TURNS, rounder_of(angle))
    quarters = shifted - rounder_of(angle)
    quadrant = whole_in(shifted)
    r = fma(-quarters, _QUARTER_HIGH, angle)
    r = fma(-quarters, either(angle, *_QUARTER_MIDDLE), r)
    sine, cosine = small_sincos(fma(-quarters, either(angle, *_QUARTER_LOW), r))
    swapped = (quadrant & 1) != 0
    first, second = cosine if swapped else sine, sine if swapped else cosine
    return (
        -first if (quadrant & 2) != 0 else first,
        -second if ((quadrant + 1) & 2) != 0 else second,
    )


@kernel
def small_sincos(r):
    """Return sine and cosine of an angle r [rad] with |r| <= pi / 4: the bits of ``sincos``.

    In this range the reduction of ``sincos`` changes nothing. 2 r / pi rounds to 0, so ``quarters``
    and ``quadrant`` are 0: nothing is subtracted from r, nothing is swapped, and no sign changes.
    Only the zeros differ: -0.0 - 0.0 * _QUARTER_LOW is 0.0, because these constants are negative.
    However, the sine of either zero is 0.0: p is negative, so r * z * p + r adds two zeros of
    opposite signs.

    The polynomials are those of fdlibm.
    """
    z = r * r
    p = fma(1.58969099521155010221e-10, z, -2.50507602534068634195e-08)
    p = fma(fma(p, z, 2.75573137070700676789e-06), z, -1.98412698298579493134e-04)
    p = fma(fma(p, z, 8.33333333332248946124e-03), z, -1.66666666666666324348e-01)
    q = fma(-1.13596475577881948265e-11, z, 2.08757232129817482790e-09)
    q = fma(fma(q, z, -2.75573143513506633035e-07), z, 2.48015872894767294178e-05)
    q = fma(fma(q, z, -1.38888888888741095749e-03), z, 4.16666666666666019037e-02)
    sine = fma(r * z, p, r)
    rest = fma(-0.5, z, 1.0)  # the polynomial restores the part that its rounding cut off
    return sine, rest + fma(z * z, q, fma(-0.5, z, 1.0 - rest))


@kernel
def atan2_positive(y, x):
    """Return ``atan2`` of two numbers that are not negative."""
    small, large = min(y, x), max(y, x) + either(x, *_SMALLEST)
    steep = small > _TAN_PI_8 * large
    t = (small - large if steep else small) / (small + large if steep else large)
    # fdlibm's polynomial, with even and odd powers apart: two short sums instead of a long one
    z = t * t
    w = z * z
    p = fma(1.62858201153657823623e-02, w, 4.97687799461593236017e-02)
    p = fma(fma(p, w, 6.66107313738753120669e-02), w, 9.09088713343650656196e-02)
    p = fma(fma(p, w, 1.42857142725034663711e-01), w, 3.33333333333329318027e-01)
    q = fma(-3.65315727442169155270e-02, w, -5.83357013379057348645e-02)
    q = fma(fma(q, w, -7.69187620504482999495e-02), w, -1.11111104054623557880e-01)
    q = fma(q, w, -1.99999999998764832476e-01)
    angle = fma(-t, fma(z, p, w * q), t)
    angle = angle + 0.25 * math.pi if steep else angle
    return 0.5 * math.pi - angle if y > x else angle


@kernel
def atan2(y, x):
    """Return the angle of (x, y) in [-pi, pi]: within 3 ulp.

    atan2(0, 0) is 0; a zero has no sign: atan2(-0.0, -1.0) is pi. Both must be numbers, and the
    larger of |x| and |y| 0 or from 1e-280 to 1e300.
    """
    angle = atan2_positive(abs(y), abs(x))
    angle = math.pi - angle if x < 0.0 else angle
    return -angle if y < 0.0 else angle


@kernel
def exp(x):
    """Return e**x within 2 ulp; x is clipped to [-708, 709], where the result is normal.

    In single precision x is clipped to [-87, 88].
    """
    x = min(max(x, either(x, *_EXP_LOW)), either(x, *_EXP_HIGH))
    shifted = fma(x, _LOG2_E, rounder_of(x))
    doublings = shifted - rounder_of(x)
    r = fma(-doublings, either(x, *_LN_2_LOW), fma(-doublings, _LN_2_HIGH, x))
    # (e^r - 1 - r) / r^2 interpolated at Chebyshev's points, even and odd powers apart
    z = r * r
    p = fma(2.7620075880100385e-07, z, 2.4801521322368448e-05)
    p = fma(fma(p, z, 1.3888888917196719e-03), z, 4.1666666666624164e-02)
    p = fma(p, z, 5.0000000000000011e-01)
    q = fma(2.510037583265122e-08, z, 2.7557268480309837e-06)
    q = fma(fma(q, z, 1.9841269863040545e-04), z, 8.333333333330065e-03)
    q = fma(q, z, 1.6666666666666669e-01)
    return two_to(shifted) * (1.0 + fma(z, fma(r, q, p), r))


@kernel
def log(x):
    """Return the natural logarithm of a positive normal number: within 1 ulp.

    x is a power of two times 1 + f with f in [sqrt(1/2) - 1, sqrt(2) - 1]; there the polynomial is
    fdlibm's.
    """
    doublings, mantissa = split_power(x)
    f = mantissa - 1.0
    s = f / (2.0 + f)
    z = s * s
    w = z * z
    p = fma(1.479819860511658591e-01, w, 1.818357216161805012e-01)
    p = fma(fma(p, w, 2.857142874366239149e-01), w, 6.666666666666735130e-01)
    q = fma(fma(1.531383769920937332e-01, w, 2.222219843214978396e-01), w, 3.999999999940941908e-01)
    half_square = 0.5 * f * f
    rest = fma(s, half_square + fma(z, p, w * q), doublings * either(x, *_LN_2_LOW))
    return fma(doublings, _LN_2_HIGH, f - (half_square - rest))
