"""This module bounds bends by the turns that units have left, and so spares most predictions.

While the truck drives straight on, the articulations down to a trailer sum up to at least the angle
by which that trailer still turns. So a joint may be held although its axle ahead follows too tight
a curve: that axle soon has no turn left. docs/safety-filter.md has the proof.
"""

import math

from hav_env.compiled import fma, generic, kernel, local_array, rare_kernel
from hav_env.maths.elementary import log, sincos
from hav_env.safety.trial_moves import IN_DOUBT, drives
from hav_env.safety.waves import is_proved
from hav_env.world.arrays import ARTICULATION, SPEED
from hav_env.world.units.parts import OnAxles

_MOST_DOUBTS = 64  # HAVs that are examined at a time
_WHOLE = 8  # lanes of a vector
# lane or -1; step, limit and trailers of the HAV; articulation of the joint, its trailer's length;
# of the unit ahead: turn left [rad], curvature, length, bend; whether all joints so far are held;
# way [m] in which the HAV straightens, and what the logarithm adds to each length
(
    _PLACE,
    _STRIDE,
    _LARGEST_BEND,
    _LARGEST_SINE,
    _LAST_UNIT,
    _BEND,
    _TRAILER,
    _TURN_LEFT,
    _CURVE_AHEAD,
    _LENGTH_AHEAD,
    _BEND_AHEAD,
    _ALL_HELD,
    _WAY,
    _DECAY,
    _EXAMINED_ROWS,
) = range(15)
_QUARTER_TURN = 0.5 * math.pi
# far more than the rounding of bounds and predictions [rad]; some predictions stay to be made
_CLEAR_ANGLE = 1e-3
# sum of articulations [rad] at which a HAV counts as straight; bounds accept limits from 1.0 on
_STRAIGHT, _LEAST_LIMIT = 0.9, 1.0
_STEEPEST = 1.5  # a turn left [rad] beyond which the curvature ahead is not bounded by it
_ALMOST_ZERO = 1e-12


@generic
def settle_by_turns(joints, safety, vehicle, dt, world, agent, rows):
    """Clear doubts about HAVs that straighten for certain; return their number.

    Args:
        joints: Kind of joints, which selects the kernel.
        safety: Safety filter.
        vehicle: Vehicle model (kinematics).
        dt: Duration of a step [s].
        world: Block of worlds, in which the HAV is at its position after the step in question.
        agent: Index of the HAV.
        rows: Scratch; row IN_DOUBT is changed.
    """


@settle_by_turns.otherwise
def _settle_nothing(joints, safety, vehicle, dt, world, agent, rows):
    return 0


@settle_by_turns.register(OnAxles)
def _settle_on_axles(joints, safety, vehicle, dt, world, agent, rows):
    if not is_proved(vehicle) or vehicle.simultaneous:
        return 0
    return _settle_doubts(safety, dt, world, agent, rows)


@rare_kernel
def _settle_doubts(safety, dt, world, agent, rows):
    """Examine the HAVs in doubt side by side."""
    examined, settled, begin = local_array(1, _EXAMINED_ROWS, _MOST_DOUBTS)[0], 0, 0
    while begin < world.lanes:
        count = longest = 0
        while begin < world.lanes and count < _MOST_DOUBTS:
            if (rows[IN_DOUBT, begin] != 0.0) & drives(world, agent, begin):
                _begin_to_examine(dt, world, agent, begin, examined, count)
                longest = max(longest, world.fleet.num_trailers[agent, begin])
                count += 1
            begin += 1
        size = (count + _WHOLE - 1) // _WHOLE * _WHOLE
        for slot in range(count, size):
            _begin_empty(examined, slot)
        for slot in range(size):
            _examine_first_joint(examined, slot)
        unit, held = 2, 1.0
        while unit <= longest and held > 0.0:
            for slot in range(count):
                lane = int(examined[_PLACE, slot])
                heading = world.state.heading
                bend = heading[agent, unit, lane] - heading[agent, unit - 1, lane]
                examined[_BEND, slot] = abs(bend)
                examined[_TRAILER, slot] = world.fleet.length[agent, unit, lane]
            for slot in range(size):
                _examine_joint(examined, float(unit), slot)
            held = 0.0
            for slot in range(count):
                held += examined[_ALL_HELD, slot]
            unit += 1
        for slot in range(count):
            way, step = examined[_WAY, slot], examined[_STRIDE, slot]
            if (examined[_ALL_HELD, slot] != 0.0) & (way <= step * safety.horizon):
                rows[IN_DOUBT, int(examined[_PLACE, slot])] = 0.0
                settled += 1
    return settled


