"""This module declares the parts of a fleet whose type selects code: joints and bodies.

``OnAxles`` and ``Lines`` are the paper's. They hold no arrays, and absent features cost nothing. N
HAVs of a world, U units of a HAV, W worlds, as in ``hav_env.world.arrays``.
"""

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from hav_env.compiled import generic, lanes_from

Array = Any  # np.ndarray


class OnAxles(NamedTuple):
    """Every trailer is hitched on the axle ahead of it; a HAV has one limit for all joints."""


class Motion(NamedTuple):
    """Scratch: the motion of the unit ahead, while a kernel moves the units of a HAV one by one."""

    speed: Array  # (W,) speed of its axle [m/s]
    yaw_rate: Array  # (W,) [rad/s]
    cosine: Array  # (W,) cosine of its heading
    sine: Array  # (W,) sine of its heading


class Hitches(NamedTuple):
    """Every unit has a hitch off its axle, and every joint its own limit."""

    offset: Array  # (N, U, W) distance from the axle of a unit back to its trailer's hitch [m]
    limit: Array  # (N, U, W) articulation of a trailer beyond which the HAV is jackknifed [rad]
    ahead: Motion  # at the beginning of the step
    halfway: Motion  # in the middle of the step


class Lines(NamedTuple):
    """The body of a unit is a line, from its front end to its rear end: the paper's chain."""


class Outlines(NamedTuple):
    """The body of a unit is a rectangle."""

    shape: Array  # (N, U, 3, W) columns HALF_WIDTH .. REAR [m]
    reach: Array  # (N, W) radius round the truck's rear axle that holds the whole HAV [m]
    usual: Any  # the model: bodies of HAVs whose fleet states none


# half of the width; overhang ahead of the front end, which is the truck's front axle or the
# trailer's hitch; overhang behind the axle
HALF_WIDTH, FRONT, REAR = range(3)


def allocate_joints(hitched: bool, shape: tuple[int, int, int], zeros: Callable) -> Any:
    """Return the arrays of joints: ``Hitches`` or none.

    Args:
        hitched: Whether hitches may lie off the axles.
        shape: N, U and W.
        zeros: Function that makes each array from its shape and type.
    """
    if not hitched:
        return OnAxles()
    scratch = (Motion(*(zeros(shape[2:], np.float64) for _ in Motion._fields)) for _ in range(2))
    return Hitches(zeros(shape, np.float64), zeros(shape, np.float64) + np.pi, *scratch)


def allocate_bodies(bodies: Any, shape: tuple[int, int, int], zeros: Callable) -> Any:
    """Return the arrays of bodies: ``Outlines``, or none for ``Lines``.

    Args:
        bodies: Model of the bodies.
        shape: N, U and W.
        zeros: Function that makes each array from its shape and type.
    """
    if isinstance(bodies, Lines):
        return bodies
    n, u, w = shape
    return Outlines(zeros((n, u, 3, w), np.float64), zeros((n, w), np.float64), bodies)


def arrays_in(part: Any) -> Iterator[np.ndarray]:
    """Yield the arrays of worlds, or of a part of them, in order."""
    if isinstance(part, tuple):
        for inner in part:
            yield from arrays_in(inner)
    elif isinstance(part, np.ndarray):
        yield part


@generic
def part_from(part, first):
    """Return a part of the worlds of a batch from world ``first`` on."""


@part_from.register(OnAxles)
@part_from.register(Lines)
def _keep(part, first):
    return part


@part_from.register(Motion)
def _motion_from(part, first):
    return Motion(
        lanes_from(part.speed, first),
        lanes_from(part.yaw_rate, first),
        lanes_from(part.cosine, first),
        lanes_from(part.sine, first),
    )


@part_from.register(Hitches)
def _hitches_from(part, first):
    return Hitches(
        lanes_from(part.offset, first),
        lanes_from(part.limit, first),
        part_from(part.ahead, first),
        part_from(part.halfway, first),
    )


@part_from.register(Outlines)
def _outlines_from(part, first):
    return Outlines(lanes_from(part.shape, first), lanes_from(part.reach, first), part.usual)
