"""Axles of the own chain in thought: where they are, how they are pulled, what they touch."""

import math

from baselines.reserve.layout import (
    AXLES,
    CHAIN,
    CLOSE,
    DOUBT,
    KIND,
    NUM_AXLES,
    NUM_SLOTS,
    OWN_LENGTHS,
    OWN_TRAILERS,
    SEEN,
    SLOT_AXLES,
    STANDING,
)
from baselines.reserve.others import slot_at
from hav_env.compiled import kernel, rare_kernel
from hav_env.geometry import segments_apart
from hav_env.outline import SIDES, include_point

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
    """Tell whether the axles' chain keeps a margin [m] from all that stand and are close."""
    for number in range(int(rows[NUM_SLOTS])):
        slot = slot_at(number)
        if (
            rows[slot + KIND] == STANDING
            and rows[slot + CLOSE] > 0.0
            and not keeps_clear_of(rows, slot, margin)
        ):
            return False
    return True


@kernel
def nose_swept(rows, slot, before_x, before_y, margin):
    """Tell whether the nose kept clear of one that stands on its way from where it was [m]."""
    return link_keeps_clear(rows, slot, before_x, before_y, rows[AXLES], rows[AXLES + 1], margin)
