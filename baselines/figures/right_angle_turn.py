"""This module drives vehicles of the catalogue round a corner, for off-tracking and tail swing.

The manoeuvre is that of turning tests. The middle of the truck's front axle follows a straight
line, an arc to the left, and a straight line again. The classical Runge-Kutta method integrates the
headings of all units over the path of the front axle. ``hav_env.vehicles.steady_circles`` states
the equations.
"""

import functools
import math
from typing import NamedTuple

import numpy as np

from hav_env.vehicles import Combination
from hav_env.vehicles.steady_circles import least_radius

USUAL_RADIUS = 12.5
"""Radius of the arc [m], the outer radius of the ring of Directive 96/53/EC."""
SPARE = 1.02
"""Radius of the turn, as a multiple of the least one."""
_WAY = 0.05  # [m] step along the front axle's path
_EDGE_POINTS = 11  # points on a long side of a body


class Turn(NamedTuple):
    """A vehicle in a turn round a corner: the arc begins at (0, 0), to the left of heading 0."""

    vehicle: Combination
    """The vehicle."""
    radius: float
    """Radius of the arc [m]."""
    angle: float
    """Angle of the arc [rad]."""
    headings: np.ndarray
    """(T, K) headings of the units [rad]."""
    axles: np.ndarray
    """(T, K, 2) axles of the units [m], the truck's rear axle first."""


def tightest_radius(vehicle: Combination) -> float:
    """Return the least radius [m] of the truck's rear axle in a steady turn.

    Steering and articulations stay within their limits.
    """
    wheels = vehicle.lengths[0] / math.tan(vehicle.steering_max)
    return max(wheels, least_radius(vehicle.lengths, vehicle.offsets, vehicle.limits))


def turn_radius(vehicle: Combination) -> float:
    """Return the radius [m] of the front axle's arc: the usual one if the vehicle can follow it."""
    least = math.hypot(vehicle.lengths[0], SPARE * tightest_radius(vehicle))
    return max(USUAL_RADIUS, least)


@functools.cache
def usual_turn(vehicle: Combination) -> Turn:
    """Drive a vehicle round a corner of 90 degrees with ``turn_radius``."""
    return drive_turn(vehicle, turn_radius(vehicle))


def drive_turn(
    vehicle: Combination, radius: float, angle: float = math.pi / 2, step: float = _WAY
) -> Turn:
    """Drive a vehicle round an arc, and on until its rear end is straight again.

    Args:
        vehicle: Vehicle of the catalogue; it begins straight.
        radius: Radius of the arc of the truck's front axle [m].
        angle: Angle of the arc [rad].
        step: Step along the front axle's path [m].
    """
    arc = radius * angle
    ways = step * np.arange(math.ceil((arc + 2.0 * vehicle.overall_length) / step) + 1)
    headings = np.zeros((len(ways), len(vehicle.units)))
    for k, way in enumerate(ways[:-1]):
        ahead = [min((way + part * step) / radius, angle) for part in (0.0, 0.5, 1.0)]
        now = headings[k]
        k1 = _rates(vehicle, now, ahead[0])
        k2 = _rates(vehicle, now + 0.5 * step * k1, ahead[1])
        k3 = _rates(vehicle, now + 0.5 * step * k2, ahead[1])
        k4 = _rates(vehicle, now + step * k3, ahead[2])
        headings[k + 1] = now + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    bearing = np.minimum(ways, arc) / radius
    front = radius * np.stack([np.sin(bearing), 1.0 - np.cos(bearing)], axis=-1)
    onward = np.maximum(ways - arc, 0.0)[:, None]
    front = front + onward * np.array([math.cos(angle), math.sin(angle)])
    return Turn(vehicle, radius, angle, headings, _axles_behind(vehicle, headings, front))


def _rates(vehicle: Combination, headings: np.ndarray, direction: float) -> np.ndarray:
    """Return the change of headings per metre of the front axle's path."""
    steering = direction - headings[0]
    speed, rates = math.cos(steering), np.empty(len(headings))
    rates[0] = math.sin(steering) / vehicle.units[0].length
    for unit in range(1, len(headings)):
        length, hitch = vehicle.units[unit][:2]
        bend = headings[unit] - headings[unit - 1]
        sine, cosine = math.sin(bend), math.cos(bend)
        rates[unit] = -(speed * sine + hitch * rates[unit - 1] * cosine) / length
        speed = speed * cosine - hitch * rates[unit - 1] * sine
    return rates


def _axles_behind(vehicle: Combination, headings: np.ndarray, front: np.ndarray) -> np.ndarray:
    along = np.stack([np.cos(headings), np.sin(headings)], axis=-1)
    axles = np.empty(along.shape)
    for place, unit in enumerate(vehicle.units):
        hitch = axles[:, place - 1] - unit.hitch * along[:, place - 1] if place else front
        axles[:, place] = hitch - unit.length * along[:, place]
    return axles


def body_points(turn: Turn, samples: slice = slice(None)) -> np.ndarray:
    """Return points of the outlines of all bodies (T, K, P, 2) [m].

    The first half of the P points are on the right side from rear to front. The other half are on
    the left side from front to rear, so all form a closed outline.

    Args:
        turn: Vehicle in a turn.
        samples: Selection of the T moments.
    """
    outlines = []
    for place, unit in enumerate(turn.vehicle.units):
        along = np.linspace(-unit.rear, unit.length + unit.front, _EDGE_POINTS)
        along = np.sort(np.append(along, 0.0))  # a body is nearest to the centre beside the axle
        right = along - 1j * unit.half_width
        outline = np.concatenate([right, right[::-1].conj()])
        heading = turn.headings[samples, place, None]
        axle = turn.axles[samples, place] @ np.array([1.0, 1j])
        points = axle[:, None] + outline * np.exp(1j * heading)
        outlines.append(np.stack([points.real, points.imag], axis=-1))
    return np.stack(outlines, axis=1)


def inside_of(turn: Turn, points: np.ndarray) -> np.ndarray:
    """Return the distance of points inside the front axle's path [m], negative outside.

    Args:
        turn: Turn of less than 180 degrees.
        points: (..., 2) points near that path [m].
    """
    x, y = points[..., 0], points[..., 1]
    # bearing from the arc's centre, 0 where the arc begins
    bearing = np.arctan2(x, turn.radius - y)
    cosine, sine = math.cos(turn.angle), math.sin(turn.angle)
    end_x, end_y = turn.radius * sine, turn.radius * (1.0 - cosine)
    after = (y - end_y) * cosine - (x - end_x) * sine
    on_arc = turn.radius - np.hypot(x, turn.radius - y)
    before = x < 0.0
    beyond = (x - end_x) * cosine + (y - end_y) * sine > 0.0
    straight = np.where(before & (~beyond | (np.abs(y) < np.abs(after))), y, after)
    return np.where((bearing >= 0.0) & (bearing <= turn.angle), on_arc, straight)


def off_tracking(turn: Turn) -> float:
    """Return the largest distance of any axle inside the front axle's path [m]."""
    return float(inside_of(turn, turn.axles).max())


def swept_width(turn: Turn) -> float:
    """Return the required width of a road [m]: the space of bodies inside and outside the path."""
    inside = inside_of(turn, body_points(turn))
    return float(inside.max() - inside.min())


def tail_swing(turn: Turn) -> float:
    """Return the largest swing of a rear corner beyond that side's line before the turn [m]."""
    outline = body_points(turn)
    widths = np.array([unit.half_width for unit in turn.vehicle.units])
    beyond = -outline[:, :, 0, 1] - widths  # the rear corner on the right, T times K
    return float(max(0.0, beyond.max()))
