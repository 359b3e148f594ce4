"""This module gathers the sensed and received states of other HAVs near a HAV under Reserve.

The nearest others get a slot each. The HAV also writes the radius within which there is no other
HAV.

Another HAV broadcasts its outline, and the outline's frame as seen from its truck before and after
its last step. The HAV senses the position of that truck, and derives the frame from it. A HAV
without a reservation stands at its sensed position.

The kernels are inlined: a call copies hundreds of numbers that describe the arrays of a world,
which takes longer than most of them.
"""

import math

from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes, states
from baselines.policies.reserve.memory.random_numbers import NOISE, random_key
from baselines.policies.reserve.memory.shortlist import insert
from baselines.policies.reserve.perception.other_agents import is_newcomer, slot_at
from baselines.policies.reserve.perception.own_state import sag, stride
from hav_env.compiled import kernel, rare_kernel
from hav_env.maths.elementary import sincos
from hav_env.maths.geometry import TWO_PI
from hav_env.maths.kdop import SIDES, clear_outline, include_point, turn_outline, widen
from hav_env.maths.random_numbers import uniform
from hav_env.policies.interface import heard
from hav_env.world.sensing import (
    episode_key,
    neighbor_articulation,
    neighbor_footprint,
    neighbor_heading_direction,
    neighbor_id,
    neighbor_length,
    neighbor_position,
    neighbor_speed,
    neighbor_trailers,
    num_neighbors,
)

_DRAWS_PER_NEIGHBOR = 3  # of the noise: direction and distance of the position, and heading


@rare_kernel
def gather(policy, rows, memory, world, agent, lane, radius):
    """Write the others that may be within a radius [m] round the own truck into slots.

    The nearest get slots. ``COVERED_RADIUS`` is the radius within which there is no HAV without a
    slot.
    """
    rows[m.NUM_SLOTS], rows[m.NUM_UNARRIVED], rows[m.NEWCOMERS] = 0.0, 0.0, 0.0
    rows[m.COVERED_RADIUS] = radius
    count = 0
    for k in range(num_neighbors(world, agent, lane)):
        gap = _least_distance(policy, rows, memory, world, agent, k, lane)
        if gap <= radius:
            rows[m.NEWCOMERS] += 1.0 if is_newcomer(rows, world, agent, k, lane) else 0.0
            count = insert(rows, count, gap, k, sizes.SHORTLIST_SIZE)
    if count > sizes.SLOT_COUNT:
        count, rows[m.COVERED_RADIUS] = sizes.SLOT_COUNT, rows[m.LISTED_LENGTHS + sizes.SLOT_COUNT]
    for number in range(count):
        k = int(rows[m.LISTED_NUMBERS + number])
        rows[m.NEWCOMERS] -= 1.0 if is_newcomer(rows, world, agent, k, lane) else 0.0
        _write_slot(policy, rows, slot_at(number), memory, world, agent, k, lane)
    rows[m.NUM_SLOTS] = count


@kernel
def _frame_row(policy, memory, world, agent, k, lane):
    """Return the row of a neighbour's frame that fits its sensed pose, -1 if it stands."""
    stamp = heard(memory, world, agent, k, m.STAMP, lane) if policy.broadcast else 0.0
    _, _, now = episode_key(world, lane)
    reserved = (heard(memory, world, agent, k, m.MODE, lane) == states.RESERVED) | (
        stamp == now + 1.0
    )
    if not (
        (stamp > 0.0) & reserved & (heard(memory, world, agent, k, m.OUTLINE_RADIUS, lane) > 0.0)
    ):
        return -1
    # A neighbour that has just decided is sensed at its position before that step. So is one that
    # decided in the last step and then stood.
    stood = neighbor_speed(world, agent, k, lane) == 0.0
    return m.FRAME_BEFORE if stamp == now + 1.0 or (stamp == now and stood) else m.FRAME_AFTER


@kernel
def _radius_of(frame, memory, world, agent, k, lane):
    """Return the radius [m] round a neighbour's truck that holds it and its outline.

    Args:
        frame: Row of its frame, from ``_frame_row``.
        memory: Memory of all HAVs.
        world: World of the HAV.
        agent: Number of the HAV.
        k: Place of the neighbour among those in range.
        lane: Lane of the world.
    """
    if frame < 0:
        length = neighbor_length(world, agent, k, 0, lane)
        return max(neighbor_footprint(world, agent, k, lane), length)
    x = heard(memory, world, agent, k, frame, lane)
    y = heard(memory, world, agent, k, frame + 1, lane)
    return math.sqrt(x * x + y * y) + heard(memory, world, agent, k, m.OUTLINE_RADIUS, lane)


@kernel
def _position_error(policy, reach):
    """Return the largest sensing error [m] of a point at a distance [m] from its truck."""
    return policy.position_noise + policy.heading_noise * reach


@kernel
def _least_distance(policy, rows, memory, world, agent, k, lane):
    """Return a lower bound of the distance [m] from the own truck to a neighbour's outline."""
    x, y, _, _ = _sensed_pose(policy, rows, memory, world, agent, k, lane)
    frame = _frame_row(policy, memory, world, agent, k, lane)
    reach = _radius_of(frame, memory, world, agent, k, lane)
    return math.sqrt(x * x + y * y) - reach - _position_error(policy, reach)


