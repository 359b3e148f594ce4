"""This module predicts the axles of the chain: positions, pull and contacts."""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes, states
from baselines.policies.reserve.perception.other_agents import slot_at
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.geometry import hull_apart, segments_apart
from hav_env.maths.kdop import SIDES, include_point

# The sides of an outline that are those of its bounding box.
_RIGHT_SIDE, _TOP_SIDE, _LEFT_SIDE, _BOTTOM_SIDE = 0, SIDES // 4, SIDES // 2, 3 * SIDES // 4
COARSE_TURN = 0.25  # [rad] of the truck in a coarse step, at most: a chord is then close to its arc


@rare_kernel
def place_axles(rows, x, y):
    """Write the axles of the predicted chain, whose truck's rear axle is at (x, y) [m]."""
    length = rows[m.OWN_LENGTHS]
    rows[m.AXLES], rows[m.AXLES + 1] = (
        x + length * rows[m.PREDICTED_CHAIN],
        y + length * rows[m.PREDICTED_CHAIN + 1],
    )
    rows[m.AXLES + 2], rows[m.AXLES + 3] = x, y
    for unit in range(1, int(rows[m.OWN_TRAILERS]) + 1):
        length = rows[m.OWN_LENGTHS + unit]
        x -= length * rows[m.PREDICTED_CHAIN + 2 * unit]
        y -= length * rows[m.PREDICTED_CHAIN + 2 * unit + 1]
        rows[m.AXLES + 2 * unit + 2], rows[m.AXLES + 2 * unit + 3] = x, y


@rare_kernel
def move_axles(rows, x, y):
    """Write the axles after a step, and keep those before it in ``PREVIOUS_AXLES``."""
    for row in range(2 * (int(rows[m.OWN_TRAILERS]) + 2)):
        rows[m.PREVIOUS_AXLES + row] = rows[m.AXLES + row]
    place_axles(rows, x, y)


@rare_kernel
def pull_axles(rows, x, y, cosine, sine):
    """Move the truck to a pose in a coarse step, and pull the axles after it like ropes."""
    rows[m.AXLES], rows[m.AXLES + 1] = nose_of(rows, x, y, cosine, sine)
    rows[m.AXLES + 2], rows[m.AXLES + 3] = x, y
    for unit in range(1, int(rows[m.OWN_TRAILERS]) + 1):
        at = m.AXLES + 2 * unit + 2
        dx, dy = x - rows[at], y - rows[at + 1]
        share = rows[m.OWN_LENGTHS + unit] / math.sqrt(dx * dx + dy * dy)
        x, y = x - share * dx, y - share * dy
        rows[at], rows[at + 1] = x, y


@kernel
def nose_of(rows, x, y, cosine, sine):
    """Return the truck's front axle [m] for a pose of its rear axle: x, y [m], cosine, sine."""
    length = rows[m.OWN_LENGTHS]
    return x + length * cosine, y + length * sine


@rare_kernel
def include_axles(rows, outline):
    """Include all axles in an outline."""
    for axle in range(int(rows[m.OWN_TRAILERS]) + 2):
        include_point(rows, outline, rows[m.AXLES + 2 * axle], rows[m.AXLES + 2 * axle + 1])


@rare_kernel
def keeps_clear_of(rows, slot, margin):
    """Return whether the chain is more than a margin [m] from a slot's HAV that stands."""
    for axle in range(int(rows[m.OWN_TRAILERS]) + 1):
        at = m.AXLES + 2 * axle
        if not link_keeps_clear(
            rows, slot, rows[at], rows[at + 1], rows[at + 2], rows[at + 3], margin
        ):
            return False
    return True


@rare_kernel
def link_keeps_clear(rows, slot, ax, ay, bx, by, margin):
    """Return whether the segment a-b is more than a margin [m] from a slot's HAV that stands."""
    margin += rows[slot + m.SLOT_ERROR]
    left, bottom, right, top = min(ax, bx), min(ay, by), max(ax, bx), max(ay, by)
    if _box_keeps_clear(rows, slot, left, bottom, right, top, margin):
        return True
    for other in range(int(rows[slot + m.SLOT_NUM_AXLES]) - 1):
        at = slot + m.SLOT_AXLES + 2 * other
        if not segments_apart(
            *(ax, ay, bx, by),
            *(rows[at], rows[at + 1], rows[at + 2], rows[at + 3]),
            margin,
        ):
            return False
    return True


@rare_kernel
def keeps_clear(rows, margin):
    """Return whether the chain keeps clear of all close standing HAVs in the last step.

    At the end of the step it must keep a margin [m] from them. During the step it must not touch
    them, however its axles move between their positions (docs/safety.md, "Between steps").
    """
    for number in range(int(rows[m.NUM_SLOTS])):
        slot = slot_at(number)
        if _is_close(rows, slot) and not (
            keeps_clear_of(rows, slot, margin + rows[m.OWN_SAG]) and _step_keeps_clear(rows, slot)
        ):
            return False
    return True


@rare_kernel
def truck_keeps_clear(rows, before_x, before_y, nose_x, nose_y, x, y, margin):
    """Return whether a truck keeps a margin [m] from all close standing HAVs in a coarse step.

    Args:
        rows: The HAV's memory.
        before_x: X of the nose before the step [m].
        before_y: Y of the nose before the step [m].
        nose_x: X of the nose after the step [m].
        nose_y: Y of the nose after the step [m].
        x: X of the rear axle after the step [m].
        y: Y of the rear axle after the step [m].
        margin: Margin [m].
    """
    right, left = max(before_x, nose_x, x), min(before_x, nose_x, x)
    top, bottom = max(before_y, nose_y, y), min(before_y, nose_y, y)
    for number in range(int(rows[m.NUM_SLOTS])):
        slot = slot_at(number)
        # outside the box of all links, each link is outside its own
        if not _is_close(rows, slot) or _box_keeps_clear(
            rows, slot, left, bottom, right, top, margin + rows[slot + m.SLOT_ERROR]
        ):
            continue
        if not (
            link_keeps_clear(rows, slot, before_x, before_y, nose_x, nose_y, margin)
            and link_keeps_clear(rows, slot, nose_x, nose_y, x, y, margin)
        ):
            return False
    return True


