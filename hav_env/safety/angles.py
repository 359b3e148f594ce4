"""This module predicts backups by the articulations alone.

It moves the trailers of several HAVs in waves, as ``hav_env.safety.waves`` does. However, a unit is
known by the cosine and the sine of the heading ahead relative to its own. Units turn by less than
a quarter of a radian in a step, so short polynomials are enough: a third of the work. The results
do not have the bits of a simulation. ``judge_angles`` says so where a joint comes within
``_UNSURE_COSINE`` of its limit. docs/safety-filter.md has the proof.
"""

import math

from hav_env.compiled import fma, kernel, shift_up
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import clip, into_frame
from hav_env.safety.chains import NARROW_BAY
from hav_env.safety.commands import share_of_steering
from hav_env.safety.straightening import cosine_limit
from hav_env.safety.trial_moves import ASKED_SPEED, ASKED_STEERING, POSTURE
from hav_env.safety.waves import PENDING, UNSAFE, UNSURE, WILL_STRAIGHTEN
from hav_env.world.arrays import ARTICULATION, SPEED, STEERING

ABREAST = 64  # trailers side by side
# of the heading ahead relative to the own one: cosine, sine, the same before the step in question;
# one over the length [1/m]; of the last step of the unit ahead, and then of the own one: way [m],
# cosine and sine of the turn; least cosine of the articulation after a step; of a first trailer,
# the truck's step at full speed [m], and 0 of others
(
    _ANGLE_COSINE,
    _ANGLE_SINE,
    _FIRST_COSINE,
    _FIRST_SINE,
    _INVERSE,
    _WAY_DRIVEN,
    _TURN_COSINE,
    _TURN_SINE,
    _LOWEST_COSINE,
    _TRUCK_STEP,
    ANGLE_ROWS,
) = range(11)
# of a HAV: lane; command on trial; trailers; steps of the truck; step at full speed [m]; cosine of
# the limit
OF_LANE, ON_TRIAL, HAS_TRAILERS, STEPS_MADE, _FULL_STEP, _COSINE_AT_LIMIT, HAV_ROWS = range(7)
# far more than the error of a prediction
_UNSURE_COSINE = 2e-7
# the polynomials hold for such turns in a step [rad], so no joint passes its limit unnoticed
MOST_TURN, MOST_BEND = 0.25, 2.0


@kernel
def note_angles(world, agent, lane, rows, chain, own, hav, first):
    """Write the articulations of a HAV before the step in question to slots from ``first`` on."""
    trailers, cosines = world.fleet.num_trailers[agent, lane], POSTURE + world.units
    own[OF_LANE, hav], own[HAS_TRAILERS, hav] = float(lane), float(trailers)
    own[_COSINE_AT_LIMIT, hav] = cosine_limit(world.fleet.limit[agent, ARTICULATION, lane])
    sines = cosines + world.units
    for unit in range(1, trailers + 1):
        slot = first + unit - 1
        chain[_FIRST_COSINE, slot], chain[_FIRST_SINE, slot] = into_frame(
            rows[cosines + unit - 1, lane],
            rows[sines + unit - 1, lane],
            rows[cosines + unit, lane],
            rows[sines + unit, lane],
        )
        chain[_INVERSE, slot] = 1.0 / world.fleet.length[agent, unit, lane]
        chain[_TRUCK_STEP, slot] = 0.0


@kernel
def begin_command(dt, world, agent, rows, chain, own, hav, first, number):
    """Put a HAV at its position before the step, and make the first wave of a command.

    Only the first trailer moves in that wave.

    Returns:
        Whether its joint is clearly beyond the limit.
    """
    limit, lane, trailers = world.fleet.limit, int(own[OF_LANE, hav]), int(own[HAS_TRAILERS, hav])
    fastest, steepest = limit[agent, SPEED, lane], limit[agent, STEERING, lane]
    turned = clip(rows[ASKED_STEERING, lane], -steepest, steepest) * share_of_steering(number)
    step = dt * clip(rows[ASKED_SPEED, lane], 0.0, fastest)
    sine, cosine = sincos(turned)
    turn_sine, turn_cosine = sincos(step * sine / (world.fleet.length[agent, 0, lane] * cosine))
    own[ON_TRIAL, hav], own[STEPS_MADE, hav] = float(number), 1.0
    own[_FULL_STEP, hav] = dt * fastest
    for slot in range(first, first + trailers):
        chain[_ANGLE_COSINE, slot], chain[_ANGLE_SINE, slot] = (
            chain[_FIRST_COSINE, slot],
            chain[_FIRST_SINE, slot],
        )
        chain[_WAY_DRIVEN, slot] = chain[_TURN_SINE, slot] = 0.0
        chain[_TURN_COSINE, slot] = chain[_LOWEST_COSINE, slot] = 1.0
    chain[_WAY_DRIVEN, first], chain[_TRUCK_STEP, first] = step, 0.0
    chain[_TURN_COSINE, first], chain[_TURN_SINE, first] = turn_cosine, turn_sine
    move_trailer(chain, first)
    chain[_TRUCK_STEP, first] = dt * fastest
    return chain[_LOWEST_COSINE, first] < own[_COSINE_AT_LIMIT, hav] - _UNSURE_COSINE


