"""Predictions of a lone HAV side by side equal, to the bit, those of one path at a time."""

import itertools
import math

import numpy as np
import pytest

from baselines.policies.reserve import Reserve
from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes
from baselines.policies.reserve.perception.own_state import SURELY, hits_goal
from baselines.policies.reserve.prediction.motion import advance_chain, sense_chain, turn_to
from baselines.policies.reserve.prediction.paths import heading_at, total_length
from baselines.policies.reserve.prediction.trials import (
    advance_trials,
    measure_first_turns,
    measure_last_turns,
)
from baselines.policies.reserve.single_agent import plan_alone
from baselines.policies.reserve.tight_paths import (
    AIMS,
    LAST_TURN_FACTOR,
    PER_AIM,
    list_shortest,
    write_endings,
    write_radii,
    write_tight_path,
)
from hav_env.compiled import entry
from hav_env.maths.elementary import sincos
from tests.support.budgets import budget

POLICY = Reserve()
T = sizes.TRIALS
ALL = math.inf, 1, sizes.SHORTLIST_SIZE  # candidates of any length, to all aims


def lone(seed, far=60.0, bent=0.5, bound=89.0):
    """Return the memory of a lone HAV that has sensed itself and a goal: a random one of a seed."""
    random = np.random.default_rng(seed)
    rows, trailers = np.zeros(m.ROWS), int(random.integers(1, 11))
    rows[m.OWN_TRAILERS], rows[m.OWN_STEP] = trailers, 0.2
    lengths = random.uniform(2.0, 6.0, trailers + 1)
    rows[m.OWN_LENGTHS : m.OWN_LENGTHS + trailers + 1] = lengths
    for joint, angle in enumerate(random.uniform(-bent, bent, trailers)):
        sine, cosine = sincos(angle)
        rows[m.OWN_JOINTS + 2 * joint : m.OWN_JOINTS + 2 * joint + 2] = cosine, sine
    rows[m.OWN_STEERING_TANGENT] = 1.0
    rows[m.OWN_LEAST_COSINE] = math.cos(math.radians(bound))
    rows[m.OWN_FOLD_TURN] = 2.0 * math.pi - 2.0 * math.radians(bound)
    rows[m.OWN_TRUCK_RADIUS] = lengths[0]
    rows[m.OWN_TRAILER_RADIUS] = math.sqrt((lengths[1:] ** 2).sum())
    rows[m.OWN_FOOTPRINT] = lengths[1:].sum()
    heading = random.uniform(-math.pi, math.pi)
    sine, cosine = sincos(heading)
    goal = *random.uniform(-far, far, 2), heading, cosine, sine
    rows[m.OWN_GOAL : m.OWN_GOAL + 5], rows[m.OWN_GOALS_LEFT] = goal, random.integers(1, 3)
    return rows


def chain_of(rows, lane):
    """Return the trial in a lane."""
    kept = m.TRIAL_X, m.TRIAL_Y, m.TRIAL_LEAST
    chain = rows[m.TRIAL_CHAINS : m.TRIAL_CHAINS + 2 * sizes.MAX_UNITS * T].reshape(-1, T)
    units = int(rows[m.OWN_TRAILERS]) + 1
    return [*(rows[row + lane] for row in kept), *chain[: 2 * units, lane]]


def fill(rows, random):
    """Fill all lanes with random chains."""
    for unit in range(sizes.MAX_UNITS):
        angle = random.uniform(-3.0, 3.0, T)
        first = m.TRIAL_CHAINS + 2 * T * unit
        rows[first : first + T], rows[first + T : first + 2 * T] = np.cos(angle), np.sin(angle)
    rows[m.TRIAL_X : m.TRIAL_X + T], rows[m.TRIAL_Y : m.TRIAL_Y + T] = random.normal(size=(2, T))


@entry
def advance_rows(first, last, memories, turns, distance):
    """Advance the trials of several HAVs, (H, ROWS), by a turn of each lane, (H, T)."""
    for hav in range(first, last):
        for lane in range(turns.shape[1]):
            memories[hav, m.TRIAL_TURN + lane] = turns[hav, lane]
        advance_trials(memories[hav], distance)


