"""A path has the length and the turns of its segments, and shortcuts decide as all of its steps."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from baselines.policies.reserve import Reserve
from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import states
from baselines.policies.reserve.perception.other_agents import gap_to, keeps_margin, slot_at
from baselines.policies.reserve.prediction.chain import (
    COARSE_TURN,
    include_axles,
    keeps_clear_of,
    nose_keeps_clear,
    place_axles,
    pull_axles,
)
from baselines.policies.reserve.prediction.coarse_paths import is_drivable
from baselines.policies.reserve.prediction.holding_circle import (
    SHIFTS,
    circle_is_free,
    find_circle,
)
from baselines.policies.reserve.prediction.motion import advance_chain, sense_chain, turn_to
from baselines.policies.reserve.prediction.paths import append, heading_at, total_length
from baselines.policies.reserve.reservation import predict_part
from hav_env.maths.elementary import sincos
from hav_env.maths.kdop import SIDES, clear_outline, include_disc, include_point, turn_outline
from tests.baselines.reserve.test_joints import STEP, bent
from tests.support.budgets import budget

MARGIN, FAR = 0.3, 2.0


@given(st.lists(st.tuples(st.floats(-0.5, 0.5), st.floats(0.1, 50.0)), max_size=7))
def test_the_heading_along_a_path_is_the_sum_of_its_turns(path):
    rows = np.zeros(m.ROWS)
    for curvature, length in path:
        append(rows, m.CURRENT_PATH, curvature, length)
    total = sum(length for _, length in path)
    assert total_length(rows, m.CURRENT_PATH) == pytest.approx(total)
    turned = sum(curvature * length for curvature, length in path)
    assert heading_at(rows, m.CURRENT_PATH, total + 1.0) == pytest.approx(turned)
    if path:
        curvature, length = path[0]
        assert heading_at(rows, m.CURRENT_PATH, 0.5 * length) == pytest.approx(
            0.5 * curvature * length
        )
    assert heading_at(rows, m.CURRENT_PATH, -1.0) == 0.0


def among(random, others, reach):
    """Return the memory of a HAV with others at random places within ``reach`` [m]."""
    rows = bent(random, 0.8)
    lengths = rows[m.OWN_LENGTHS : m.OWN_LENGTHS + int(rows[m.OWN_TRAILERS]) + 1]
    rows[m.OWN_REACH] = max(lengths[1:].sum(), lengths[0])
    rows[m.OWN_REAR_RADIUS] = rows[m.OWN_CIRCLE_RADIUS]
    rows[m.OWN_FRONT_RADIUS] = math.hypot(rows[m.OWN_CIRCLE_RADIUS], lengths[0])
    rows[m.PREFERRED_SIDE], rows[m.OWN_GOAL] = 1.0, 1e3
    rows[m.NUM_SLOTS] = rows[m.NUM_UNARRIVED] = others
    for number in range(others):
        slot, place = slot_at(number), random.uniform(-reach, reach, 2)
        if random.random() < 0.6:
            write_standing(random, rows, slot, *place)
        else:
            write_reserved(random, rows, slot, *place)
    return rows


def write_standing(random, rows, slot, x, y):
    """Write a HAV that stands at (x, y) [m] into a slot."""
    rows[slot + m.SLOT_KIND], rows[slot + m.SLOT_NUM_AXLES] = states.STANDING, 4.0
    clear_outline(rows, slot + m.SLOT_OUTLINE)
    for axle in range(4):
        at = slot + m.SLOT_AXLES + 2 * axle
        rows[at], rows[at + 1] = x, y
        include_point(rows, slot + m.SLOT_OUTLINE, x, y)
        heading = random.uniform(0.0, 1.5)
        x, y = x + 5.0 * math.cos(heading), y + 5.0 * math.sin(heading)


def write_reserved(random, rows, slot, x, y):
    """Write a HAV that has reserved a disc round (x, y) [m] into a slot."""
    sine, cosine = sincos(random.uniform(-3.0, 3.0))
    rows[slot + m.SLOT_KIND] = states.RESERVED
    rows[slot + m.SLOT_FRAME : slot + m.SLOT_FRAME + 4] = x, y, cosine, sine
    clear_outline(rows, slot + m.SLOT_BROADCAST_OUTLINE)
    include_disc(rows, slot + m.SLOT_BROADCAST_OUTLINE, 0.0, 0.0, random.uniform(3.0, 12.0))
    outline, other = slot + m.SLOT_OUTLINE, slot + m.SLOT_BROADCAST_OUTLINE
    turn_outline(rows, outline, rows, other, x, y, cosine, sine)


def write_path(random, rows):
    """Write a path of random arcs and straights."""
    rows[m.TRIAL_PATH + m.NUM_SEGMENTS] = 0.0
    radius = rows[m.OWN_CIRCLE_RADIUS]
    for _ in range(int(random.integers(1, 4))):
        side = float(random.integers(-1, 2))
        append(rows, m.TRIAL_PATH, side / radius, random.uniform(0.2, 4.0) * radius)


def passes_all(rows, nose, margin):
    """Return whether the axles keep clear of all HAVs that stand; write their outline."""
    clear_outline(rows, m.BODY_OUTLINE)
    include_axles(rows, m.BODY_OUTLINE)
    return all(
        nose_keeps_clear(rows, slot, *nose, margin) and keeps_clear_of(rows, slot, margin)
        for slot in map(slot_at, range(int(rows[m.NUM_SLOTS])))
        if rows[slot + m.SLOT_KIND] == states.STANDING
        and gap_to(rows, slot, m.BODY_OUTLINE, margin) <= margin + FAR
    )


def is_near(rows, x, y, extent):
    """Return whether the bounding box of another HAV is within ``extent`` [m] of (x, y)."""
    for slot in map(slot_at, range(int(rows[m.NUM_SLOTS]))):
        sides = rows[slot + m.SLOT_OUTLINE :][:SIDES]
        right, top, left, bottom = sides[:: SIDES // 4]
        if math.hypot(max(x - right, -left - x, 0.0), max(y - top, -bottom - y, 0.0)) <= extent:
            return True
    return False


def drives(policy, rows, purpose, horizon):
    """Return whether a path is drivable: pull the chain in every step, and test it."""
    radius = rows[m.OWN_CIRCLE_RADIUS]
    coarse = min(FAR, COARSE_TURN * radius)
    circles = rows[m.OWN_REAR_RADIUS] + rows[m.OWN_FRONT_RADIUS]
    extent = max(rows[m.OWN_REACH], circles) + MARGIN + FAR
    sense_chain(rows)
    place_axles(rows, 0.0, 0.0)
    x, y, heading, driven = 0.0, 0.0, 0.0, 0.0
    for segment in range(int(rows[m.TRIAL_PATH + m.NUM_SEGMENTS])):
        curvature = rows[m.TRIAL_PATH + m.CURVATURES + segment]
        length = rows[m.TRIAL_PATH + m.LENGTHS + segment]
        steps = math.ceil(length / coarse)
        along = length / steps
        half = 0.5 * curvature * along
        chord = along * math.sin(half) / half if half else along
        for _ in range(steps):
            nose = rows[m.AXLES], rows[m.AXLES + 1]
            sine, cosine = sincos(heading + half)
            x, y = x + chord * cosine, y + chord * sine
            heading, driven = heading + 2.0 * half, driven + along
            sine, cosine = sincos(heading)
            pull_axles(rows, x, y, cosine, sine)
            if not passes_all(rows, nose, MARGIN):
                return False
            if driven > horizon or not is_near(rows, x, y, extent):
                continue
            if not keeps_margin(rows, m.BODY_OUTLINE, states.RESERVED, MARGIN):
                return False
            side, _ = find_circle(policy, rows, x, y, heading, SHIFTS, MARGIN, False)
            if side == 0.0:
                return False
    return True


@pytest.mark.parametrize("seed", range(budget(60, 3)))
def test_a_path_is_drivable_if_every_step_of_it_is(seed):
    random = np.random.default_rng(seed)
    rows = among(random, int(random.integers(1, 6)), 80.0)
    horizon = random.choice([-1.0, 3.0 * rows[m.OWN_FRONT_RADIUS]])
    for _ in range(3):
        write_path(random, rows)
        found = is_drivable(Reserve(), rows, m.TRIAL_PATH, 0.0, states.PLACE_PATH, horizon, MARGIN)
        assert found == drives(Reserve(), rows, states.PLACE_PATH, horizon)


@pytest.mark.parametrize("seed", range(budget(60, 3)))
def test_a_circle_is_free_if_every_step_of_it_is(seed):
    random = np.random.default_rng(seed)
    rows = among(random, 0, 0.0)
    radius = rows[m.OWN_CIRCLE_RADIUS]
    side, shift = random.choice([-1.0, 1.0]), random.choice([0.0, radius])
    rows[m.NUM_SLOTS] = 2.0
    for number in range(2):  # near the circle that the nose drives
        sine, cosine = sincos(random.uniform(-3.1, 3.1))
        away = rows[m.OWN_FRONT_RADIUS] + random.uniform(-3.0, 12.0)
        x, y = shift + away * cosine, side * radius + away * sine
        write_standing(random, rows, slot_at(number), x, y)
    sense_chain(rows)
    place_axles(rows, 0.0, 0.0)
    clear_outline(rows, m.BODY_OUTLINE)
    include_axles(rows, m.BODY_OUTLINE)
    axles = rows[m.AXLES : m.PREVIOUS_AXLES].copy()
    found = circle_is_free(Reserve(), rows, 0.0, 0.0, 0.0, side, shift, MARGIN, False)
    rows[m.AXLES : m.PREVIOUS_AXLES] = axles
    assert found == circles(rows, side, shift)


def circles(rows, side, shift):
    """Return whether three turns of a circle are free: pull the chain in every step, and test."""
    radius = rows[m.OWN_CIRCLE_RADIUS]
    step = min(1.5, COARSE_TURN * radius)
    straight = math.ceil(shift / step)
    x, y, heading, turn = 0.0, 0.0, 0.0, side * step / radius
    for number in range(straight + math.ceil(6.0 * math.pi * radius / step)):
        nose, ahead = (rows[m.AXLES], rows[m.AXLES + 1]), heading
        length = shift / max(straight, 1)
        if number >= straight:
            ahead, heading = heading + 0.5 * turn, heading + turn
            length = 2.0 * radius * sincos(0.5 * step / radius)[0]
        sine, cosine = sincos(ahead)
        x, y = x + length * cosine, y + length * sine
        sine, cosine = sincos(heading)
        pull_axles(rows, x, y, cosine, sine)
        if not passes_all(rows, nose, MARGIN):
            return False
    return True


@pytest.mark.parametrize("seed", range(budget(30, 2)))
def test_the_outline_of_a_part_holds_every_step_and_no_more(seed):
    random = np.random.default_rng(seed)
    rows = bent(random, 0.3)
    write_path(random, rows)
    end = random.uniform(0.0, 1.0) * total_length(rows, m.TRIAL_PATH)
    kept, x, y, turned, driven = predict_part(
        Reserve(), rows, m.TRIAL_PATH, 0.0, 0.0, end, False, -1.0
    )
    outline = rows[m.TRIAL_OUTLINE : m.TRIAL_OUTLINE + SIDES].copy()
    chain, axles = rows[m.PREDICTED_CHAIN : m.AXLES].copy(), rows[m.AXLES : m.PREVIOUS_AXLES].copy()
    assert kept
    sense_chain(rows)
    place_axles(rows, 0.0, 0.0)
    clear_outline(rows, m.TRIAL_OUTLINE)
    include_axles(rows, m.TRIAL_OUTLINE)
    along, heading, at = 0.0, 0.0, (0.0, 0.0)
    while along + STEP <= end:
        turn = turn_to(rows, heading_at(rows, m.TRIAL_PATH, along + 0.5 * STEP), heading, STEP)
        *at, _ = advance_chain(rows, *at, turn, STEP)
        heading, along = heading + turn, along + STEP
        place_axles(rows, *at)
        include_axles(rows, m.TRIAL_OUTLINE)
    assert np.array_equal(rows[m.TRIAL_OUTLINE : m.TRIAL_OUTLINE + SIDES], outline)
    assert np.array_equal(rows[m.PREDICTED_CHAIN : m.AXLES], chain)
    assert np.array_equal(rows[m.AXLES : m.PREVIOUS_AXLES], axles)
    assert (x, y, driven) == (*at, along)
    assert turned == pytest.approx(heading)
