"""Evasion may start, aim and be clipped otherwise: the sum is that of vectors in the plane."""

import itertools
import math

import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from hav_env import Task
from hav_env.evaluation.rollout import rollout
from hav_env.policies.interface import allocate_memory, decide, evaded
from tests.support.budgets import budget
from tests.support.worlds import aim, limit, open_plane, put, stand, wrapped

STEEPEST = math.radians(50.0)
AHEAD = 1e6  # m, distance of the goal, straight ahead: its attraction is along the truck
CENTERS = [0.0, 0.3, 0.5, 1.0]
TRUCK_SHARES = [0.0, 0.5, 2.0]
POLICIES = [
    AvoidJack(
        evasion_center=center,
        evasion_truck_share=share,
        evasion_from_center=aside,
        evasion_clipped=clipped,
        keep_first=keep_first,
    )
    for (center, share, aside, clipped), keep_first in zip(
        itertools.product(CENTERS, TRUCK_SHARES, [False, True], [False, True]),
        itertools.cycle([False, True, True]),
        strict=False,
    )
]


def named(policy):
    center, share = policy.evasion_center, policy.evasion_truck_share
    words = ["from center"] * policy.evasion_from_center + ["clipped"] * policy.evasion_clipped
    return " ".join([f"{center:g} {share:g}", *words])


def point(hav, share):
    """Return the point (complex) a share of the truck's length ahead of its rear axle."""
    lengths, x, y, headings = hav
    return complex(x, y) + share * lengths[0] * np.exp(1j * headings[0])


def starts_at(policy, one, other):
    """Return the distance [m] below which HAVs evade each other."""
    trucks = one[0][0] + other[0][0]
    return sum(one[0][1:]) + sum(other[0][1:]) + policy.evasion_truck_share * trucks


def expected_steering(policy, havs, agent):
    """Return the steering [rad] that the equations give, and the number of the HAV evaded."""
    own = havs[agent]
    headings = np.asarray(own[3])
    depths = {
        k: starts_at(policy, own, other)
        - abs(point(own, policy.evasion_center) - point(other, policy.evasion_center))
        for k, other in enumerate(havs)
        if k != agent
    }
    whom = max(depths, key=depths.get)
    if depths[whom] < 0.0:
        whom, attraction = -1, np.exp(1j * headings[0])  # the goal is straight ahead
    else:
        share = policy.evasion_center if policy.evasion_from_center else 0.0
        away = point(own, share) - point(havs[whom], share)
        direction = wrapped(np.angle(away) - headings[0])
        if policy.evasion_clipped:
            direction = np.clip(direction, -STEEPEST, STEEPEST)
        attraction = np.exp(1j * (headings[0] + direction))
    weights = 1.0 + np.tanh(policy.b - policy.c * np.cos(np.diff(headings)))
    total = attraction + weights.sum() * np.exp(1j * headings[1])
    return np.clip(wrapped(np.angle(total) - headings[0]), -STEEPEST, STEEPEST), whom


def scenes(worlds):
    """Return a batch in which HAVs (lengths, x, y, headings) stand and are about to decide."""
    batch = open_plane(len(worlds), len(worlds[0]), 4, task=Task(sensing_range=100.0))
    limit(batch.worlds, steering=STEEPEST)
    for w, havs in enumerate(worlds):
        for agent, hav in enumerate(havs):
            put(batch.worlds, *hav, w=w, agent=agent)
            goal = point(hav, AHEAD / hav[0][0])
            aim(batch.worlds, agent, w, goal.real, goal.imag, hav[3][0])
    batch.worlds.state.waiting[:] = True
    stand(batch)  # finds the neighbours
    batch.worlds.state.waiting[:] = False
    return batch


def decided(policy, worlds):
    """Return steering [rad] and the HAVs evaded, (N, W) each, of HAVs without memories."""
    batch = scenes(worlds)
    memory = allocate_memory(policy, len(worlds[0]), len(worlds))
    _, steering = decide(policy, memory, batch)
    whom = [[evaded(policy, memory, n, w) for w in range(len(worlds))] for n in range(len(memory))]
    return steering, np.array(whom)


def compare(policy, worlds):
    """Compare all decisions with the equations; return the evaded HAVs (N, W)."""
    steering, found = decided(policy, worlds)
    for w, havs in enumerate(worlds):
        for agent in range(len(havs)):
            wanted, whom = expected_steering(policy, havs, agent)
            assert found[agent, w] == whom
            assert steering[agent, w] == pytest.approx(wanted, abs=1e-7)
    return found


def any_hav(rng, x, y):
    lengths = rng.uniform(2, 12, rng.integers(2, 6))
    bends = np.r_[rng.uniform(-4, 4), rng.uniform(-1.4, 1.4, len(lengths) - 1)]
    return lengths, x, y, bends.cumsum()


def two_havs(rng, policy, distance):
    """Return two random HAVs so far [m] from where one begins to evade the other."""
    one, other = any_hav(rng, *rng.uniform(-50, 50, 2)), any_hav(rng, 0.0, 0.0)
    gap = starts_at(policy, one, other) + distance
    place = point(one, policy.evasion_center) + gap * np.exp(1j * rng.uniform(0, 7))
    place -= point(other, policy.evasion_center)
    return one, (other[0], place.real, place.imag, other[3])


@pytest.mark.parametrize("policy", POLICIES, ids=named)
def test_the_steering_of_random_pairs_is_that_of_the_equations(policy):
    rng = np.random.default_rng(5)
    depths = rng.uniform(-12.0, 6.0, budget(100, 4))
    found = compare(policy, [two_havs(rng, policy, depth) for depth in depths])
    assert (found[0] >= 0).tolist() == (found[1] >= 0).tolist() == (depths < 0.0).tolist()


