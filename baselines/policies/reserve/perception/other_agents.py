"""This module measures distances to the others in a HAV's slots, and remembers the near ones.

A neighbour is *near* if the circles that circumscribe both are less than ``NEAR_GAP`` apart. A
*newcomer* is near, but was not when the HAV last remembered its neighbourhood.
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes, states
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.geometry import into_frame
from hav_env.maths.kdop import SIDES, corner, outline_gap, turn_outline
from hav_env.policies.interface import heard
from hav_env.world.sensing import (
    neighbor_footprint,
    neighbor_id,
    neighbor_length,
    neighbor_position,
    num_neighbors,
)

NEAR_GAP = 30.0  # [m] between two circumscribing circles: far more than both drive in a step
_GAIN = 4.0  # [m] that sides of the other outline hardly add to a gap: then they are not tested
_HASH_SHIFT = 0.123  # makes the hash of one number differ from sums of hashes of others


@kernel
def slot_at(number):
    """Return the first row of a slot."""
    return m.FIRST_SLOT + m.SLOT_ROWS * number


@rare_kernel
def gap_to(rows, slot, outline, enough):
    """Return a lower bound of the distance [m] from an own outline to the outline in a slot.

    It is the largest gap across the own sides. If that is less than ``enough`` [m], but not by
    much, the gaps across the sides of the other outline count too.
    """
    gap = outline_gap(rows, outline, slot + m.SLOT_OUTLINE)
    if gap > enough or gap < enough - _GAIN or rows[slot + m.SLOT_KIND] == states.STANDING:
        return gap
    x, y = rows[slot + m.SLOT_FRAME], rows[slot + m.SLOT_FRAME + 1]
    cosine, sine = rows[slot + m.SLOT_FRAME + 2], rows[slot + m.SLOT_FRAME + 3]
    back_x, back_y = -x * cosine - y * sine, x * sine - y * cosine
    turn_outline(rows, m.TURNED_OUTLINE, rows, outline, back_x, back_y, cosine, -sine)
    return max(gap, outline_gap(rows, m.TURNED_OUTLINE, slot + m.SLOT_BROADCAST_OUTLINE))


@rare_kernel
def squared_distance(rows, x, y, only_standing):
    """Return the least squared distance [m^2] of (x, y) from the bounding boxes of slots.

    Args:
        rows: The HAV's memory.
        x: X of the point [m].
        y: Y of the point [m].
        only_standing: Whether only HAVs that stand count.
    """
    least = math.inf
    for number in range(int(rows[m.NUM_SLOTS])):
        slot = slot_at(number)
        if only_standing and rows[slot + m.SLOT_KIND] != states.STANDING:
            continue
        outline = slot + m.SLOT_OUTLINE
        dx = max(x - rows[outline], -rows[outline + SIDES // 2] - x, 0.0)
        dy = max(y - rows[outline + SIDES // 4], -rows[outline + 3 * SIDES // 4] - y, 0.0)
        least = min(least, dx * dx + dy * dy)
    return least


@rare_kernel
def extent_of(rows, outline):
    """Return the distance [m] of an outline's farthest corner from the origin of its frame."""
    farthest = 0.0
    for side in range(SIDES):
        x, y = corner(rows, outline, side)
        farthest = max(farthest, x * x + y * y)
    return math.sqrt(farthest)


@kernel
def is_covered(rows, outline, margin):
    """Return whether all HAVs that may be within a margin [m] of an outline have slots."""
    return extent_of(rows, outline) + margin <= rows[m.COVERED_RADIUS]


@rare_kernel
def keeps_margin(rows, outline, kind, margin):
    """Return whether an outline keeps a margin [m] from all slots of a kind.

    Standing HAVs that are closer than the margin are marked in ``SLOT_CLOSE``.
    """
    free = True
    for number in range(int(rows[m.NUM_SLOTS])):
        slot = slot_at(number)
        if rows[slot + m.SLOT_KIND] != kind:
            continue
        near = gap_to(rows, slot, outline, margin) <= margin
        if kind == states.STANDING:
            rows[slot + m.SLOT_CLOSE] = 1.0 if near else 0.0
        if near:
            free = False
            if kind == states.RESERVED:
                return False
    return free


