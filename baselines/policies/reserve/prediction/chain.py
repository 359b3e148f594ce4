"""Axles of the own chain in thought: where they are, how they are pulled, what they touch."""

import math

from baselines.policies.reserve.memory.rows import (
    AXLES,
    CHAIN,
    CLOSE,
    DOUBT,
    KIND,
    NUM_AXLES,
    NUM_SLOTS,
    OWN_LENGTHS,
    OWN_SAG,
    OWN_STEP,
    OWN_TRAILERS,
    SEEN,
    SLOT_AXLES,
    STANDING,
    SWEPT,
    WERE,
)
from baselines.policies.reserve.perception.other_agents import slot_at
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.geometry import hull_apart, segments_apart
from hav_env.maths.kdop import SIDES, include_point

_RIGHT, _TOP, _LEFT, _BOTTOM = 0, SIDES // 4, SIDES // 2, 3 * SIDES // 4


@rare_kernel
def place_axles(rows, x, y):
    """Write the axles of the chain whose truck's rear axle is at (x, y) [m]."""
    length = rows[OWN_LENGTHS]
    rows[AXLES], rows[AXLES + 1] = x + length * rows[CHAIN], y + length * rows[CHAIN + 1]
    rows[AXLES + 2], rows[AXLES + 3] = x, y
    for unit in range(1, int(rows[OWN_TRAILERS]) + 1):
        length = rows[OWN_LENGTHS + unit]
        x -= length * rows[CHAIN + 2 * unit]
        y -= length * rows[CHAIN + 2 * unit + 1]
        rows[AXLES + 2 * unit + 2], rows[AXLES + 2 * unit + 3] = x, y


@rare_kernel
def move_axles(rows, x, y):
    """Place the axles after a step, and keep where they were before it."""
    for row in range(2 * (int(rows[OWN_TRAILERS]) + 2)):
        rows[WERE + row] = rows[AXLES + row]
    place_axles(rows, x, y)


@rare_kernel
def pull_axles(rows, x, y, cosine, sine):
    """Move the truck to a pose and let the axles follow like ropes: a coarse step."""
    length = rows[OWN_LENGTHS]
    rows[AXLES], rows[AXLES + 1] = x + length * cosine, y + length * sine
    rows[AXLES + 2], rows[AXLES + 3] = x, y
    for unit in range(1, int(rows[OWN_TRAILERS]) + 1):
        at = AXLES + 2 * unit + 2
        dx, dy = x - rows[at], y - rows[at + 1]
        share = rows[OWN_LENGTHS + unit] / math.sqrt(dx * dx + dy * dy)
        x, y = x - share * dx, y - share * dy
        rows[at], rows[at + 1] = x, y


@rare_kernel
def include_axles(rows, outline):
    """Include all axles in an outline."""
    for axle in range(int(rows[OWN_TRAILERS]) + 2):
        include_point(rows, outline, rows[AXLES + 2 * axle], rows[AXLES + 2 * axle + 1])


@rare_kernel
def keeps_clear_of(rows, slot, margin):
    """Tell whether the axles' chain is more than a margin [m] from one that stands."""
    for axle in range(int(rows[OWN_TRAILERS]) + 1):
        at = AXLES + 2 * axle
        if not link_keeps_clear(
            rows, slot, rows[at], rows[at + 1], rows[at + 2], rows[at + 3], margin
        ):
            return False
    return True


@rare_kernel
def link_keeps_clear(rows, slot, ax, ay, bx, by, margin):
    """Tell whether the segment a-b is more than a margin [m] from one that stands."""
    seen = slot + SEEN
    margin += rows[slot + DOUBT]
    if (
        min(ax, bx) > rows[seen + _RIGHT] + margin
        or min(ay, by) > rows[seen + _TOP] + margin
        or -max(ax, bx) > rows[seen + _LEFT] + margin
        or -max(ay, by) > rows[seen + _BOTTOM] + margin
    ):
        return True
    for other in range(int(rows[slot + NUM_AXLES]) - 1):
        at = slot + SLOT_AXLES + 2 * other
        if not segments_apart(
            *(ax, ay, bx, by),
            *(rows[at], rows[at + 1], rows[at + 2], rows[at + 3]),
            margin,
        ):
            return False
    return True