@kernel
def move_up(chain, own, hav, first, new_hav, new_first):
    """Move a HAV and its trailers to earlier places."""
    for row in range(HAV_ROWS):
        own[row, new_hav] = own[row, hav]
    for row in range(ANGLE_ROWS):
        for slot in range(int(own[HAS_TRAILERS, new_hav])):
            chain[row, new_first + slot] = chain[row, first + slot]


@kernel
def clear_slot(chain, slot):
    """Put a slot at rest."""
    for row in range(ANGLE_ROWS):
        chain[row, slot] = 0.0


@kernel
def hand_on_turns(chain, vectors):
    """Move what units hand on to the trailers behind."""
    driven = cosine = sine = 0.0
    for vector in range(vectors):
        place = vector * NARROW_BAY
        driven = shift_up(chain, _WAY_DRIVEN, place, driven)
        cosine = shift_up(chain, _TURN_COSINE, place, cosine)
        sine = shift_up(chain, _TURN_SINE, place, sine)


@kernel
def move_trailer(chain, slot):
    """Move one trailer by a step: the kinematics of ``OnAxle``, in articulations."""
    # reads come before selections: compiled code branches where it selects between reads
    driven, truck = chain[_WAY_DRIVEN, slot], chain[_TRUCK_STEP, slot]
    turn_cosine, turn_sine = chain[_TURN_COSINE, slot], chain[_TURN_SINE, slot]
    leads = truck > 0.0  # the truck drives straight on
    driven = truck if leads else driven
    turn_cosine, turn_sine = 1.0 if leads else turn_cosine, 0.0 if leads else turn_sine
    cosine, sine = chain[_ANGLE_COSINE, slot], chain[_ANGLE_SINE, slot]
    cosine, sine = _turn_on(cosine, sine, turn_cosine, turn_sine)
    turn = driven * chain[_INVERSE, slot] * sine
    turn_cosine, turn_sine = _tiny_sincos(turn)
    cosine, sine = _turn_on(cosine, sine, turn_cosine, -turn_sine)
    chain[_ANGLE_COSINE, slot], chain[_ANGLE_SINE, slot] = cosine, sine
    chain[_TURN_COSINE, slot], chain[_TURN_SINE, slot] = turn_cosine, turn_sine
    chain[_WAY_DRIVEN, slot] = driven * cosine
    least = chain[_LOWEST_COSINE, slot]  # a trailer that has not begun has not moved
    chain[_LOWEST_COSINE, slot] = min(least, cosine) if driven != 0.0 else least


@kernel
def _turn_on(cosine, sine, turn_cosine, turn_sine):
    """Return cosine and sine of the sum of two angles."""
    return (
        fma(cosine, turn_cosine, -sine * turn_sine),
        fma(sine, turn_cosine, cosine * turn_sine),
    )


@kernel
def _tiny_sincos(angle):
    """Return cosine and sine of an angle up to a quarter of a radian, within 1e-12."""
    z = angle * angle
    cosine = fma(z, fma(z, 1.0 / 40_320.0, -1.0 / 720.0), 1.0 / 24.0)
    sine = fma(z, fma(z, 1.0 / 362_880.0, -1.0 / 5_040.0), 1.0 / 120.0)
    cosine, sine = fma(z, fma(z, cosine, -0.5), 1.0), fma(z, fma(z, sine, -1.0 / 6.0), 1.0)
    return cosine, angle * sine


@kernel
def judge_angles(safety, chain, own, hav, first):
    """Return what the waves so far show of a HAV: UNSAFE .. UNSURE."""
    trailers, limit = int(own[HAS_TRAILERS, hav]), own[_COSINE_AT_LIMIT, hav]
    step, least = own[_FULL_STEP, hav], 1.0
    for slot in range(first, first + trailers):
        least = min(least, chain[_LOWEST_COSINE, slot])
    if not least > limit + _UNSURE_COSINE:
        return UNSAFE if least < limit - _UNSURE_COSINE else UNSURE
    if own[STEPS_MADE, hav] > safety.horizon:
        return UNSURE
    curvature, turn_cosine, turn_sine, driven = 0.0, 1.0, 0.0, step
    for slot in range(first, first + trailers):
        cosine, sine = _turn_on(
            chain[_ANGLE_COSINE, slot], chain[_ANGLE_SINE, slot], turn_cosine, turn_sine
        )
        inverse = chain[_INVERSE, slot]
        bent = max(abs(sine) * inverse, curvature)
        straight = inverse * inverse - bent * bent
        held = max(limit, curvature * step) + _UNSURE_COSINE
        held *= inverse
        if not (straight > held * held) or not cosine > 0.0 or not driven >= 0.0:
            return PENDING
        curvature = inverse * (bent / math.sqrt(straight) + curvature * step)
        turn_cosine, turn_sine = chain[_TURN_COSINE, slot], chain[_TURN_SINE, slot]
        driven = chain[_WAY_DRIVEN, slot]
    return WILL_STRAIGHTEN