@kernel
def is_near(rows, world, agent, k, lane):
    """Return whether a neighbour is near, so the HAV notices its arrival or departure.

    The HAV compares its outline with those of farther neighbours only when it reserves.
    """
    x, y = neighbor_position(world, agent, k, lane)
    reach = max(
        neighbor_footprint(world, agent, k, lane), neighbor_length(world, agent, k, 0, lane)
    )
    farthest = rows[m.OWN_REACH] + reach + NEAR_GAP + 2.0 * rows[m.OWN_STEP]
    return x * x + y * y <= farthest * farthest


@kernel
def _hash_of(policy, memory, world, agent, k, lane):
    """Return the hash of a neighbour's number and state.

    The sum over all neighbours differs, but for coincidence, when one begins to stand or to move.
    """
    number = neighbor_id(world, agent, k, lane) + 1.0
    mode = heard(memory, world, agent, k, m.MODE, lane) if policy.broadcast else 0.0
    return number * (number + _HASH_SHIFT) * mode


@rare_kernel
def remember_neighborhood(policy, rows, memory, world, agent, lane):
    """Remember which neighbours are near, and a hash of their states."""
    count, total = 0, 0.0
    for k in range(num_neighbors(world, agent, lane)):
        if is_near(rows, world, agent, k, lane):
            if count < sizes.MAX_KNOWN:
                rows[m.NEAR_NUMBERS + count] = neighbor_id(world, agent, k, lane)
            count += 1
            total += _hash_of(policy, memory, world, agent, k, lane)
    rows[m.NUM_NEAR], rows[m.KNOWN] = count, total


@rare_kernel
def was_near(rows, number):
    """Return whether the HAV of this number was near when the neighbourhood was remembered."""
    for k in range(min(int(rows[m.NUM_NEAR]), sizes.MAX_KNOWN)):
        if rows[m.NEAR_NUMBERS + k] == number:
            return True
    return False


@kernel
def is_newcomer(rows, world, agent, k, lane):
    """Return whether a neighbour is near and was not when the neighbourhood was remembered."""
    known = was_near(rows, neighbor_id(world, agent, k, lane))
    return not known and is_near(rows, world, agent, k, lane)


@rare_kernel
def reserved_gap(rows, slot):
    """Return a lower bound of the distance [m] from the reserved outline to that in a slot.

    The computation is that of the later of the two reservations, so the result is equal.
    """
    x, y, cosine, sine = (
        rows[m.FRAME_AFTER],
        rows[m.FRAME_AFTER + 1],
        rows[m.FRAME_AFTER + 2],
        rows[m.FRAME_AFTER + 3],
    )
    if rows[slot + m.SLOT_KIND] == states.STANDING:
        turn_outline(rows, m.TURNED_OUTLINE, rows, m.OUTLINE, x, y, cosine, sine)
        return outline_gap(rows, m.TURNED_OUTLINE, slot + m.SLOT_OUTLINE)
    dx, dy = rows[slot + m.SLOT_FRAME] - x, rows[slot + m.SLOT_FRAME + 1] - y
    forward, left = into_frame(dx, dy, cosine, sine)
    c, s = into_frame(rows[slot + m.SLOT_FRAME + 2], rows[slot + m.SLOT_FRAME + 3], cosine, sine)
    turn_outline(rows, m.TURNED_OUTLINE, rows, slot + m.SLOT_BROADCAST_OUTLINE, forward, left, c, s)
    gap = outline_gap(rows, m.OUTLINE, m.TURNED_OUTLINE)
    turn_outline(
        rows,
        m.TURNED_OUTLINE,
        rows,
        m.OUTLINE,
        -forward * c - left * s,
        forward * s - left * c,
        c,
        -s,
    )
    return max(gap, outline_gap(rows, m.TURNED_OUTLINE, slot + m.SLOT_BROADCAST_OUTLINE))


@kernel
def has_neighborhood_changed(policy, rows, memory, world, agent, lane):
    """Return whether the near neighbours or their states differ from those remembered."""
    count, total = 0, 0.0
    for k in range(num_neighbors(world, agent, lane)):
        if is_near(rows, world, agent, k, lane):
            number = neighbor_id(world, agent, k, lane)
            if count >= sizes.MAX_KNOWN or number != rows[m.NEAR_NUMBERS + count]:
                return True
            count += 1
            total += _hash_of(policy, memory, world, agent, k, lane)
    return count != rows[m.NUM_NEAR] or total != rows[m.KNOWN]
