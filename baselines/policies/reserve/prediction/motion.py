"""This module predicts the HAV's own steps, which are those of ``hav_env.vehicles.OnAxle``.

A HAV's memory holds its chain as cosine and sine of every unit's heading. They are in the frame
that the truck has when the prediction begins.
"""

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.prediction.paths import heading_at
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import atan2, sincos, small_sincos
from hav_env.maths.geometry import clip, into_frame, wrap

_FOLDED = -2.0  # stands for a cosine below that of every allowed articulation
# distance over length up to which a unit turns by less than pi / 4 in a step. A turn is at most
# that ratio, except for rounding, and the 5 % to pi / 4 exceed rounding by far
_SMALL_TURN = 0.75


@rare_kernel
def sense_chain(rows):
    """Write the own chain as it is now, in the truck's frame."""
    cosine, sine = 1.0, 0.0
    rows[m.PREDICTED_CHAIN], rows[m.PREDICTED_CHAIN + 1] = cosine, sine
    for joint in range(1, int(rows[m.OWN_TRAILERS]) + 1):
        c, s = rows[m.OWN_JOINTS + 2 * joint - 2], rows[m.OWN_JOINTS + 2 * joint - 1]
        cosine, sine = cosine * c - sine * s, sine * c + cosine * s
        rows[m.PREDICTED_CHAIN + 2 * joint], rows[m.PREDICTED_CHAIN + 2 * joint + 1] = cosine, sine


@kernel
def advance_chain(rows, x, y, turn, distance):
    """Move the predicted chain by one step: ``advance_into`` of ``PREDICTED_CHAIN`` itself."""
    return advance_into(rows, rows, m.PREDICTED_CHAIN, m.PREDICTED_CHAIN, x, y, turn, distance)


@rare_kernel
def advance_into(rows, chains, before, after, x, y, turn, distance):
    """Move a chain by one step of the simulation, with ``OnAxle()``'s Euler method.

    Args:
        rows: The HAV's memory.
        chains: Array that holds the chain: cosine and sine of each unit's heading.
        before: Index of its first row before the step.
        after: Index of its first row after the step, which may be the same.
        x: X of the truck's rear axle before the step [m].
        y: Y of the truck's rear axle before the step [m].
        turn: Turn of the truck in the step [rad].
        distance: Distance that its rear axle moves after that turn [m].

    Returns:
        x and y after the step [m], and the least cosine of all articulations. That is ``_FOLDED``
        if a joint may have folded through, which the cosine alone does not show.
    """
    sine, cosine = sincos(turn)
    before_cosine, before_sine = chains[before], chains[before + 1]
    ahead_cosine = before_cosine * cosine - before_sine * sine
    ahead_sine = before_sine * cosine + before_cosine * sine
    chains[after], chains[after + 1] = ahead_cosine, ahead_sine
    x, y = x + distance * ahead_cosine, y + distance * ahead_sine
    pull, least = distance, 1.0
    for unit in range(1, int(rows[m.OWN_TRAILERS]) + 1):
        at, then = before + 2 * unit, after + 2 * unit
        ahead_cosine, ahead_sine, pull, turn, least = pull_unit(
            *(ahead_cosine, ahead_sine, chains[at], chains[at + 1], pull, turn, least),
            *(rows[m.OWN_LENGTHS + unit], rows[m.OWN_FOLD_TURN]),
            turns_little(rows, unit, distance),
        )
        chains[then], chains[then + 1] = ahead_cosine, ahead_sine
    return x, y, least


@kernel
def turns_little(rows, unit, distance):
    """Return whether a trailer turns by less than pi / 4 whenever the truck moves a distance [m].

    Turns are pull * sine / length, and no unit is pulled farther than the truck moves.
    """
    return distance <= _SMALL_TURN * rows[m.OWN_LENGTHS + unit]


@kernel
def pull_unit(ahead_cosine, ahead_sine, cosine, sine, pull, turn, least, length, fold_turn, little):
    """Turn and move a unit after the one ahead, which has moved already.

    Args:
        ahead_cosine: Cosine of the heading of the unit ahead.
        ahead_sine: Sine of that heading.
        cosine: Cosine of the own heading before the step.
        sine: Sine of that heading.
        pull: Distance that the unit ahead moves [m].
        turn: Turn and move a unit behind the unit ahead, which has already moved.
        least: Least cosine of the articulations before this one.
        length: Length of the unit [m].
        fold_turn: Least change of an articulation that may fold a joint through [rad].
        little: Whether the unit ``turns_little``. The result is equal, and faster to compute.

    Returns:
        Cosine and sine of the heading after the step, the distance that the unit moves [m], its
        turn [rad], and the least cosine of the articulations up to this one, or ``_FOLDED``.
    """
    _, bend = into_frame(cosine, sine, ahead_cosine, ahead_sine)
    own_turn = -pull * bend / length
    turn_sine, turn_cosine = small_sincos(own_turn) if little else sincos(own_turn)
    own_cosine = cosine * turn_cosine - sine * turn_sine
    own_sine = sine * turn_cosine + cosine * turn_sine
    straightness, _ = into_frame(own_cosine, own_sine, ahead_cosine, ahead_sine)
    folded = abs(own_turn - turn) >= fold_turn
    least = min(least, _FOLDED if folded else straightness)
    return own_cosine, own_sine, pull * straightness, own_turn, least


@kernel
def most_turn(rows, distance):
    """Return the largest turn [rad] that the steering allows in a step."""
    return distance * rows[m.OWN_STEERING_TANGENT] / rows[m.OWN_LENGTHS]


@kernel
def turn_to(rows, wanted, heading, distance):
    """Return the turn [rad] towards a wanted heading that the steering allows in one step."""
    most = most_turn(rows, distance)
    return clip(wanted - heading, -most, most)


@kernel
def follow(rows):
    """Return the turn [rad] and the distance [m] of the next step along the path.

    The truck turns first and then moves along its new heading. The right heading is therefore that
    of the path half a step ahead. The truck's own heading follows from the sensed heading of its
    goal.
    """
    distance = rows[m.OWN_STEP]
    wanted = heading_at(rows, m.CURRENT_PATH, rows[m.DRIVEN] + 0.5 * distance)
    return turn_to(rows, wrap(wanted - path_heading(rows)), 0.0, distance), distance


@kernel
def path_heading(rows):
    """Return the truck's heading less that of the path's start [rad], up to whole turns."""
    return rows[m.PLANNED_GOAL_HEADING] - rows[m.OWN_GOAL + 2]


@kernel
def command(policy, rows, turn, distance):
    """Return speed [m/s] and steering [rad] of a step."""
    steering = atan2(turn * rows[m.OWN_LENGTHS], distance) if distance > 0.0 else 0.0
    return distance / policy.dt, steering
