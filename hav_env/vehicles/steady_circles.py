"""This module has closed forms of truck-trailer chains: steady circles, radii, swept rings.

They hold for chains with any mix of on-axle hitches, drawbars and fifth wheels. A chain is the
lengths (K,) of its units [m], the truck's wheelbase first, and the offsets (K,) of their hitches
[m], the distance behind the axle of the unit ahead. ``offsets[0]`` is not used. The equations are
those of the general n-trailer, for articulation d_j, speed v_j and yaw rate w_j of unit j. With c_j
= 0 they are equation (2) of the paper::

    v_j     =  v_{j-1} cos d_j - c_j w_{j-1} sin d_j
    l_j w_j = -v_{j-1} sin d_j - c_j w_{j-1} cos d_j

Radii are those of the truck's rear axle unless a function states otherwise. The paper's R_min is
that of its front axle: ``math.hypot(lengths[0], least_radius(lengths, offsets))``.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from hav_env.maths.hitched_circle import add_joint

Floats = Sequence[float] | np.ndarray
_HALVINGS = 100  # halvings of an interval of radii, until its ends are neighbours


class SweptRing(NamedTuple):
    """The ring that the bodies of a chain sweep on a steady circle."""

    inner: float
    """Radius [m] of the circle that no body enters; 0 if a body contains the centre."""
    outer: float
    """Radius [m] of the circle that contains all bodies."""


def steady_radii(radius: float, lengths: Floats, offsets: Floats) -> np.ndarray:
    """Return the radii (K,) [m] of all axles while the truck's rear axle drives round a circle.

    Args:
        radius: radius of the truck's rear axle [m].
        lengths: (K,) lengths of the units [m].
        offsets: (K,) distances of the hitches behind the axle ahead [m].

    Raises:
        ValueError: if the chain cannot follow on that circle without end.
    """
    squared = [radius * radius]
    for length, offset in _joints(lengths, offsets):
        squared.append(squared[-1] + (offset * offset - length * length))
    rounding = 1e-12 * (squared[0] + float(np.sum(np.square(lengths[1:]))))
    if min(squared) < -rounding:
        least = least_radius(lengths, offsets)
        raise ValueError(f"radius is {radius} m, but must be at least {least} m for this chain")
    return np.sqrt(np.maximum(squared, 0.0))


def steady_articulations(radius: float, lengths: Floats, offsets: Floats) -> np.ndarray:
    """Return the articulations on a steady circle (K - 1,) [rad].

    It is atan(c_j / r_{j-1}) + atan(l_j / r_j). A left turn of the truck makes it negative.

    Args:
        radius: radius of the truck's rear axle [m].
        lengths: (K,) lengths of the units [m].
        offsets: (K,) offsets of their hitches [m].

    Raises:
        ValueError: if the chain cannot follow on that circle without end.
    """
    radii = steady_radii(radius, lengths, offsets)
    ahead = np.arctan2(np.asarray(offsets, float)[1:], radii[:-1])
    return ahead + np.arctan2(np.asarray(lengths, float)[1:], radii[1:])


def least_radius(lengths: Floats, offsets: Floats, limits: Floats | None = None) -> float:
    """Return the least radius [m] on which the chain can circle without end.

    It is the square root of the largest sum of l^2 - c^2 over the first trailers. The sum over all
    trailers need not be the largest. Limits of articulation require more
    (``hav_env.maths.hitched_circle.needed_squared``).

    Args:
        lengths: (K,) lengths of the units [m].
        offsets: (K,) offsets of their hitches [m].
        limits: (K,) greatest articulation of each unit [rad], above 0 and below pi, the truck's
            unused; none by default.
    """
    if limits is None:
        kept = np.cumsum(np.square(lengths)[1:] - np.square(offsets)[1:])
        return math.sqrt(max(0.0, *kept))
    least, lost = 0.0, 0.0
    for (length, offset), limit in zip(_joints(lengths, offsets), limits[1:], strict=True):
        least, lost = add_joint(least, lost, length, offset, math.cos(limit))
    return math.sqrt(least)


def articulation_bounds(curvature: float, lengths: Floats, offsets: Floats) -> np.ndarray:
    """Return bounds (K - 1,) [rad] of all articulations for ANY steering within a curvature.

    They hold at all later times, forwards and at any speed, once all articulations are within them.
    With k the greatest curvature of the axle ahead, sin d = k (l + c cos d), and the next curvature
    is at most tan(d + atan(|c| k)) / l. For fifth wheels and on-axle hitches these are the
    articulations on the steady circle. Drawbars exceed those under counter-steering. A bound is
    infinite if the formula gives none below 90 degrees.

    Args:
        curvature: greatest curvature of the path of the truck's rear axle [1/m].
        lengths: (K,) lengths of the units [m].
        offsets: (K,) offsets of their hitches [m].
    """
    bounds = np.full(len(lengths) - 1, math.inf)
    for joint, (length, offset) in enumerate(_joints(lengths, offsets)):
        sine = curvature * length / math.hypot(1.0, curvature * offset)
        if not sine <= 1.0:
            break
        bounds[joint] = math.asin(sine) + math.atan(curvature * offset)
        behind = bounds[joint] + math.atan(curvature * abs(offset))
        curvature = math.tan(behind) / length if behind < math.pi / 2 else math.inf
    return bounds


def least_radius_of_any_steering(lengths: Floats, offsets: Floats, limits: Floats) -> float:
    """Return the least radius [m] for which no steering exceeds a limit of articulation.

    No steering of a truck within this radius bends any joint beyond its limit. It is the least
    radius for which ``articulation_bounds`` proves that, and may be far too wide for long trains of
    drawbars.

    Args:
        lengths: (K,) lengths of the units [m].
        offsets: (K,) offsets of their hitches [m].
        limits: (K,) greatest articulation of each unit [rad], the truck's unused.
    """
    most = np.asarray(limits, float)[1:]

    def holds(radius: float) -> bool:
        return bool(np.all(articulation_bounds(1.0 / radius, lengths, offsets) <= most))

    low = high = max(least_radius(lengths, offsets), 1e-3)
    while not holds(high):
        low, high = high, 2.0 * high
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


def swept_ring(
    radius: float,
    lengths: Floats,
    offsets: Floats,
    half_widths: Floats,
    fronts: Floats,
    rears: Floats,
) -> SweptRing:
    """Return the ring that rectangular bodies sweep on a steady circle.

    Args:
        radius: radius of the truck's rear axle [m].
        lengths: (K,) lengths of the units [m].
        offsets: (K,) offsets of their hitches [m].
        half_widths: (K,) half widths of the bodies [m].
        fronts: (K,) reach of each body ahead of its front axle or hitch [m].
        rears: (K,) reach of each body behind its axle [m].

    Raises:
        ValueError: if the chain cannot follow on that circle without end.
    """
    centre = steady_radii(radius, lengths, offsets)  # to the left of each axle
    front, rear = np.add(lengths, fronts), np.asarray(rears, float)
    farthest = np.hypot(np.maximum(np.abs(front), np.abs(rear)), centre + half_widths)
    nearest = np.hypot(np.clip(0.0, -rear, front), np.maximum(centre - half_widths, 0.0))
    return SweptRing(float(nearest.min()), float(farthest.max()))


def fastest_point_gain(
    curvature: float,
    lengths: Floats,
    offsets: Floats,
    half_widths: Floats,
    fronts: Floats,
    rears: Floats,
) -> float:
    """Return the largest speed of any point of a body over that of the truck's rear axle.

    A hitch moves at most max(1, |c| / l) times as fast as the hitch ahead. In the frame of a
    trailer, whose hitch moves at unit speed, a point's velocity is linear in the direction of the
    hitch: the larger eigenvalue of its squares bounds it.

    Args:
        curvature: greatest curvature of the path of the truck's rear axle [1/m].
        lengths: (K,) lengths of the units [m].
        offsets: (K,) offsets of their hitches [m].
        half_widths: (K,) half widths of the bodies [m].
        fronts: (K,) reach of each body ahead of its front axle or hitch [m].
        rears: (K,) reach of each body behind its axle [m].
    """
    along = np.maximum(np.abs(np.add(lengths, fronts)), np.abs(rears))
    aside = np.asarray(half_widths, float)
    fastest = math.hypot(1.0 + curvature * aside[0], curvature * along[0])
    hitch = 1.0
    for unit, (length, offset) in enumerate(_joints(lengths, offsets), start=1):
        turning = curvature if unit == 1 else 1.0 / lengths[unit - 1]  # of the unit ahead
        sideways = abs(offset) * turning
        hitch *= math.hypot(1.0, sideways) if unit == 1 else max(1.0, sideways)
        skew, square = aside[unit] / length, (along[unit] ** 2 + aside[unit] ** 2) / length**2
        larger = 0.5 * (1.0 + square) + math.hypot(0.5 * (1.0 - square), skew)
        fastest = max(fastest, hitch * math.sqrt(larger))
    return float(fastest)


def check_damped(lengths: Floats, offsets: Floats) -> None:
    """Check that no trailer swings more than the unit ahead of it, at any frequency.

    From heading to heading a joint is (v - c s) / (v + l s): stable for every c, but it multiplies
    quick swings by |c| / l.

    Args:
        lengths: (K,) lengths of the units [m].
        offsets: (K,) offsets of their hitches [m].

    Raises:
        ValueError: if an offset exceeds its trailer's length.
    """
    for unit, (length, offset) in enumerate(_joints(lengths, offsets), start=1):
        if not abs(offset) <= length:
            raise ValueError(
                f"hitch offset of unit {unit} is {offset} m, but must be at most its length,"
                f" {length} m: a longer one amplifies swings from unit to unit"
            )


def _joints(lengths: Floats, offsets: Floats) -> list[tuple[float, float]]:
    """Return length and hitch offset of each trailer."""
    return list(zip(map(float, lengths[1:]), map(float, offsets[1:]), strict=True))
