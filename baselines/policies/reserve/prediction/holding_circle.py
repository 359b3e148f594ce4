"""This module finds holding circles, on which a HAV can drive without end.

It looks for space for a circle, and predicts how the HAV enters it.
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes, states
from baselines.policies.reserve.perception.other_agents import is_covered, keeps_margin
from baselines.policies.reserve.prediction.chain import (
    COARSE_TURN,
    keeps_clear,
    move_axles,
    nose_of,
    place_axles,
    pull_axles,
    trailers_keep_clear,
    truck_keeps_clear,
)
from baselines.policies.reserve.prediction.joints import circle_keeps_joints
from baselines.policies.reserve.prediction.motion import (
    advance_chain,
    sense_chain,
    turn_to,
)
from baselines.policies.reserve.prediction.paths import append, heading_at
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import TWO_PI, into_frame, wrap
from hav_env.maths.kdop import SIDES, include_disc, outside, turn_outline, widen

SHIFTS = 2  # straight distances before a circle to try while driving: each one costs time
_HULL_MARGIN = 0.05  # [m] by which an outline is wider than the convex hull: steps leave it by less
_COARSE_ERROR = 0.15  # [m] of the places of axles after coarse steps
_CIRCLE_COARSE_STEP = 1.5  # [m] of a coarse step round a circle, at most
_COARSE_TURNS = 3.0  # until trailers have closed in on their circles
_EXACT_TURNS = 2.0  # that are predicted step by step at a time
_CIRCLING_MARGIN = 0.01  # [m] to standing HAVs, for more turns on a reserved circle
_ENDLESS = 1e9  # [m] length of an arc that no episode reaches the end of


@rare_kernel
def find_circle(policy, rows, x, y, heading, shifts, margin, exact):
    """Look for a circle that the HAV can drive on without end. The axles do not change.

    The side of the last circle comes first.

    Args:
        policy: The Reserve.
        rows: The HAV's memory, with outlines and axles as in ``circle_is_free``.
        x: X of the truck where the reserved part ends [m].
        y: Y of the truck there [m].
        heading: Heading of the truck there [rad].
        shifts: Number of straight distances before the circle to try. The first one is 0, and each
            further one is longer by a radius of the nose's circle.
        margin: Margin to all others [m].
        exact: As in ``circle_is_free``.

    Returns:
        The side of the circle, 0.0 if there is none, and the straight distance before it [m].
    """
    for row in range(2 * sizes.MAX_UNITS + 2):
        rows[m.SAVED_AXLES + row] = rows[m.AXLES + row]
    for choice in range(2 * shifts):
        side = rows[m.PREFERRED_SIDE] if choice % 2 == 0 else -rows[m.PREFERRED_SIDE]
        shift = (choice // 2) * rows[m.OWN_FRONT_RADIUS]
        free = circle_is_free(policy, rows, x, y, heading, side, shift, margin, exact)
        for row in range(2 * sizes.MAX_UNITS + 2):
            rows[m.AXLES + row] = rows[m.SAVED_AXLES + row]
        if free:
            return side, shift
    return 0.0, 0.0


@rare_kernel
def circle_is_free(policy, rows, x, y, heading, side, shift, margin, exact):
    """Return whether a HAV can drive straight on and then round a circle without end.

    Args:
        policy: The Reserve.
        rows: The HAV's memory. ``BODY_OUTLINE`` is the outline of what comes before the circle, and
            the axles are where that ends. ``TRIAL_OUTLINE`` becomes the outline of everything.
        x: X of the truck where the reserved part ends [m].
        y: Y of the truck there [m].
        heading: Heading of the truck there [rad].
        side: Side of the circle, 1.0 left, -1.0 right.
        shift: Straight distance before the circle [m].
        margin: Margin to all others [m].
        exact: Whether ``PREDICTED_CHAIN`` is the chain then. In doubt the circle is then predicted
            step by step, and the outline may be reserved.
    """
    rear, front = rows[m.OWN_REAR_RADIUS], rows[m.OWN_FRONT_RADIUS]
    sine, cosine = sincos(heading)
    centre_x = x + shift * cosine - side * rear * sine
    centre_y = y + shift * sine + side * rear * cosine
    for number in range(SIDES):
        rows[m.TRIAL_OUTLINE + number] = rows[m.BODY_OUTLINE + number]
    include_disc(rows, m.TRIAL_OUTLINE, centre_x, centre_y, front + rows[m.OWN_SAG])
    widen(rows, m.TRIAL_OUTLINE, _HULL_MARGIN)
    if exact and not is_covered(rows, m.TRIAL_OUTLINE, margin):
        return False
    if not keeps_margin(rows, m.TRIAL_OUTLINE, states.RESERVED, margin):
        return False
    if exact and not circle_keeps_joints(rows, side, shift):
        return False
    if keeps_margin(rows, m.TRIAL_OUTLINE, states.STANDING, margin):
        return True
    if not exact:
        return _passes_coarsely(rows, x, y, heading, side, shift, margin)
    wide = max(margin, _COARSE_ERROR) + rows[m.OWN_SAG]
    return _passes_coarsely(rows, x, y, heading, side, shift, wide) or _passes_exactly(
        policy, rows, x, y, heading, side, shift, margin
    )


@rare_kernel
def _passes_coarsely(rows, x, y, heading, side, shift, margin):
    """Return whether the HAV passes standing HAVs, in coarse steps on the circle.

    It drives straight on, and then ``_COARSE_TURNS`` times round the circle. The truck does so
    first: it fails most often, and does not depend on its trailers.
    """
    radius = rows[m.OWN_CIRCLE_RADIUS]
    step = min(_CIRCLE_COARSE_STEP, COARSE_TURN * radius)
    straight = math.ceil(shift / step)
    count = straight + math.ceil(_COARSE_TURNS * TWO_PI * radius / step)
    turn, before = side * step / radius, shift / max(straight, 1)
    half, _ = sincos(0.5 * step / radius)
    chord = 2.0 * radius * half
    ahead_x, ahead_y, ahead = x, y, heading
    nose_x, nose_y = rows[m.AXLES], rows[m.AXLES + 1]
    for number in range(count):
        length, bend = (before, 0.0) if number < straight else (chord, turn)
        ahead_x, ahead_y, ahead, cosine, sine = _drive_coarsely(
            ahead_x, ahead_y, ahead, length, bend
        )
        last_x, last_y = nose_x, nose_y
        nose_x, nose_y = nose_of(rows, ahead_x, ahead_y, cosine, sine)
        if not truck_keeps_clear(rows, last_x, last_y, nose_x, nose_y, ahead_x, ahead_y, margin):
            return False
    for number in range(count):
        length, bend = (before, 0.0) if number < straight else (chord, turn)
        x, y, heading, cosine, sine = _drive_coarsely(x, y, heading, length, bend)
        pull_axles(rows, x, y, cosine, sine)
        if not trailers_keep_clear(rows, margin):
            return False
    return True


@kernel
def _drive_coarsely(x, y, heading, length, turn):
    """Return a truck's pose after a coarse step: x, y [m], heading [rad], its cosine and sine.

    Args:
        x: X of the truck before the step [m].
        y: Y of the truck before the step [m].
        heading: Heading of the truck before the step [rad].
        length: Length of the step [m], straight ahead after half of the turn.
        turn: Turn of the truck in the step [rad].
    """
    sine, cosine = sincos(heading + 0.5 * turn)
    x, y = x + length * cosine, y + length * sine
    sine, cosine = sincos(heading + turn)
    return x, y, heading + turn, cosine, sine


@rare_kernel
def _passes_exactly(policy, rows, x, y, heading, side, shift, margin):
    """Return whether the HAV passes standing HAVs, step by step on the circle.

    It drives straight on, and then ``_EXACT_TURNS`` times round the circle. The chain does not
    change.
    """
    for row in range(2 * sizes.MAX_UNITS):
        rows[m.SAVED_CHAIN + row] = rows[m.PREDICTED_CHAIN + row]
    for row in range(2 * sizes.MAX_UNITS + 2):  # the coarse steps have moved them
        rows[m.AXLES + row] = rows[m.SAVED_AXLES + row]
    radius = rows[m.OWN_CIRCLE_RADIUS]
    distance = rows[m.OWN_STEP]
    driven, turned, free = 0.0, 0.0, True
    while free and driven < shift + _EXACT_TURNS * TWO_PI * radius:
        wanted = side * max(driven + 0.5 * distance - shift, 0.0) / radius
        turn = turn_to(rows, wanted, turned, distance)
        x, y, _ = advance_chain(rows, x, y, turn, distance)
        turned, driven = turned + turn, driven + distance
        move_axles(rows, x, y)
        free = keeps_clear(rows, margin)
    for row in range(2 * sizes.MAX_UNITS):
        rows[m.PREDICTED_CHAIN + row] = rows[m.SAVED_CHAIN + row]
    return free


@rare_kernel
def enter_circle(rows):
    """Write the path round the reserved circle into ``TRIAL_PATH``, and extend the reservation.

    Returns:
        Whether that is possible.
    """
    if rows[m.GATHERED] == 0.0:
        return False
    rows[m.TRIAL_PATH + m.NUM_SEGMENTS] = 0.0
    append(rows, m.TRIAL_PATH, 0.0, rows[m.CIRCLE_SHIFT])
    append(rows, m.TRIAL_PATH, rows[m.CIRCLE_SIDE] / rows[m.OWN_CIRCLE_RADIUS], _ENDLESS)
    return extend_circle(rows, m.TRIAL_PATH, 0.0, 0.0, rows[m.CIRCLE_SHIFT])


@rare_kernel
def extend_circle(rows, path, driven, heading, shift):
    """Extend the reserved part of a path that ends in a circle by the next ``_EXACT_TURNS`` turns.

    They are predicted, and must stay within the outline that is reserved already. The outlines of
    others therefore do not matter. At their end the HAV extends the part again, because trailers
    may close in on the circle's centre for many turns.

    Args:
        rows: The HAV's memory.
        path: First row of the path.
        driven: Distance driven along it [m].
        heading: Truck's heading less that of the path's start [rad], up to whole turns.
        shift: Distance from here to the circle [m].

    Returns:
        Whether that is possible.
    """
    x, y, cosine, sine = (
        rows[m.FRAME_AFTER],
        rows[m.FRAME_AFTER + 1],
        rows[m.FRAME_AFTER + 2],
        rows[m.FRAME_AFTER + 3],
    )
    distance = rows[m.OWN_STEP]
    turn_outline(rows, m.TRIAL_OUTLINE, rows, m.OUTLINE, x, y, cosine, sine)
    if not is_covered(rows, m.TRIAL_OUTLINE, _HULL_MARGIN):
        return False
    keeps_margin(rows, m.TRIAL_OUTLINE, states.STANDING, _HULL_MARGIN)  # marks the close ones
    sense_chain(rows)
    place_axles(rows, 0.0, 0.0)
    px, py = 0.0, 0.0
    end = driven + shift + _EXACT_TURNS * TWO_PI * rows[m.OWN_CIRCLE_RADIUS]
    while driven < end:
        wanted = heading_at(rows, path, driven + 0.5 * distance)
        turn = turn_to(rows, wrap(wanted - heading), 0.0, distance)
        px, py, least = advance_chain(rows, px, py, turn, distance)
        heading, driven = heading + turn, driven + distance
        move_axles(rows, px, py)
        if least < rows[m.OWN_LEAST_COSINE] or not keeps_clear(rows, _CIRCLING_MARGIN):
            return False
        for axle in range(int(rows[m.OWN_TRAILERS]) + 2):
            at = m.AXLES + 2 * axle
            forward, left = into_frame(rows[at] - x, rows[at + 1] - y, cosine, sine)
            if outside(rows, m.OUTLINE, forward, left) > -rows[m.OWN_SAG]:
                return False
    rows[m.PART_END] = driven
    return True