@rare_kernel
def keeps_clear(rows, margin):
    """Tell whether the chain keeps clear of all that stand and are close, in the step just made.

    At its end it must keep a margin [m] from them. On the way there it must not touch them,
    whatever way its axles take between their places (docs/safety.md, between steps).
    """
    for number in range(int(rows[NUM_SLOTS])):
        slot = slot_at(number)
        if (
            rows[slot + KIND] == STANDING
            and rows[slot + CLOSE] > 0.0
            and not (
                keeps_clear_of(rows, slot, margin + rows[OWN_SAG]) and _step_keeps_clear(rows, slot)
            )
        ):
            return False
    return True


@rare_kernel
def _step_keeps_clear(rows, slot):
    """Tell whether no link of the chain can touch one that stands on its way through the step."""
    for axle in range(int(rows[OWN_TRAILERS]) + 1):
        at = 2 * axle
        moved = max(_moved(rows, at), _moved(rows, at + 2)) + rows[OWN_STEP] + rows[OWN_SAG]
        ends = rows[AXLES + at], rows[AXLES + at + 1], rows[AXLES + at + 2], rows[AXLES + at + 3]
        if not link_keeps_clear(rows, slot, *ends, moved):
            _write_swept(rows, axle)
            if not _swept_keeps_clear(rows, slot, rows[OWN_SAG] + rows[slot + DOUBT]):
                return False
    return True


@kernel
def _moved(rows, at):
    """Return how far an axle [m] is from where it was a step before."""
    dx, dy = rows[AXLES + at] - rows[WERE + at], rows[AXLES + at + 1] - rows[WERE + at + 1]
    return math.sqrt(dx * dx + dy * dy)


@rare_kernel
def _write_swept(rows, axle):
    """Write corners of a convex set that holds the link behind an axle all through the step.

    They are both ends of the link before and after the step, and how far the axle can get on the
    link ahead, along which it is pulled. The front axle is pulled by nothing.
    """
    for end in range(2):
        at = 2 * (axle + end)
        rows[SWEPT + 4 * end], rows[SWEPT + 4 * end + 1] = rows[WERE + at], rows[WERE + at + 1]
        rows[SWEPT + 4 * end + 2], rows[SWEPT + 4 * end + 3] = (
            rows[AXLES + at],
            rows[AXLES + at + 1],
        )
    at, share = WERE + 2 * axle, 0.0
    if axle > 0:
        share = rows[OWN_STEP] / rows[OWN_LENGTHS + axle - 1]
    ahead = at - 2 if axle > 0 else at
    rows[SWEPT + 8] = rows[at] + share * (rows[ahead] - rows[at])
    rows[SWEPT + 9] = rows[at + 1] + share * (rows[ahead + 1] - rows[at + 1])


@rare_kernel
def _swept_keeps_clear(rows, slot, margin):
    """Tell whether the convex hull of the corners in ``SWEPT`` keeps a margin [m] from one."""
    for link in range(int(rows[slot + NUM_AXLES]) - 1):
        at = slot + SLOT_AXLES + 2 * link
        if not hull_apart(
            rows, SWEPT, 5, rows[at], rows[at + 1], rows[at + 2], rows[at + 3], margin
        ):
            return False
    return True


@kernel
def nose_swept(rows, slot, before_x, before_y, margin):
    """Tell whether the nose kept clear of one that stands on its way from where it was [m]."""
    return link_keeps_clear(rows, slot, before_x, before_y, rows[AXLES], rows[AXLES + 1], margin)
