"""HAVs that the turns left find safe straighten without a jackknife, by brute force."""

import math

import numpy as np
import pytest

from hav_env import OnAxle
from hav_env.compiled import canonical, entry
from hav_env.safety.filters import SafetyFilter
from hav_env.safety.straightening import bound_backup
from hav_env.safety.trial_moves import IN_DOUBT, count_rows
from hav_env.safety.turns_left import bend_on, bound_bend, inverse_tangent, settle_by_turns
from hav_env.world.lanes import block_of
from tests.safety.test_straightening import bent, straighten
from tests.support.budgets import budget

_HORIZON = 1_000


@entry
def _examine_all(first, last, safety, vehicle, dt, worlds, rows, counts):
    block = block_of(worlds, first, last - first, worlds.units)
    bound_backup(dt, block, 0, rows)
    for lane in range(block.lanes):
        counts[0] += rows[IN_DOUBT, lane] != 0.0
    joints = worlds.fleet.joints
    counts[1] += settle_by_turns(joints, safety, vehicle, dt, block, 0, rows)


def examine(worlds, vehicle=OnAxle(), horizon=_HORIZON):
    """Return doubts (W,) that remain, and the number of doubts before and of those settled."""
    worlds.state.waiting[:], worlds.state.speed[:] = False, 1.0
    rows, counts = np.zeros((count_rows(worlds.units), worlds.lanes)), np.zeros(2, np.int64)
    models = canonical(SafetyFilter(horizon=horizon)), canonical(vehicle), 0.2
    _examine_all(worlds.lanes, *models, worlds, rows, counts, threads=1)
    return rows[IN_DOUBT] != 0.0, *counts


@pytest.mark.parametrize(("limit", "seed"), [(math.pi / 2, 41), (1.1, 42), (2.0, 43)])
def test_joints_keep_their_limits_until_the_hav_is_straight_within_the_horizon(limit, seed):
    worlds = bent(budget(30_000, 300), 1.5, seed, limit)
    doubts, before, settled = examine(worlds)
    assert np.count_nonzero(doubts) == before - settled
    assert 0.02 * before < settled < 0.9 * before
    full = straighten(worlds, _HORIZON, lambda step: np.ones(worlds.lanes))
    assert (full[~doubts] < min(limit, math.pi / 2)).all()
    assert (full[doubts] >= limit).any()  # the bound separates
    spread = np.ptp(final_headings(worlds, _HORIZON - 1), axis=0)
    assert (spread[~doubts] < min(limit, math.pi / 2) - 1e-6).all()


def test_no_joint_bends_beyond_its_own_bound():
    """The limit hides how near a bound is; each joint is compared with the bound of that joint."""
    worlds = bent(budget(3_000, 100), 1.5, 46)
    bends = np.abs(np.diff(worlds.state.heading[0], axis=0))
    bounds = np.full(bends.shape, math.inf)
    largest = 0.5 * math.pi - 1e-3
    for lane in range(worlds.lanes):
        turn, curvature, length_ahead, bend_ahead = 0.0, 0.0, 1.0, 0.0
        for joint in range(worlds.fleet.num_trailers[0, lane]):
            bend, length = bends[joint, lane], worlds.fleet.length[0, joint + 1, lane]
            before = turn, curvature, length_ahead, bend_ahead
            limit = largest, math.sin(largest)
            held, curvature, bend_ahead, half = bound_bend(bend, length, 0.2, *before, *limit)
            if not held:
                break
            bounds[joint, lane] = 2.0 * math.atan(half)
            turn, length_ahead = turn + bend, length
    reached = np.zeros(bends.shape)
    final_headings(worlds, _HORIZON, reached)
    rising = np.isfinite(bounds) & (reached > bends + 1e-3)
    assert (reached <= bounds + 1e-9)[np.isfinite(bounds)].all()
    assert np.count_nonzero(rising) > 0.02 * bounds.size
    assert ((bounds - reached)[rising] < 0.3).any()


def final_headings(worlds, steps, reached=None):
    """Return the headings (U, W) [rad] after steps at full speed, of units that exist.

    ``reached`` (U - 1, W) gets the largest articulations on the way.
    """
    theta, length = worlds.state.heading[0].copy(), worlds.fleet.length[0]
    count = worlds.fleet.num_trailers[0]
    for _ in range(steps):
        way = np.full(worlds.lanes, 0.2)
        for unit in range(1, theta.shape[0]):
            turn = way / length[unit] * np.sin(theta[unit - 1] - theta[unit])
            theta[unit] += np.where(unit <= count, turn, 0.0)
            way = way * np.cos(theta[unit] - theta[unit - 1])
            if reached is not None:
                bend = np.where(unit <= count, np.abs(theta[unit] - theta[unit - 1]), 0.0)
                np.maximum(reached[unit - 1], bend, out=reached[unit - 1])
    for unit in range(1, theta.shape[0]):
        theta[unit] = np.where(unit <= count, theta[unit], theta[0])
    return theta


def test_most_doubts_about_long_tight_curves_are_settled():
    worlds = bent(budget(2_000, 60), 0.0, 44)
    rng = np.random.default_rng(44)
    bends = rng.uniform(0.3, 0.75, worlds.state.heading[0].shape)
    bends[0] = 0.0
    worlds.state.heading[0] = np.cumsum(bends, axis=0)
    worlds.state.cosine[:] = np.cos(worlds.state.heading)
    worlds.state.sine[:] = np.sin(worlds.state.heading)
    _, before, settled = examine(worlds)
    assert before > 0.2 * worlds.lanes
    assert settled > 0.5 * before


def test_no_doubt_is_settled_where_the_proof_does_not_hold():
    def settled(vehicle=OnAxle(), horizon=_HORIZON, limit=math.pi / 2):
        return examine(bent(budget(600, 60), 1.0, 45, limit), vehicle, horizon)[2]

    assert settled() > 0
    assert settled(OnAxle(simultaneous=True)) == 0
    assert settled(OnAxle(substeps=2)) == 0
    assert settled(horizon=10) == 0
    assert settled(limit=0.9) == 0


def test_polynomials_of_the_turns_left_are_on_the_safe_side():
    for angle in np.linspace(1e-6, 1.5, 400):
        assert bend_on(angle, 1.0, 1.0) >= angle + 1.0 - math.sin(angle) - 1e-15
        assert inverse_tangent(angle, 1.0) <= (1.0 + 1e-12) / math.tan(angle)
    assert bend_on(0.5 * math.pi, 1.0, 1.0) >= 0.5 * math.pi
    assert inverse_tangent(1.0, 1.0) > 0.99 / math.tan(1.0)
