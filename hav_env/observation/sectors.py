"""This module finds the sector of directions in which a segment or a body may shorten rays.

A sector is a number: its first ray plus 256 times its number of rays, 0 if it has none.
"""

import math

from hav_env.compiled import kernel
from hav_env.maths.elementary import nearest_whole
from hav_env.maths.geometry import TURNS_PER_RADIAN
from hav_env.observation.columns import TINY_DISTANCE

SECTORS = 64  # that ``with_rays`` examines: bits of an integer
RAY_MASK = 0xFF  # of the first ray
_RAY_BITS, _PER_COUNT = 8, 256.0
_WIDER_SECTOR = 2e-3  # [rad], more than the errors of the polynomial and of single precision
_TO_DIAGONAL = 0.29289  # at most 1 - 1 / sqrt(2)
_TO_QUARTER = 0.5 * math.pi - 1.0 + 1e-6  # at least the arcsine of 1 less 1
_NEARLY_HALF = 0.49  # steps from ray to ray, less than a half by more than rounding
_SQUARES_SLACK = 1.0 + 1e-5  # more than single precision rounds squares of distances


@kernel
def rays_towards(rays, x, y, radius):
    """Return the first ray that may meet a circle, given its middle [m], and the ray count.

    The other rays follow counter-clockwise, ray 0 after the last one. The kernel never leaves out a
    ray that meets the circle, and may add one.

    With t = small / large, the distance of the middle is large * sqrt(1 + t^2). The function 1 /
    sqrt(1 + z) is convex, so it is below its chord from z = 0 to 1. The arcsine of a share, over
    that share, is convex in the square of the share, so it is below its chord too. The polynomial
    is within 7e-4 rad of the arctangent of t.
    """
    small, large = min(abs(x), abs(y)), max(abs(x), abs(y))
    per_large = 1.0 / max(large, TINY_DISTANCE)
    t = small * per_large
    z = t * t
    share = min(radius * per_large * (1.0 - _TO_DIAGONAL * z), 1.0)
    per_step = rays * TURNS_PER_RADIAN
    wider = _WIDER_SECTOR - _NEARLY_HALF / per_step  # the nearest ray is then the next one inside
    half = share + _TO_QUARTER * share * (share * share) + wider
    angle = t * (0.995354 + z * (0.079331 * z - 0.288679))
    angle = 0.5 * math.pi - angle if abs(y) > abs(x) else angle
    angle = math.pi - angle if x < 0.0 else angle
    angle = -angle if y < 0.0 else angle
    first = nearest_whole((angle - half) * per_step)
    count = min(nearest_whole((angle + half) * per_step) - first + 1.0, rays)
    inside = share == 1.0
    first = first + rays if first < 0.0 else first
    return 0.0 if inside else first, rays if inside else count


@kernel
def sector_of(rays, most, x, y, radius):
    """Return the rays that may meet a circle within a range [m] as one number, 0 for none."""
    within = most + radius
    near = x * x + y * y <= within * within * _SQUARES_SLACK
    first, count = rays_towards(rays, x, y, radius)
    return first + count * _PER_COUNT if near & (count > 0.0) else 0.0


@kernel
def unpack_sector(sector):
    """Return the first ray of a sector and its number of rays, given the sector as an integer."""
    return sector & RAY_MASK, sector >> _RAY_BITS


@kernel
def with_rays(sectors, first, end):
    """Return which of at most ``SECTORS`` sectors have rays, one bit each, the first one lowest.

    Args:
        sectors: (L,) sectors.
        first: Index of the first sector.
        end: Index after the last one; sectors beyond the most are left out.
    """
    bits = 0
    for k in range(min(end - first, SECTORS)):
        bits |= (1 << k) if sectors[first + k] != 0.0 else 0
    return bits