@pytest.mark.parametrize("policy", POLICIES[3::5], ids=named)
def test_of_three_havs_the_one_entered_deepest_is_evaded(policy):
    rng, worlds = np.random.default_rng(6), []
    for _ in range(budget(100, 5)):
        worlds.append([any_hav(rng, *rng.uniform(-25, 25, 2)) for _ in range(3)])
    found = compare(policy, worlds)
    assert len(np.unique(found[0])) > 1


@pytest.mark.parametrize("policy", POLICIES, ids=named)
def test_evasion_starts_where_these_points_are_this_near(policy):
    rng = np.random.default_rng(7)
    for distance in (-1e-6, 1e-6):
        worlds = [two_havs(rng, policy, distance) for _ in range(budget(20, 2))]
        assert ((compare(policy, worlds) >= 0) == (distance < 0.0)).all()


@pytest.mark.parametrize("from_center", [False, True])
@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("past", [-1e-6, 1e-6])
def test_the_direction_is_cut_where_the_wheels_cannot_follow(side, past, from_center):
    """The other is behind, so the direction away from it is near the steering limit."""
    policy = AvoidJack(evasion_clipped=True, evasion_center=0.5, evasion_from_center=from_center)
    one = [6.0, 4.0, 5.0], 0.0, 0.0, np.zeros(3)
    share = 0.5 if from_center else 0.0
    away = side * (STEEPEST + past)
    place = point(one, share) - 8.0 * np.exp(1j * away) - share * 4.0
    worlds = [[one, ([4.0, 7.0], place.real, place.imag, np.zeros(2))]]
    compare(policy, worlds)
    (cut,), (whole,) = (
        decided(policy._replace(evasion_clipped=clipped), worlds)[0][0] for clipped in (True, False)
    )
    assert (cut == pytest.approx(whole, abs=1e-8)) == (past < 0.0)
    assert abs(cut) <= abs(whole)
    assert np.sign(cut) == side


@pytest.mark.parametrize("from_center", [False, True])
@pytest.mark.parametrize("clipped", [False, True])
def test_at_the_same_place_every_decision_is_a_number(clipped, from_center):
    policy = AvoidJack(evasion_clipped=clipped, evasion_from_center=from_center, evasion_center=0.5)
    one, turned = ([3.0, 4.0, 5.0], 2.0, 1.0, np.zeros(3)), ([3.0, 6.0], 2.0, 1.0, np.full(2, 1.3))
    bent = [6.0, 3.0, 7.0], 2.0, 1.0, np.array([0.4, -0.3, 0.2])
    for other in (one, turned, bent):
        steering, found = decided(policy, [[one, other], [other, one]])
        assert np.isfinite(steering).all()
        assert (np.abs(steering) <= STEEPEST).all()
        assert (found >= 0).all()


@pytest.mark.parametrize(("left", "side"), [(-1e-9, 1), (0.0, 1), (1e-9, -1)])
def test_who_has_to_turn_back_uncut_turns_to_the_nearer_side_or_left(left, side):
    one, other = ([3.0, 4.0, 5.0], 0.0, 0.0, np.zeros(3)), ([3.0, 6.0], 10.0, left, np.zeros(2))
    assert decided(AvoidJack(), [[one, other]])[0][0, 0] == pytest.approx(side * STEEPEST)


@pytest.mark.parametrize("from_center", [False, True])
@pytest.mark.parametrize(("left", "side"), [(-1e-9, 1), (0.0, 1), (1e-9, -1)])
def test_who_has_to_turn_back_turns_to_the_nearer_side_or_left(left, side, from_center):
    """The other is ahead. If it is so exactly, the way from it is half a turn, pi and not -pi."""
    policy = AvoidJack(evasion_clipped=True, evasion_from_center=from_center, evasion_center=0.5)
    one, other = ([3.0, 4.0, 5.0], 0.0, 0.0, np.zeros(3)), ([3.0, 6.0], 10.0, left, np.zeros(2))
    steering, found = decided(policy, [[one, other]])
    weight = 2.0 * (1.0 + math.tanh(0.5 - 2.0))
    x, y = math.cos(STEEPEST) + weight, math.sin(STEEPEST)
    assert found[0, 0] == 1
    assert steering[0, 0] == pytest.approx(side * math.atan2(y, x), abs=1e-7)


def test_circles_round_the_centres_of_trucks_may_hold_the_whole_havs():
    """With half of each truck in the distance, HAVs whose circles touch evade each other."""
    policy = AvoidJack(evasion_center=0.5, evasion_truck_share=0.5)
    one = [6.0, 4.0], 0.0, 0.0, np.zeros(2)
    for gap in (3.0 + 4.0 + 2.0 + 5.0 - 1e-6, 3.0 + 4.0 + 2.0 + 5.0 + 1e-6):
        facing = [4.0, 5.0], 3.0 + gap + 2.0, 0.0, np.full(2, math.pi)  # centre at 3 + gap
        _, found = decided(policy, [[one, facing]])
        assert (found[:, 0] >= 0).all() == (gap < 14.0)


@pytest.mark.parametrize(("field", "value"), [("evasion_center", -0.1), ("evasion_center", 1.1)])
def test_a_parameter_out_of_range_is_named(field, value):
    with pytest.raises(ValueError, match=f"{field} is {value}"):
        rollout(AvoidJack(**{field: value}), "paper-pair", 0, np.arange(1))