@kernel
def _write_slot(policy, rows, slot, memory, world, agent, k, lane):
    """Write a neighbour into a slot."""
    rows[slot + m.SLOT_NUMBER] = neighbor_id(world, agent, k, lane)
    stamp = heard(memory, world, agent, k, m.STAMP, lane) if policy.broadcast else 0.0
    arrived = stamp > 0.0 and heard(memory, world, agent, k, m.MODE, lane) == states.ARRIVED
    rows[m.NUM_UNARRIVED] += 0.0 if arrived else 1.0
    frame = _frame_row(policy, memory, world, agent, k, lane)
    if frame < 0:
        _write_standing(policy, rows, slot, memory, world, agent, k, lane)
    else:
        _write_reserved(policy, rows, slot, frame, memory, world, agent, k, lane)
    error = _position_error(policy, _radius_of(frame, memory, world, agent, k, lane))
    rows[slot + m.SLOT_ERROR] = error
    widen(rows, slot + m.SLOT_OUTLINE, error)
    if frame >= 0:
        widen(rows, slot + m.SLOT_BROADCAST_OUTLINE, error)


@kernel
def _sensed_pose(policy, rows, memory, world, agent, k, lane):
    """Return the pose of a neighbour's truck with noise: x [m], y [m], cosine, sine."""
    x, y = neighbor_position(world, agent, k, lane)
    cosine, sine = neighbor_heading_direction(world, agent, k, lane)
    if policy.position_noise + policy.heading_noise > 0.0:
        seed, episode, stream, draw = random_key(rows, NOISE, _DRAWS_PER_NEIGHBOR * memory.shape[0])
        draw += _DRAWS_PER_NEIGHBOR * neighbor_id(world, agent, k, lane)
        off_sine, off_cosine = sincos(TWO_PI * uniform(seed, episode, stream, draw))
        off = policy.position_noise * math.sqrt(uniform(seed, episode, stream, draw + 1))
        x, y = x + off * off_cosine, y + off * off_sine
        turn = policy.heading_noise * (2.0 * uniform(seed, episode, stream, draw + 2) - 1.0)
        turn_sine, turn_cosine = sincos(turn)
        cosine, sine = (
            cosine * turn_cosine - sine * turn_sine,
            sine * turn_cosine + cosine * turn_sine,
        )
    return x, y, cosine, sine


@kernel
def _write_reserved(policy, rows, slot, frame, memory, world, agent, k, lane):
    """Write a neighbour that has reserved an outline into a slot."""
    x, y, cosine, sine = _sensed_pose(policy, rows, memory, world, agent, k, lane)
    fx = heard(memory, world, agent, k, frame, lane)
    fy = heard(memory, world, agent, k, frame + 1, lane)
    fc = heard(memory, world, agent, k, frame + 2, lane)
    fs = heard(memory, world, agent, k, frame + 3, lane)
    rows[slot + m.SLOT_KIND] = states.RESERVED
    rows[slot + m.SLOT_FRAME] = x + fx * cosine - fy * sine
    rows[slot + m.SLOT_FRAME + 1] = y + fy * cosine + fx * sine
    rows[slot + m.SLOT_FRAME + 2] = fc * cosine - fs * sine
    rows[slot + m.SLOT_FRAME + 3] = fs * cosine + fc * sine
    for side in range(SIDES):
        rows[slot + m.SLOT_BROADCAST_OUTLINE + side] = heard(
            memory, world, agent, k, m.OUTLINE + side, lane
        )
    turn_outline(
        rows,
        slot + m.SLOT_OUTLINE,
        rows,
        slot + m.SLOT_BROADCAST_OUTLINE,
        rows[slot + m.SLOT_FRAME],
        rows[slot + m.SLOT_FRAME + 1],
        rows[slot + m.SLOT_FRAME + 2],
        rows[slot + m.SLOT_FRAME + 3],
    )


@kernel
def _write_standing(policy, rows, slot, memory, world, agent, k, lane):
    """Write a neighbour that stands into a slot: its axles, and their outline."""
    x, y, cosine, sine = _sensed_pose(policy, rows, memory, world, agent, k, lane)
    count = neighbor_trailers(world, agent, k, lane) + 2
    rows[slot + m.SLOT_KIND], rows[slot + m.SLOT_NUM_AXLES] = states.STANDING, count
    length = neighbor_length(world, agent, k, 0, lane)
    axles = slot + m.SLOT_AXLES
    rows[axles], rows[axles + 1] = x + length * cosine, y + length * sine
    rows[axles + 2], rows[axles + 3] = x, y
    shortest = length
    for joint in range(1, count - 1):
        c, s = neighbor_articulation(world, agent, k, joint, lane)
        cosine, sine = cosine * c - sine * s, sine * c + cosine * s
        length = neighbor_length(world, agent, k, joint, lane)
        shortest = min(shortest, length)
        x, y = x - length * cosine, y - length * sine
        rows[axles + 2 * joint + 2], rows[axles + 2 * joint + 3] = x, y
    step, steepest = rows[m.OWN_STEP], rows[m.OWN_STEERING_TANGENT]
    rows[slot + m.SLOT_SAG] = sag(step, steepest, shortest)
    rows[slot + m.SLOT_STRIDE] = stride(step, steepest, shortest, count - 2)
    clear_outline(rows, slot + m.SLOT_OUTLINE)
    for axle in range(count):
        include_point(
            rows, slot + m.SLOT_OUTLINE, rows[axles + 2 * axle], rows[axles + 2 * axle + 1]
        )
