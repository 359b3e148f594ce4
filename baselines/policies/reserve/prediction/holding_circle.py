"""Circles to drive on for ever: where there is room for one, and how a HAV enters it."""

import math

from baselines.policies.reserve.memory.rows import (
    AFTER,
    AXLES,
    BODY,
    CHAIN,
    CLOSE,
    END,
    GATHERED,
    KEPT_AXLES,
    KEPT_CHAIN,
    KIND,
    MOST_UNITS,
    NUM_SLOTS,
    OUTLINE,
    OWN_BOUND,
    OWN_CIRCLE,
    OWN_FRONT,
    OWN_REAR,
    OWN_SAG,
    OWN_STEP,
    OWN_TRAILERS,
    PREFERRED,
    RESERVED,
    SEGMENTS,
    SHIFT,
    SIDE,
    STANDING,
    TRIAL,
    TRY,
)
from baselines.policies.reserve.perception.other_agents import apart, is_overseen, slot_at
from baselines.policies.reserve.prediction.chain import (
    keeps_clear,
    keeps_clear_of,
    move_axles,
    nose_swept,
    place_axles,
    pull_axles,
)
from baselines.policies.reserve.prediction.motion import (
    advance_chain,
    sense_chain,
    turn_to,
)
from baselines.policies.reserve.prediction.paths import append, heading_at
from hav_env.compiled import rare_kernel
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import TWO_PI, into_frame, wrap
from hav_env.maths.kdop import SIDES, include_disc, outside, turn_outline, widen

_LEAK = 0.05  # [m] by which outlines are wider than the convex hull: axles leave it by less
_COARSE = 0.15  # [m] by which coarse steps may be wrong
_TOUCH = 0.01  # [m] margin that is kept from those that stand while circling
_ENDLESS = 1e9  # [m]