@pytest.mark.parametrize("bound", [20.0, 89.0, 150.0])
def test_a_lane_is_predicted_as_one_chain_alone(bound):
    random, havs = np.random.default_rng(3), budget(40, 3)
    memories = np.array([lone(seed, bound=bound) for seed in range(havs)])
    turns = random.uniform(-1.0, 1.0, (havs, T))
    distance = random.uniform(0.1, 3.0)
    for rows in memories:
        fill(rows, random)
    expected = []
    for rows, lane in itertools.product(memories, range(T)):
        x, y, _, *chain = chain_of(rows, lane)
        alone = np.zeros(m.ROWS)
        alone[: m.PREDICTED_CHAIN] = rows[: m.PREDICTED_CHAIN]
        alone[m.PREDICTED_CHAIN : m.PREDICTED_CHAIN + len(chain)] = chain
        turn = turns[len(expected) // T, lane]
        place = advance_chain(alone, x, y, turn, distance)
        after = alone[m.PREDICTED_CHAIN : m.PREDICTED_CHAIN + len(chain)]
        expected.append([*place, *after])
    advance_rows(havs, memories, turns, distance, threads=1)
    found = [chain_of(rows, lane) for rows, lane in itertools.product(memories, range(T))]
    assert found == expected


def test_no_lane_looks_at_another():
    random = np.random.default_rng(4)
    rows = lone(1)
    fill(rows, random)
    memories, turns = np.array([rows] * (T + 1)), np.full((T + 1, T), 0.1)
    for lane in range(T):  # in memory ``lane``, all other lanes hold no numbers
        others = memories[lane, m.TRIAL_TURN : m.ROWS][: m.TRIAL_CHAINS - m.TRIAL_TURN]
        others.reshape(-1, T)[:, np.arange(T) != lane] = np.nan
        chains = memories[lane, m.TRIAL_CHAINS :][: 2 * sizes.MAX_UNITS * T].reshape(-1, T)
        chains[:, np.arange(T) != lane] = np.nan
        turns[lane, np.arange(T) != lane] = np.nan
    advance_rows(T + 1, memories, turns, 0.2, threads=1)
    for lane in range(T):
        assert chain_of(memories[lane], lane) == chain_of(memories[T], lane)


def longest_turn(rows, side, radius):
    """Return the longest turn [rad] of ``PREDICTED_CHAIN``, in rough steps of one chain alone."""
    turned, step = 0.0, 2.0 * rows[m.OWN_STEP]
    while turned < 2.0 * math.pi:
        *_, least = advance_chain(rows, 0.0, 0.0, side * step / radius, step)
        if least < rows[m.OWN_LEAST_COSINE]:
            break
        turned += step / radius
    return turned


@pytest.mark.parametrize("seed", range(budget(4, 1)))
def test_longest_turns_are_those_of_one_chain_alone(seed):
    rows = lone(seed)
    write_radii(rows)
    measure_first_turns(rows)
    measure_last_turns(rows)
    for first, side, bent in (
        (m.FIRST_TURNS_LEFT, 1.0, True),
        (m.FIRST_TURNS_RIGHT, -1.0, True),
        (m.LAST_TURNS, 1.0, False),
        (m.LAST_TURNS, -1.0, False),
    ):
        for number in range(sizes.TURN_RADII):
            alone = rows.copy()
            sense_chain(alone)
            if not bent:
                straight = np.arange(2 * sizes.MAX_UNITS) % 2 == 0
                alone[m.PREDICTED_CHAIN : m.PREDICTED_CHAIN + 2 * sizes.MAX_UNITS] = straight
            turn = longest_turn(alone, side, rows[m.RADII + number])
            assert turn == rows[first + number]


def all_candidates(rows):
    """Return (length, number) of all candidates whose arcs the chain can follow, sorted."""
    found, tangents = [], PER_AIM - 2 * sizes.TURN_RADII
    for number in range(AIMS * PER_AIM):
        write_tight_path(POLICY, rows, number, m.CURRENT_PATH)
        path = rows[m.CURRENT_PATH : m.CURRENT_PATH + m.LENGTHS + sizes.MAX_SEGMENTS]
        count = int(path[m.NUM_SEGMENTS])
        lengths = path[m.LENGTHS : m.LENGTHS + count]
        if not np.isfinite(lengths).all():
            continue
        if number % PER_AIM < tangents:
            first, last = divmod(number % PER_AIM // 4, sizes.TURN_RADII)
            sides = number % 4
            turns = m.FIRST_TURNS_LEFT if sides < 2 else m.FIRST_TURNS_RIGHT
            a, b = rows[m.RADII + first], rows[m.RADII + last]
            start, end = (1.0 if sides < 2 else -1.0) / a, (1.0 if sides % 2 == 0 else -1.0) / b
            curvatures = path[m.CURVATURES : m.CURVATURES + count]
            if curvatures[0] == start and lengths[0] > rows[turns + first] * a:
                continue
            if curvatures[-1] == end and lengths[-1] > 1.1 * rows[m.LAST_TURNS + last] * b:
                continue
        found.append((total_length(rows, m.CURRENT_PATH), number))
    return sorted(found)


@pytest.mark.parametrize("seed", range(budget(2, 1)))
def test_the_list_holds_the_shortest_candidates_in_order(seed):
    rows = lone(seed)
    write_radii(rows)
    measure_first_turns(rows)
    measure_last_turns(rows)
    write_endings(rows, LAST_TURN_FACTOR)
    expected, beyond, listed = all_candidates(rows), -1.0, []
    for _ in range(3):
        count = list_shortest(POLICY, rows, beyond, *ALL)
        numbers = rows[m.LISTED_NUMBERS : m.LISTED_NUMBERS + count].astype(int)
        listed += zip(rows[m.LISTED_LENGTHS : m.LISTED_LENGTHS + count], numbers, strict=True)
        beyond = rows[m.LISTED_LENGTHS + count - 1]
    assert listed == expected[: 3 * sizes.SHORTLIST_SIZE]


def survives(rows):
    """Return whether ``CURRENT_PATH`` survives, step by step of one chain alone."""
    goal_x, goal_y, goal_heading = rows[m.OWN_GOAL : m.OWN_GOAL + 3]
    bound, distance = rows[m.OWN_LEAST_COSINE], rows[m.OWN_STEP]
    sense_chain(rows)
    x, y, heading, driven, total = 0.0, 0.0, 0.0, 0.0, total_length(rows, m.CURRENT_PATH)
    hit = False
    while not hit:
        if driven > total:
            return False
        wanted = heading_at(rows, m.CURRENT_PATH, driven + 0.5 * distance)
        turn = turn_to(rows, wanted, heading, distance)
        x, y, least = advance_chain(rows, x, y, turn, distance)
        if least < bound:
            return False
        heading, driven = heading + turn, driven + distance
        hit = hits_goal(POLICY, goal_x - x, goal_y - y, goal_heading - heading, SURELY)
    if rows[m.OWN_GOALS_LEFT] == 1:
        return True
    driven = 0.0
    while driven < 2.0 * rows[m.OWN_FOOTPRINT]:
        x, y, least = advance_chain(rows, x, y, 0.0, distance)
        if least < bound:
            return False
        driven += distance
    return True


def plan_one_by_one(rows, shortlists):
    """Plan as ``plan_alone`` does, with one candidate after another."""
    write_radii(rows)
    measure_first_turns(rows)
    measure_last_turns(rows)
    write_endings(rows, LAST_TURN_FACTOR)
    beyond = -1.0
    for _ in range(shortlists):
        count = list_shortest(POLICY, rows, beyond, *ALL)
        for k in range(count):
            beyond = rows[m.LISTED_LENGTHS + k]
            write_tight_path(POLICY, rows, int(rows[m.LISTED_NUMBERS + k]), m.CURRENT_PATH)
            if survives(rows):
                return True
        if count < sizes.SHORTLIST_SIZE:
            break
    rows[m.CURRENT_PATH + m.NUM_SEGMENTS] = 0.0
    return False


@entry
def plan_rows(first, last, policy, memories, found):
    """Plan for several HAVs, (H, ROWS), and write which of them found a path, (H,)."""
    for hav in range(first, last):
        found[hav] = plan_alone(policy, memories[hav])


def path_of(rows):
    """Return the segments of ``CURRENT_PATH``."""
    path, count = rows[m.CURRENT_PATH :], int(rows[m.CURRENT_PATH + m.NUM_SEGMENTS])
    return [*path[m.CURVATURES :][:count], *path[m.LENGTHS :][:count]]


@pytest.mark.parametrize(("far", "bound"), [(60.0, 89.0), (15.0, 50.0)])
@pytest.mark.exhaustive
def test_the_first_survivor_of_the_list_is_chosen(far, bound):
    havs, shortlists = budget(3, 1), budget(2, 1)
    memories = np.array([lone(seed, far, bound=bound) for seed in range(havs)])
    expected = memories.copy()
    paths = [(plan_one_by_one(rows, shortlists), path_of(rows)) for rows in expected]
    found = np.zeros(havs)
    plan_rows(havs, Reserve(shortlists=shortlists), memories, found, threads=1)
    assert [(found[k] > 0.0, path_of(memories[k])) for k in range(havs)] == paths
    assert budget(any(survived for survived, _ in paths), True)
