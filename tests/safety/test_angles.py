"""Bounds at which each trailer is a step behind the one ahead hold at all later steps."""

import math

import numpy as np

from tests.support.budgets import budget

_STEP = 0.2  # of the truck [m]


def backup(heading, length, steps):
    """Return headings (steps + 1, units, count) while the truck drives straight on."""
    driven = [heading]
    for _ in range(steps):
        after, way = driven[-1].copy(), np.full(heading.shape[1], _STEP)
        for unit in range(1, len(after)):
            after[unit] += way / length[unit] * np.sin(after[unit - 1] - after[unit])
            way = way * np.cos(after[unit - 1] - after[unit])
        driven.append(after)
    return np.array(driven)


def cascade(angle, length):
    """Return whether the cascade holds, and its bounds on the bends (joints, count)."""
    curvature, held, bounds = np.zeros(angle.shape[1]), np.ones(angle.shape[1], bool), []
    for bend, behind in zip(angle, length[1:], strict=True):
        sine = np.maximum(abs(np.sin(bend)), behind * curvature)
        cosine = np.sqrt(np.maximum(1.0 - sine * sine, 0.0))
        held &= (np.cos(bend) > 0.0) & (cosine > 1e-6) & (cosine >= curvature * _STEP)
        curvature = (sine / np.maximum(cosine, 1e-9) + curvature * _STEP) / behind
        bounds.append(np.arcsin(np.minimum(sine, 1.0)))
    return held, np.array(bounds)


def test_bounds_on_trailers_a_step_behind_the_one_ahead_hold_from_there_on():
    rng, units, count, waves = np.random.default_rng(51), 6, budget(40_000, 4_000), 9
    length = rng.uniform(1.0, 6.0, (units, count))
    bends = rng.uniform(-1.0, 1.0, (units, count)) * rng.uniform(0.2, 1.7, count)
    path = backup(np.cumsum(bends, axis=0), length, 300)
    heading = np.array([path[waves - unit, unit] for unit in range(units)])
    held, bounds = cascade(np.diff(heading, axis=0), length)
    allowed = True  # no unit ahead of a trailer may have driven backwards in its last step
    for unit in range(1, units):
        bent = path[waves - unit, unit] - path[waves - unit, unit - 1]
        allowed = allowed & (abs(bent) < math.pi / 2)
    certain = held & allowed
    assert 0.05 < certain.mean() < 0.95
    for joint in range(units - 1):
        later = abs(np.diff(path[waves - joint :], axis=1)[:, joint, certain])
        assert (later <= bounds[joint, certain] + 1e-9).all()
    usual, least = cascade(np.diff(path[waves], axis=0), length)
    assert usual[certain].all()
    assert (least[:, certain] <= bounds[:, certain] + 1e-9).all()