@rare_kernel
def trailers_keep_clear(rows, margin):
    """Return whether all trailers keep a margin [m] from all close standing HAVs."""
    trailers = int(rows[m.OWN_TRAILERS])
    right = left = rows[m.AXLES + 2]
    top = bottom = rows[m.AXLES + 3]
    for axle in range(2, trailers + 2):
        at = m.AXLES + 2 * axle
        right, left = max(right, rows[at]), min(left, rows[at])
        top, bottom = max(top, rows[at + 1]), min(bottom, rows[at + 1])
    for number in range(int(rows[m.NUM_SLOTS])):
        slot = slot_at(number)
        if not _is_close(rows, slot) or _box_keeps_clear(
            rows, slot, left, bottom, right, top, margin + rows[slot + m.SLOT_ERROR]
        ):
            continue
        for axle in range(1, trailers + 1):
            at = m.AXLES + 2 * axle
            if not link_keeps_clear(
                rows, slot, rows[at], rows[at + 1], rows[at + 2], rows[at + 3], margin
            ):
                return False
    return True


@kernel
def _is_close(rows, slot):
    """Return whether a slot's HAV stands, and was marked as close."""
    return (rows[slot + m.SLOT_KIND] == states.STANDING) & (rows[slot + m.SLOT_CLOSE] > 0.0)


@kernel
def _box_keeps_clear(rows, slot, left, bottom, right, top, margin):
    """Return whether a box [m] is more than a margin [m] from the box of a slot's outline."""
    outline = slot + m.SLOT_OUTLINE
    return (
        (left > rows[outline + _RIGHT_SIDE] + margin)
        | (bottom > rows[outline + _TOP_SIDE] + margin)
        | (-right > rows[outline + _LEFT_SIDE] + margin)
        | (-top > rows[outline + _BOTTOM_SIDE] + margin)
    )


@rare_kernel
def _step_keeps_clear(rows, slot):
    """Return whether no link of the chain can touch a HAV that stands during the step."""
    for axle in range(int(rows[m.OWN_TRAILERS]) + 1):
        at = 2 * axle
        moved = (
            max(_axle_moved(rows, at), _axle_moved(rows, at + 2))
            + rows[m.OWN_STEP]
            + rows[m.OWN_SAG]
        )
        ends = (
            rows[m.AXLES + at],
            rows[m.AXLES + at + 1],
            rows[m.AXLES + at + 2],
            rows[m.AXLES + at + 3],
        )
        if not link_keeps_clear(rows, slot, *ends, moved):
            _write_swept(rows, axle)
            if not _swept_keeps_clear(rows, slot, rows[m.OWN_SAG] + rows[slot + m.SLOT_ERROR]):
                return False
    return True


@kernel
def _axle_moved(rows, at):
    """Return the distance [m] of an axle from its place a step before."""
    dx, dy = (
        rows[m.AXLES + at] - rows[m.PREVIOUS_AXLES + at],
        rows[m.AXLES + at + 1] - rows[m.PREVIOUS_AXLES + at + 1],
    )
    return math.sqrt(dx * dx + dy * dy)


@rare_kernel
def _write_swept(rows, axle):
    """Write corners of a convex set that holds the link behind an axle during the whole step.

    They are both ends of the link before the step and after it. The fifth is the farthest place
    that the axle reaches along the link ahead, which pulls it. Nothing pulls the front axle.
    """
    for end in range(2):
        at = 2 * (axle + end)
        rows[m.SWEPT_CORNERS + 4 * end], rows[m.SWEPT_CORNERS + 4 * end + 1] = (
            rows[m.PREVIOUS_AXLES + at],
            rows[m.PREVIOUS_AXLES + at + 1],
        )
        rows[m.SWEPT_CORNERS + 4 * end + 2], rows[m.SWEPT_CORNERS + 4 * end + 3] = (
            rows[m.AXLES + at],
            rows[m.AXLES + at + 1],
        )
    at, share = m.PREVIOUS_AXLES + 2 * axle, 0.0
    if axle > 0:
        share = rows[m.OWN_STEP] / rows[m.OWN_LENGTHS + axle - 1]
    ahead = at - 2 if axle > 0 else at
    rows[m.SWEPT_CORNERS + 8] = rows[at] + share * (rows[ahead] - rows[at])
    rows[m.SWEPT_CORNERS + 9] = rows[at + 1] + share * (rows[ahead + 1] - rows[at + 1])


@rare_kernel
def _swept_keeps_clear(rows, slot, margin):
    """Return whether the hull of ``SWEPT_CORNERS`` keeps a margin [m] from a HAV that stands."""
    for link in range(int(rows[slot + m.SLOT_NUM_AXLES]) - 1):
        at = slot + m.SLOT_AXLES + 2 * link
        if not hull_apart(
            rows,
            m.SWEPT_CORNERS,
            sizes.LINK_CORNERS,
            rows[at],
            rows[at + 1],
            rows[at + 2],
            rows[at + 3],
            margin,
        ):
            return False
    return True


@kernel
def nose_keeps_clear(rows, slot, before_x, before_y, margin):
    """Return whether the nose keeps clear of a standing HAV on its way from a position [m]."""
    return link_keeps_clear(
        rows, slot, before_x, before_y, rows[m.AXLES], rows[m.AXLES + 1], margin
    )
