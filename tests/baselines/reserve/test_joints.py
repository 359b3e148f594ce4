"""Joints within the limit values of the circle stay there; others are predicted step by step."""

import math

import numpy as np
import pytest

from baselines.policies.reserve import Reserve
from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.perception.own_state import SURELY, hits_goal
from baselines.policies.reserve.preconditions import CIRCLE_FACTOR
from baselines.policies.reserve.prediction.joints import (
    are_joints_small,
    circle_keeps_joints,
    path_keeps_joints,
)
from baselines.policies.reserve.prediction.motion import advance_chain, sense_chain, turn_to
from baselines.policies.reserve.prediction.paths import append, heading_at, total_length
from hav_env.maths.elementary import sincos
from tests.support.budgets import budget

STEP, BOUND = 0.2, math.radians(89.0)


def bent(random, most):
    """Return the memory of a HAV with random lengths and joints of up to ``most`` [rad]."""
    rows, trailers = np.zeros(m.ROWS), int(random.integers(1, 11))
    lengths = random.uniform(2.0, 8.0, trailers + 1)
    rows[m.OWN_TRAILERS], rows[m.OWN_STEP], rows[m.OWN_TIGHT] = trailers, STEP, 1.0
    rows[m.OWN_LENGTHS : m.OWN_LENGTHS + trailers + 1] = lengths
    for joint, angle in enumerate(random.uniform(-most, most, trailers)):
        sine, cosine = sincos(angle)
        rows[m.OWN_JOINTS + 2 * joint : m.OWN_JOINTS + 2 * joint + 2] = cosine, sine
    rows[m.OWN_STEERING_TANGENT] = math.tan(math.radians(40.0))
    rows[m.OWN_LEAST_COSINE], rows[m.OWN_FOLD_TURN] = math.cos(BOUND), 2.0 * (math.pi - BOUND)
    least = lengths[0] / rows[m.OWN_STEERING_TANGENT]
    squares = np.cumsum(lengths[1:] ** 2)
    bend = lengths[1:] ** 2 / math.sin(BOUND) ** 2
    trailers_radius = math.sqrt((squares - lengths[1:] ** 2 + bend).max())
    rows[m.OWN_CIRCLE_RADIUS] = CIRCLE_FACTOR * max(least, trailers_radius)
    sense_chain(rows)
    return rows


@pytest.mark.parametrize("seed", range(budget(8, 1)))
def test_small_joints_stay_small_on_paths_as_wide_as_the_circle(seed):
    random = np.random.default_rng(seed)
    rows, most = bent(random, 1.5), 1.5
    while not are_joints_small(rows):
        most *= 0.7
        rows = bent(random, most)
    radius = rows[m.OWN_CIRCLE_RADIUS]
    for _ in range(budget(40, 2)):
        curvature = random.choice([-1.0, 0.0, 1.0, random.uniform(-1.0, 1.0)]) / radius
        for _ in range(int(random.integers(1, 200))):
            *_, least = advance_chain(rows, 0.0, 0.0, curvature * STEP, STEP)
            assert least >= math.cos(BOUND)
        assert are_joints_small(rows)


@pytest.mark.parametrize("seed", range(budget(30, 2)))
def test_a_circle_is_predicted_for_joints_that_are_not_small(seed):
    rows, side = bent(np.random.default_rng(seed), 1.4), 1.0 if seed % 2 else -1.0
    before = rows[m.PREDICTED_CHAIN : m.AXLES].copy()
    shift = 5.0 * (seed % 3)
    found = circle_keeps_joints(rows, side, shift)
    assert np.array_equal(rows[m.PREDICTED_CHAIN : m.AXLES], before)
    radius, driven, heading, kept = rows[m.OWN_CIRCLE_RADIUS], 0.0, 0.0, True
    while kept and driven < shift + 6.0 * math.pi * radius:
        wanted = side * max(driven + 0.5 * STEP - shift, 0.0) / radius
        turn = turn_to(rows, wanted, heading, STEP)
        *_, least = advance_chain(rows, 0.0, 0.0, turn, STEP)
        heading, driven, kept = heading + turn, driven + STEP, least >= math.cos(BOUND)
    assert found == kept


def hits(rows, path):
    """Return whether a chain can drive along a path and hits the goal, without skipping a step."""
    sense_chain(rows)
    goal_x, goal_y, goal_heading = rows[m.OWN_GOAL : m.OWN_GOAL + 3]
    x, y, heading, driven = 0.0, 0.0, 0.0, 0.5 * STEP
    while driven <= total_length(rows, path):
        turn = turn_to(rows, heading_at(rows, path, driven), heading, STEP)
        x, y, least = advance_chain(rows, x, y, turn, STEP)
        heading, driven = heading + turn, driven + STEP
        if least < math.cos(BOUND):
            return False
        if hits_goal(Reserve(), goal_x - x, goal_y - y, goal_heading - heading, SURELY):
            return True
    return False


@pytest.mark.parametrize("seed", range(budget(60, 2)))
def test_a_path_is_predicted_as_its_steps_one_by_one(seed):
    random = np.random.default_rng(seed)
    rows = bent(random, 0.1)
    radius = rows[m.OWN_LENGTHS] / rows[m.OWN_STEERING_TANGENT] * random.uniform(1.0, 2.0)
    pose, heading = 0j, 0.0
    for curvature, length in (
        (random.choice([-1.0, 1.0]) / radius, random.uniform(0.5, 2.0) * radius),
        (0.0, random.uniform(10.0, 200.0)),
        (random.choice([-1.0, 1.0]) / radius, random.uniform(0.5, 2.0) * radius),
    ):
        append(rows, m.TRIAL_PATH, curvature, length)
        after = heading + curvature * length
        if curvature == 0.0:
            pose += length * np.exp(1j * heading)
        else:
            pose += (np.exp(1j * after) - np.exp(1j * heading)) / (1j * curvature)
        heading = after
    rows[m.OWN_GOAL : m.OWN_GOAL + 3] = pose.real, pose.imag, heading
    rows[m.OWN_GOALS_LEFT] = 1.0
    assert path_keeps_joints(Reserve(), rows, m.TRIAL_PATH, True) == hits(rows, m.TRIAL_PATH)
