"""This module has the arrays of trailers under prediction, which are the lanes of a block."""

import math
from typing import Any, NamedTuple

from hav_env.compiled import generic, kernel
from hav_env.world.arrays import Fleet, State, World
from hav_env.world.units.parts import Hitches, Motion, OnAxles

NARROW_BAY, WIDE_BAY = 8, 16  # trailers of a bay: a vector, or several
BAYS = 2  # narrow bays side by side at most
SLOTS = 112  # trailers of a block at most: 100, in whole vectors
LOOK_PERIOD = 16  # steps between looks
MOST_LOOKS = SLOTS // LOOK_PERIOD + 1  # looks under way at most
# rows of joints: heading of the unit ahead [rad]; limit of the articulation, and excess over it
HEADING_AHEAD, MOST_BENT, BENT_EXCESS, JOINT_ROWS = range(4)
HANDED_ROWS = 8  # rows of motion that trailers hand on, at most
# columns of a look: posture of the last unit, and the bounds there
(
    UNIT_HEADING,
    UNIT_COSINE,
    UNIT_SINE,
    CURVATURE_AHEAD,
    LEAST_SO_FAR,
    GREATEST_SO_FAR,
    UNHELD,
    LOOK_COLUMNS,
) = range(8)
# columns of a bay: its lane or -1; number of the command on trial; trailers; waves since the HAV
# came; the newest look, and waves since it began; the same for the last trailer, which is behind;
# step [m] and limits of its bounds; from column OWN_TRUCK on the truck's posture and motion
(
    OWN_LANE,
    TRIAL_NUMBER,
    BAY_TRAILERS,
    WAVES_MADE,
    NEWEST_LOOK,
    WAVES_SINCE,
    LOOKS_BEHIND,
    WAVES_BEHIND,
) = range(8)
STEP_LENGTH, LEAST_COSINE, MOST_SPREAD, OWN_TRUCK = range(8, 12)
BAY_COLUMNS = OWN_TRUCK + 3 + HANDED_ROWS


class Chains(NamedTuple):
    """Arrays of the trailers under prediction, on the stack of the kernel that predicts."""

    heading: Any  # (1, 2, SLOTS); row 1 has the trailers, as for a HAV with one trailer
    cosine: Any
    sine: Any
    length: Any
    offset: Any  # row 0 has the offsets of the hitches ahead
    joint: Any  # (1, JOINT_ROWS, SLOTS)
    motion: Any  # (1, HANDED_ROWS, SLOTS) of the units ahead
    look: Any  # (BAYS, MOST_LOOKS, LOOK_COLUMNS)
    bay: Any  # (1, BAYS, BAY_COLUMNS)


@kernel
def clear_chains(chains, slots):
    """Put trailers at rest, none of a HAV."""
    for slot in range(slots):
        chains.heading[0, 1, slot] = chains.sine[0, 1, slot] = chains.offset[0, 0, slot] = 0.0
        chains.cosine[0, 1, slot] = chains.length[0, 1, slot] = 1.0
        for row in range(JOINT_ROWS):
            chains.joint[0, row, slot] = 0.0
        for row in range(HANDED_ROWS):
            chains.motion[0, row, slot] = 0.0
        chains.joint[0, MOST_BENT, slot] = math.inf
    for bay in range(BAYS):
        for column in range(BAY_COLUMNS):
            chains.bay[0, bay, column] = 0.0
        chains.bay[0, bay, OWN_LANE] = -1.0


@kernel
def view_chains(world, chains, slots):
    """Return the trailers as a block of worlds whose lanes are slots."""
    state, fleet = world.state, world.fleet
    return World(
        State(
            state.x,
            state.y,
            chains.heading,
            chains.cosine,
            chains.sine,
            state.speed,
            state.steering,
            chains.motion[0],
            state.goal,
            state.waiting,
            state.clock,
        ),
        Fleet(
            fleet.num_trailers,
            chains.length,
            fleet.radius,
            fleet.limit,
            _view_joints(fleet.joints, chains),
            fleet.bodies,
        ),
        world.goals,
        world.nearby,
        world.record,
        world.place,
        world.guidance,
        0,
        slots,
        2,
        world.rolls,
    )


@generic
def _view_joints(joints, chains):
    """Return the joints of the trailers in slots."""


@generic
def motion_rows(joints):
    """Return the number of rows of motion that a trailer hands on."""


@_view_joints.register(OnAxles)
def _view_on_axles(joints, chains):
    return joints


@motion_rows.register(OnAxles)
def _rows_on_axles(joints):
    return 3


@_view_joints.register(Hitches)
def _view_hitches(joints, chains):
    motion = chains.motion[0]
    return Hitches(
        chains.offset,
        chains.joint,
        Motion(motion[0], motion[1], motion[2], motion[3]),
        Motion(motion[4], motion[5], motion[6], motion[7]),
    )


@motion_rows.register(Hitches)
def _rows_of_hitches(joints):
    return HANDED_ROWS
