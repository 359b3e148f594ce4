"""Who is near a HAV under Reserve, and what of them it senses and hears: a slot for each.

What an other one reserved is an outline in a frame of its own; it is heard where that frame is from
that one's truck, before its last step and after it, and sensed where the truck is. Who reserved
nothing stands where it is.
"""

import math

from baselines.policy import heard
from baselines.reserve.candidates import dice
from baselines.reserve.layout import (
    AFTER,
    ARRIVED,
    BEFORE,
    DOUBT,
    FRAME,
    KIND,
    MODE,
    NUM_AXLES,
    NUM_RESTLESS,
    NUM_SLOTS,
    NUMBER,
    OUTLINE,
    RADIUS,
    RAW,
    RESERVED,
    SEEN,
    SLOT_AXLES,
    SLOTS,
    STAMP,
    STANDING,
)
from baselines.reserve.others import slot_at
from hav_env.compiled import rare_kernel
from hav_env.elementary import sincos
from hav_env.geometry import TWO_PI
from hav_env.outline import SIDES, clear_outline, include_point, turn_outline
from hav_env.randomness import uniform
from hav_env.sensing import (
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

_NOISE = 600  # the first draw of a step for noise


@rare_kernel
def gather(policy, rows, memory, world, agent, lane, radius):
    """Take note of all others that may be within a radius [m] round the own truck.

    Returns:
        Whether there were slots for all of them.
    """
    _, _, now = episode_key(world, lane)
    rows[NUM_SLOTS], rows[NUM_RESTLESS] = 0.0, 0.0
    for k in range(num_neighbors(world, agent, lane)):
        x, y = neighbor_position(world, agent, k, lane)
        distance = math.sqrt(x * x + y * y)
        stamp = heard(memory, world, agent, k, STAMP, lane) if policy.broadcast else 0.0
        reserved = (heard(memory, world, agent, k, MODE, lane) == RESERVED) | (stamp == now + 1.0)
        moved, frame = stamp > 0.0 and reserved, AFTER
        if moved:
            # who has just decided is sensed where it was before, and so is who then stood instead
            stood = neighbor_speed(world, agent, k, lane) == 0.0
            if stamp == now + 1.0 or (stamp == now and stood):
                frame = BEFORE
            fx = heard(memory, world, agent, k, frame, lane)
            fy = heard(memory, world, agent, k, frame + 1, lane)
            reach = math.sqrt(fx * fx + fy * fy) + heard(memory, world, agent, k, RADIUS, lane)
        else:
            length = neighbor_length(world, agent, k, 0, lane)
            reach = max(neighbor_footprint(world, agent, k, lane), length)
        if distance > radius + reach:
            continue
        if rows[NUM_SLOTS] == SLOTS:
            return False
        slot = slot_at(int(rows[NUM_SLOTS]))
        rows[NUM_SLOTS] += 1.0
        rows[slot + NUMBER] = neighbor_id(world, agent, k, lane)
        arrived = stamp > 0.0 and heard(memory, world, agent, k, MODE, lane) == ARRIVED
        rows[NUM_RESTLESS] += 0.0 if arrived else 1.0
        if moved and heard(memory, world, agent, k, RADIUS, lane) > 0.0:
            _note_reserved(policy, rows, slot, frame, memory, world, agent, k, lane)
        else:
            _note_standing(policy, rows, slot, world, agent, k, lane)
        doubt = policy.position_noise + policy.heading_noise * reach
        rows[slot + DOUBT] = doubt
        for side in range(SIDES):
            rows[slot + SEEN + side] += doubt
            rows[slot + RAW + side] += doubt
    return True


@rare_kernel
def _pose_seen(policy, rows, world, agent, k, lane):
    """Return the pose of a neighbour's truck: x, y [m], cosine, sine, with the noise asked for."""
    x, y = neighbor_position(world, agent, k, lane)
    cosine, sine = neighbor_heading_direction(world, agent, k, lane)
    if policy.position_noise + policy.heading_noise > 0.0:
        seed, episode, stream, draw = dice(rows)
        draw += _NOISE + 4 * k
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


@rare_kernel
def _note_reserved(policy, rows, slot, frame, memory, world, agent, k, lane):
    x, y, cosine, sine = _pose_seen(policy, rows, world, agent, k, lane)
    fx = heard(memory, world, agent, k, frame, lane)
    fy = heard(memory, world, agent, k, frame + 1, lane)
    fc = heard(memory, world, agent, k, frame + 2, lane)
    fs = heard(memory, world, agent, k, frame + 3, lane)
    rows[slot + KIND] = RESERVED
    rows[slot + FRAME] = x + fx * cosine - fy * sine
    rows[slot + FRAME + 1] = y + fy * cosine + fx * sine
    rows[slot + FRAME + 2] = fc * cosine - fs * sine
    rows[slot + FRAME + 3] = fs * cosine + fc * sine
    for side in range(SIDES):
        rows[slot + RAW + side] = heard(memory, world, agent, k, OUTLINE + side, lane)
    turn_outline(
        rows,
        slot + SEEN,
        rows,
        slot + RAW,
        rows[slot + FRAME],
        rows[slot + FRAME + 1],
        rows[slot + FRAME + 2],
        rows[slot + FRAME + 3],
    )


@rare_kernel
def _note_standing(policy, rows, slot, world, agent, k, lane):
    x, y, cosine, sine = _pose_seen(policy, rows, world, agent, k, lane)
    count = neighbor_trailers(world, agent, k, lane) + 2
    rows[slot + KIND], rows[slot + NUM_AXLES] = STANDING, count
    length = neighbor_length(world, agent, k, 0, lane)
    axles = slot + SLOT_AXLES
    rows[axles], rows[axles + 1] = x + length * cosine, y + length * sine
    rows[axles + 2], rows[axles + 3] = x, y
    for joint in range(1, count - 1):
        c, s = neighbor_articulation(world, agent, k, joint, lane)
        cosine, sine = cosine * c - sine * s, sine * c + cosine * s
        length = neighbor_length(world, agent, k, joint, lane)
        x, y = x - length * cosine, y - length * sine
        rows[axles + 2 * joint + 2], rows[axles + 2 * joint + 3] = x, y
    clear_outline(rows, slot + SEEN)
    for axle in range(count):
        include_point(rows, slot + SEEN, rows[axles + 2 * axle], rows[axles + 2 * axle + 1])