@rare_kernel
def find_circle(policy, rows, x, y, heading, shifts, margin, exact):
    """Look for a circle that the HAV can drive on for ever; the axles stay.

    The side that it went to last comes first.

    Args:
        shifts: how many distances straight on before the circle are tried, 0, then one more
            radius each.
        others: as in ``circle_is_free``.

    Returns:
        The side of the circle, 0.0 where there is none, and the shift [m].
    """
    for row in range(2 * MOST_UNITS + 2):
        rows[KEPT_AXLES + row] = rows[AXLES + row]
    for choice in range(2 * shifts):
        side = rows[PREFERRED] if choice % 2 == 0 else -rows[PREFERRED]
        shift = (choice // 2) * rows[OWN_FRONT]
        free = circle_is_free(policy, rows, x, y, heading, side, shift, margin, exact)
        for row in range(2 * MOST_UNITS + 2):
            rows[AXLES + row] = rows[KEPT_AXLES + row]
        if free:
            return side, shift
    return 0.0, 0.0


@rare_kernel
def circle_is_free(policy, rows, x, y, heading, side, shift, margin, exact):
    """Tell whether a HAV can drive straight on and then round a circle for ever.

    Args:
        rows: ``BODY`` is the outline of what comes before, the axles are where that ends; ``TRY``
            becomes the outline of all.
        x, y, heading: of the truck then [m, rad]; side: of the circle; shift: straight on [m].
        margin: to be kept [m].
        exact: whether ``CHAIN`` is the chain then, so that in doubt the circle can be predicted,
            and the outline may be reserved.
    """
    rear, front = rows[OWN_REAR], rows[OWN_FRONT]
    sine, cosine = sincos(heading)
    centre_x = x + shift * cosine - side * rear * sine
    centre_y = y + shift * sine + side * rear * cosine
    for number in range(SIDES):
        rows[TRY + number] = rows[BODY + number]
    include_disc(rows, TRY, centre_x, centre_y, front + rows[OWN_SAG])
    widen(rows, TRY, _LEAK)
    if exact and not is_overseen(rows, TRY, margin):
        return False
    if not apart(rows, TRY, RESERVED, margin):
        return False
    if apart(rows, TRY, STANDING, margin):
        return True
    if not exact:
        return _drive_coarsely(rows, x, y, heading, side, shift, margin)
    wide = max(margin, _COARSE) + rows[OWN_SAG]
    return _drive_coarsely(rows, x, y, heading, side, shift, wide) or _drive_exactly(
        policy, rows, x, y, heading, side, shift, margin
    )


@rare_kernel
def _drive_coarsely(rows, x, y, heading, side, shift, margin):
    """Drive straight on and three times round the circle, in coarse steps, past who stands."""
    radius = rows[OWN_CIRCLE]
    step = min(1.5, 0.25 * radius)
    straight = math.ceil(shift / step)
    rounds = math.ceil(3.0 * TWO_PI * radius / step)
    turn = side * step / radius
    half, _ = sincos(0.5 * step / radius)
    chord = 2.0 * radius * half
    for number in range(straight + rounds):
        nose_x, nose_y = rows[AXLES], rows[AXLES + 1]
        ahead = heading
        length = shift / max(straight, 1)
        if number >= straight:
            ahead, heading, length = heading + 0.5 * turn, heading + turn, chord
        sine, cosine = sincos(ahead)
        x, y = x + length * cosine, y + length * sine
        sine, cosine = sincos(heading)
        pull_axles(rows, x, y, cosine, sine)
        if not _clear_on_the_way(rows, nose_x, nose_y, margin):
            return False
    return True


@rare_kernel
def _clear_on_the_way(rows, nose_x, nose_y, margin):
    """Tell whether the axles, and the nose on its way from where it was, keep clear."""
    for number in range(int(rows[NUM_SLOTS])):
        slot = slot_at(number)
        if (
            rows[slot + KIND] == STANDING
            and rows[slot + CLOSE] > 0.0
            and not (
                nose_swept(rows, slot, nose_x, nose_y, margin)
                and keeps_clear_of(rows, slot, margin)
            )
        ):
            return False
    return True


@rare_kernel
def _drive_exactly(policy, rows, x, y, heading, side, shift, margin):
    """Drive straight on and twice round the circle, as the simulation will; the chain stays."""
    for row in range(2 * MOST_UNITS):
        rows[KEPT_CHAIN + row] = rows[CHAIN + row]
    for row in range(2 * MOST_UNITS + 2):  # the coarse steps have moved them
        rows[AXLES + row] = rows[KEPT_AXLES + row]
    radius = rows[OWN_CIRCLE]
    distance = rows[OWN_STEP]
    driven, turned, free = 0.0, 0.0, True
    while free and driven < shift + 2.0 * TWO_PI * radius:
        wanted = side * max(driven + 0.5 * distance - shift, 0.0) / radius
        turn = turn_to(rows, wanted, turned, distance)
        x, y, _ = advance_chain(rows, x, y, turn, distance)
        turned, driven = turned + turn, driven + distance
        move_axles(rows, x, y)
        free = keeps_clear(rows, margin)
    for row in range(2 * MOST_UNITS):
        rows[CHAIN + row] = rows[KEPT_CHAIN + row]
    return free


@rare_kernel
def enter_circle(rows):
    """Go round the circle behind the end of what is reserved; return whether that is possible.

    The path is left in ``TRIAL``.
    """
    if rows[GATHERED] == 0.0:
        return False
    rows[TRIAL + SEGMENTS] = 0.0
    append(rows, TRIAL, 0.0, rows[SHIFT])
    append(rows, TRIAL, rows[SIDE] / rows[OWN_CIRCLE], _ENDLESS)
    return go_round(rows, TRIAL, 0.0, 0.0, rows[SHIFT])


@rare_kernel
def go_round(rows, path, driven, heading, shift):
    """Go on along a path that ends in a circle; return whether that is possible.

    The next two turns are predicted, and must stay within what is reserved, so nobody else need be
    asked. The HAV goes as far as that, and may then ask again: trailers may go on closing in on the
    circle's centre for many rounds.

    Args:
        path: where it stands; driven: how much of it is done [m].
        heading: of the truck less that of the path's start [rad], by whole turns.
        shift: how far it is from here to the circle [m].
    """
    x, y, cosine, sine = rows[AFTER], rows[AFTER + 1], rows[AFTER + 2], rows[AFTER + 3]
    distance = rows[OWN_STEP]
    turn_outline(rows, TRY, rows, OUTLINE, x, y, cosine, sine)
    if not is_overseen(rows, TRY, _LEAK):
        return False
    apart(rows, TRY, STANDING, _LEAK)  # marks who is close
    sense_chain(rows)
    place_axles(rows, 0.0, 0.0)
    px, py = 0.0, 0.0
    end = driven + shift + 2.0 * TWO_PI * rows[OWN_CIRCLE]
    while driven < end:
        wanted = heading_at(rows, path, driven + 0.5 * distance)
        turn = turn_to(rows, wrap(wanted - heading), 0.0, distance)
        px, py, least = advance_chain(rows, px, py, turn, distance)
        heading, driven = heading + turn, driven + distance
        move_axles(rows, px, py)
        if least < rows[OWN_BOUND] or not keeps_clear(rows, _TOUCH):
            return False
        for axle in range(int(rows[OWN_TRAILERS]) + 2):
            at = AXLES + 2 * axle
            forward, left = into_frame(rows[at] - x, rows[at + 1] - y, cosine, sine)
            if outside(rows, OUTLINE, forward, left) > -rows[OWN_SAG]:
                return False
    rows[END] = driven
    return True
