"""This module predicts the backups of several HAVs at a time: whether they straighten.

A trailer's step depends on the same step of the unit ahead and on its own step before. So trailer j
can make step t while trailer j + 1 makes step t - 1. A **wave** is one step of every trailer, each
one step behind the trailer ahead. The trailers are the lanes of one block, so one instruction moves
eight of them. Before each wave, the values that they hand on move to the next lane. The simulator's
own kernel moves the trailers, so a prediction has the bits of a simulation.

A **look** follows one step down the chain, one trailer in each wave, and evaluates the bounds of
``hav_env.safety.straightening`` there. There is a look at every sixteenth step only. This is
enough: a HAV straightens if a bound holds before any joint reaches its limit, and once a bound
holds, no joint reaches it later. Where rounding may decide, or the vehicle has no proof, the
prediction is repeated step by step.
"""

import math

from hav_env.compiled import generic, kernel, shift_up
from hav_env.maths.geometry import into_frame
from hav_env.safety.chains import (
    BAY_TRAILERS,
    BENT_EXCESS,
    CURVATURE_AHEAD,
    GREATEST_SO_FAR,
    HEADING_AHEAD,
    LEAST_COSINE,
    LEAST_SO_FAR,
    LOOK_PERIOD,
    LOOKS_BEHIND,
    MOST_BENT,
    MOST_LOOKS,
    MOST_SPREAD,
    NARROW_BAY,
    NEWEST_LOOK,
    OWN_LANE,
    OWN_TRUCK,
    STEP_LENGTH,
    UNHELD,
    UNIT_COSINE,
    UNIT_HEADING,
    UNIT_SINE,
    WAVES_BEHIND,
    WAVES_MADE,
    WAVES_SINCE,
    motion_rows,
    view_chains,
)
from hav_env.safety.straightening import (
    SPARE_ANGLE,
    bound_headings,
    bound_joint,
    cosine_limit,
    largest_spread,
)
from hav_env.vehicles import OffAxle, OnAxle, lead, pull
from hav_env.world.arrays import ARTICULATION, SPEED
from hav_env.world.units.joints import hitch_offset, joint_limit

UNSAFE, PENDING, WILL_STRAIGHTEN, UNSURE = range(-1, 3)
# more than the error of a bound and of a prediction together [rad]
_UNSURE_ANGLE = 1e-7