@kernel
def _begin_to_examine(dt, world, agent, lane, examined, slot):
    _begin_empty(examined, slot)
    limit = world.fleet.limit
    usual, step = limit[agent, ARTICULATION, lane], dt * limit[agent, SPEED, lane]
    trailers = float(world.fleet.num_trailers[agent, lane])
    examined[_PLACE, slot], examined[_STRIDE, slot] = float(lane), step
    examined[_LARGEST_BEND, slot] = min(usual, _QUARTER_TURN) - _CLEAR_ANGLE
    examined[_LAST_UNIT, slot] = trailers
    heading = world.state.heading
    examined[_BEND, slot] = abs(heading[agent, 1, lane] - heading[agent, 0, lane])
    examined[_TRAILER, slot] = world.fleet.length[agent, 1, lane]
    examined[_WAY, slot] = (trailers + 1.0) * step
    examined[_ALL_HELD, slot] = 1.0 if usual >= _LEAST_LIMIT else 0.0


@kernel
def _begin_empty(examined, slot):
    """Begin with a truck, which turns no more."""
    for row in range(_EXAMINED_ROWS):
        examined[row, slot] = 0.0
    examined[_LAST_UNIT, slot] = examined[_TRAILER, slot] = 1.0


@kernel
def _examine_first_joint(examined, slot):
    """Bound the bend of the joint behind the truck, which turns no more: it only falls."""
    bend, length, step = examined[_BEND, slot], examined[_TRAILER, slot], examined[_STRIDE, slot]
    largest = examined[_LARGEST_BEND, slot]
    examined[_LARGEST_SINE, slot], _ = sincos(largest)
    examined[_DECAY, slot] = log(2.0 / _STRAIGHT * examined[_LAST_UNIT, slot])
    sine, cosine = sincos(min(bend, _QUARTER_TURN))
    decay = log(max(sine / (1.0 + cosine), _ALMOST_ZERO))
    held = (bend < largest) & (step <= length)
    examined[_ALL_HELD, slot] = examined[_ALL_HELD, slot] if held else 0.0
    examined[_WAY, slot] += length * max(examined[_DECAY, slot] + decay, 0.0)
    examined[_TURN_LEFT, slot], examined[_LENGTH_AHEAD, slot] = bend, length
    examined[_CURVE_AHEAD, slot] = sine / (max(cosine, _ALMOST_ZERO) * length)
    examined[_BEND_AHEAD, slot] = min(bend, _STEEPEST)


@kernel
def _examine_joint(examined, unit, slot):
    """Bound the bend of the joint ahead of a unit, and the curvature of the unit's path."""
    present, step = unit <= examined[_LAST_UNIT, slot], examined[_STRIDE, slot]
    bend = examined[_BEND, slot] if present else 0.0
    length = examined[_TRAILER, slot] if present else 1.0
    held, curvature, most, half_tangent = bound_bend(
        bend,
        length,
        step,
        examined[_TURN_LEFT, slot],
        examined[_CURVE_AHEAD, slot],
        examined[_LENGTH_AHEAD, slot],
        examined[_BEND_AHEAD, slot],
        examined[_LARGEST_BEND, slot],
        examined[_LARGEST_SINE, slot],
    )
    decay = log(max(half_tangent, _ALMOST_ZERO))
    examined[_ALL_HELD, slot] = examined[_ALL_HELD, slot] if held | (not present) else 0.0
    bent = _STRAIGHT * (unit - 1.0) / examined[_LAST_UNIT, slot]  # sum of the bends ahead by then
    way = length * max(examined[_DECAY, slot] + decay, 0.0) / (1.0 - 0.5 * bent * bent)
    examined[_WAY, slot] += way if present else 0.0
    examined[_TURN_LEFT, slot] += bend
    examined[_CURVE_AHEAD, slot] = curvature
    examined[_LENGTH_AHEAD, slot] = length
    examined[_BEND_AHEAD, slot] = most


@kernel
def bound_bend(bend, length, step, turn, curvature, length_ahead, bend_ahead, largest, greatest):
    """Bound the bends of a joint, and the curvature of the path of the axle behind it.

    Returns:
        Whether the joint is held; the bound on the curvature [1/m]; the turn left below which the
        turn itself bounds the curvature better [rad]; the tangent of half the largest bend.

    Args:
        bend: Size of the articulation [rad].
        length: Length of the trailer [m].
        step: Step of the truck [m].
        turn: Bound on the turn that the unit ahead has left [rad].
        curvature: Bound on the curvature of the path of the axle ahead [1/m].
        length_ahead: Length of the unit ahead [m].
        bend_ahead: Turn left [rad] below which it bounds that curvature better. Any angle below a
            quarter turn is correct.
        largest: Least bend that is not allowed [rad].
        greatest: Its sine.
    """
    tightest, swing = length * curvature, step * curvature
    late = min(turn, bend_ahead)
    share = (turn - late) * (1.0 / 3.0)
    sine, _ = sincos(min(bend, _QUARTER_TURN))
    inverse, most = 1.0 / max(tightest, _ALMOST_ZERO), bend
    cap = max(sine, tightest)
    most = fma(share, max(fma(-sine, inverse, 1.0), 0.0), most)
    most = bend_on(most, share, inverse)
    most = bend_on(most, share, inverse)
    inverse_length = 1.0 / length
    share, ratio = late * (1.0 / 3.0), length_ahead * inverse_length
    most = bend_on(most, share, max(inverse, inverse_tangent(late, ratio)))
    most = bend_on(most, share, max(inverse, inverse_tangent(late - share, ratio)))
    most = bend_on(most, share, max(inverse, inverse_tangent(share, ratio))) + swing
    sine, _ = sincos(min(most, _QUARTER_TURN))
    sine = min(sine, cap)
    cosine = math.sqrt(max(1.0 - sine * sine, 0.0))
    held = (sine < greatest) & (bend < largest) & (swing <= cosine) & (step <= length)
    behind = (sine / max(cosine, _ALMOST_ZERO) + swing) * inverse_length
    return held, behind, min(most, _STEEPEST), sine / (1.0 + cosine)


@kernel
def inverse_tangent(turn, ratio):
    """Return at most a ratio of lengths over the tangent of an angle from 0 to ``_STEEPEST``."""
    square = turn * turn
    cosine = 1.0 - square * (1.0 / 2.0 - square * (1.0 / 24.0 - square * (1.0 / 720.0)))
    sine = turn * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0)))
    return ratio * cosine / max(sine, _ALMOST_ZERO)


@kernel
def bend_on(bend, turn, inverse):
    """Return a bend after a turn [rad] of the unit ahead, by a step that is certainly too long."""
    angle = min(bend, _QUARTER_TURN)
    square = angle * angle
    series = fma(square, fma(square, -1.0 / 5040.0, 1.0 / 120.0), -1.0 / 6.0)
    sine = angle * fma(square, series, 1.0)
    return fma(turn, max(fma(-sine, inverse, 1.0), 0.0), bend)