@kernel
def enter(vehicle, dt, world, agent, lane, chains, bay, width):
    """Let a HAV, at its position after the step in question, enter a bay of slots.

    Returns:
        Whether a joint is at its limit or beyond.
    """
    state, fleet, first = world.state, world.fleet, bay * width
    usual, trailers = fleet.limit[agent, ARTICULATION, lane], fleet.num_trailers[agent, lane]
    fastest = fleet.limit[agent, SPEED, lane]
    view, own, joint = view_chains(world, chains, width), chains.bay[0, bay], chains.joint[0]
    own[OWN_TRUCK + UNIT_HEADING] = ahead = state.heading[agent, 0, lane]
    own[OWN_TRUCK + UNIT_COSINE], own[OWN_TRUCK + UNIT_SINE] = (
        state.cosine[agent, 0, lane],
        state.sine[agent, 0, lane],
    )
    lead(vehicle, view, first, fastest, own[OWN_TRUCK + UNIT_COSINE], own[OWN_TRUCK + UNIT_SINE])
    for row in range(motion_rows(fleet.joints)):
        own[OWN_TRUCK + 3 + row] = chains.motion[0, row, first]
    bent = False
    for unit in range(1, trailers + 1):
        slot, heading = first + unit - 1, state.heading[agent, unit, lane]
        most = joint_limit(fleet.joints, usual, agent, unit, lane) - SPARE_ANGLE
        bent = bent or not abs(heading - ahead) < most
        ahead = heading
        chains.heading[0, 1, slot] = joint[HEADING_AHEAD, slot] = heading
        chains.cosine[0, 1, slot] = state.cosine[agent, unit, lane]
        chains.sine[0, 1, slot] = state.sine[agent, unit, lane]
        chains.length[0, 1, slot] = fleet.length[agent, unit, lane]
        chains.offset[0, 0, slot] = hitch_offset(fleet.joints, agent, unit - 1, lane)
        joint[MOST_BENT, slot] = most
        lead(vehicle, view, slot, 0.0, 1.0, 0.0)  # at rest until the first wave arrives
    for slot in range(first + trailers, first + width):
        joint[MOST_BENT, slot] = math.inf
    period = LOOK_PERIOD * vehicle.substeps
    own[OWN_LANE], own[BAY_TRAILERS] = float(lane), float(trailers)
    own[WAVES_MADE] = own[NEWEST_LOOK] = own[WAVES_SINCE] = 0.0
    own[LOOKS_BEHIND] = float((trailers - 1) // period)
    own[WAVES_BEHIND] = float((trailers - 1) % period)
    own[STEP_LENGTH], own[MOST_SPREAD] = dt * fastest, largest_spread(usual)
    own[LEAST_COSINE] = cosine_limit(usual)
    return bent


@kernel
def wave(vehicle, h, world, chains, width, slots):
    """Move every trailer once, each at its own step; return how many joints are at their limits."""
    joint, motion = chains.joint[0], chains.motion[0]
    for bay in range(slots // width):
        own = chains.bay[0, bay]
        _hand_on(joint, HEADING_AHEAD, bay, width, own[OWN_TRUCK + UNIT_HEADING])
        for row in range(motion_rows(world.fleet.joints)):
            _hand_on(motion, row, bay, width, own[OWN_TRUCK + 3 + row])
    beyond = 0
    for slot in range(slots):
        heading = chains.heading[0, 1, slot]
        bend = abs(heading - joint[HEADING_AHEAD, slot])
        joint[HEADING_AHEAD, slot] = heading
        joint[BENT_EXCESS, slot] = bend - joint[MOST_BENT, slot]
        beyond += 0 if bend < joint[MOST_BENT, slot] else 1
    for bay in range(slots // width):
        if chains.bay[0, bay, OWN_LANE] >= 0.0:
            _look(vehicle, chains, bay, width)
    pull(vehicle, h, view_chains(world, chains, slots), 0, 1)
    return beyond


@kernel
def _hand_on(rows, row, bay, width, value):
    """Move what units hand on to the slots behind, within a bay; a value comes from the truck."""
    for place in range(bay * width, (bay + 1) * width, NARROW_BAY):
        value = shift_up(rows, row, place, value)


@kernel
def _look(vehicle, chains, bay, width):
    """Carry the looks at the HAV of a bay to the next trailers."""
    own, period = chains.bay[0, bay], LOOK_PERIOD * vehicle.substeps
    newest, step = int(own[NEWEST_LOOK]), own[STEP_LENGTH]
    for number in range(int(own[WAVES_SINCE]), int(own[BAY_TRAILERS]), period):
        slot, look = bay * width + number, chains.look[bay, newest]
        newest = newest - 1 if newest > 0 else MOST_LOOKS - 1
        if number == 0:
            look[UNIT_HEADING] = look[LEAST_SO_FAR] = look[GREATEST_SO_FAR] = own[
                OWN_TRUCK + UNIT_HEADING
            ]
            look[UNIT_COSINE], look[UNIT_SINE] = (
                own[OWN_TRUCK + UNIT_COSINE],
                own[OWN_TRUCK + UNIT_SINE],
            )
            look[CURVATURE_AHEAD] = look[UNHELD] = 0.0
        heading = chains.heading[0, 1, slot]
        direction = chains.cosine[0, 1, slot], chains.sine[0, 1, slot]
        length, offset = chains.length[0, 1, slot], abs(chains.offset[0, 0, slot])
        look[LEAST_SO_FAR], look[GREATEST_SO_FAR] = bound_headings(
            look[LEAST_SO_FAR], look[GREATEST_SO_FAR], heading, step, length, offset
        )
        cosine, sine = into_frame(*direction, look[UNIT_COSINE], look[UNIT_SINE])
        held, look[CURVATURE_AHEAD] = bound_joint(
            look[CURVATURE_AHEAD], step, length, offset, cosine, sine, own[LEAST_COSINE]
        )
        look[UNHELD] = look[UNHELD] if held else 1.0
        look[UNIT_HEADING], look[UNIT_COSINE], look[UNIT_SINE] = heading, direction[0], direction[1]


@kernel
def judge(safety, vehicle, chains, bay, width, beyond):
    """Return, after a wave, whether the HAV in a bay straightens: WILL_STRAIGHTEN .. UNSURE.

    A bound that holds at step t and a joint that is at its limit later contradict each other; so
    the HAV does not straighten if the excess is clear. If no bound has held until the horizon, one
    may have held between two looks.
    """
    own = chains.bay[0, bay]
    if beyond > 0:
        worst, bent = -math.inf, False
        for slot in range(bay * width, bay * width + int(own[BAY_TRAILERS])):
            excess = chains.joint[0, BENT_EXCESS, slot]
            worst, bent = max(worst, excess), bent or not excess < 0.0
        if bent:
            return UNSAFE if is_proved(vehicle) and worst > _UNSURE_ANGLE else UNSURE
    done, number = (
        own[WAVES_MADE] - own[BAY_TRAILERS] + 1.0,
        int(own[NEWEST_LOOK] - own[LOOKS_BEHIND]),
    )
    arrives = (own[WAVES_SINCE] == own[WAVES_BEHIND]) & (done >= 0.0)
    _count_wave(vehicle, own)
    if not arrives:
        return PENDING
    if done >= safety.horizon * vehicle.substeps:
        return UNSURE
    look = chains.look[bay, number if number >= 0 else number + MOST_LOOKS]
    spread = look[GREATEST_SO_FAR] - look[LEAST_SO_FAR]
    return WILL_STRAIGHTEN if spread < own[MOST_SPREAD] or look[UNHELD] == 0.0 else PENDING


@kernel
def _count_wave(vehicle, own):
    """Count a wave of a bay, without divisions."""
    own[WAVES_MADE] += 1.0
    own[WAVES_SINCE] += 1.0
    if own[WAVES_SINCE] == LOOK_PERIOD * vehicle.substeps:
        own[WAVES_SINCE] = 0.0
        own[NEWEST_LOOK] = own[NEWEST_LOOK] + 1.0 if own[NEWEST_LOOK] < MOST_LOOKS - 1.0 else 0.0


@generic
def is_proved(vehicle):
    """Return whether joints keep their limits at and between all steps once a bound holds."""


@is_proved.register(OnAxle)
def _is_single_step(vehicle):
    return vehicle.substeps == 1  # joints between steps do not count


@is_proved.register(OffAxle)
def _is_not_proved(vehicle):
    return False
