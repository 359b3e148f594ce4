"""Closed forms of chains hold against SciPy's integration of the equations of motion."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hav_env.maths.hitched_circle import add_joint, needed_squared
from hav_env.vehicles import steady_circles


def random_chain(rng, most_units=8, reach=(-1.0, 2.0), damped=0.8):
    """Return lengths and offsets of a chain of fifth wheels, drawbars and on-axle hitches."""
    units = rng.integers(2, most_units + 1)
    lengths = rng.uniform(2.0, 8.0, units)
    offsets = np.minimum(rng.uniform(*reach, units), damped * lengths)
    offsets[rng.random(units) < 0.2] = 0.0
    offsets[0] = math.nan  # must not matter
    return lengths, offsets


def rates(headings, speed, curvature, lengths, offsets):
    """Return the yaw rates of all units, from the equations of the general n-trailer.

    The units are the first axis; chains may be side by side on a second one.
    """
    turned = [speed * curvature]
    for j in range(1, len(lengths)):
        sine, cosine = np.sin(headings[j] - headings[j - 1]), np.cos(headings[j] - headings[j - 1])
        rate = -(speed * sine + offsets[j] * turned[-1] * cosine) / lengths[j]
        speed = speed * cosine - offsets[j] * turned[-1] * sine
        turned.append(rate)
    return np.array(turned)


def positions(x, y, headings, lengths, offsets):
    """Return the axles (K, 2), from the truck's rear axle backwards."""
    found = [np.array([x, y])]
    for j in range(1, len(lengths)):
        ahead = np.array([math.cos(headings[j - 1]), math.sin(headings[j - 1])])
        along = np.array([math.cos(headings[j]), math.sin(headings[j])])
        found.append(found[-1] - offsets[j] * ahead - lengths[j] * along)
    return np.array(found)


def test_steady_radii_and_articulations_are_those_of_long_drives():
    rng = np.random.default_rng(1)
    for _ in range(60):
        lengths, offsets = random_chain(rng)
        radius = 1.15 * max(3.0, steady_circles.least_radius(lengths, offsets))

        def derivative(_, z, radius=radius, lengths=lengths, offsets=offsets):
            turned = rates(z[2:], 1.0, 1.0 / radius, lengths, offsets)
            return np.r_[math.cos(z[2]), math.sin(z[2]), turned]

        span = 0.0, 20.0 * (radius + lengths.sum())
        options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13}
        z = solve_ivp(derivative, span, np.zeros(2 + len(lengths)), **options).y[:, -1]
        axles = positions(z[0], z[1], z[2:], lengths, offsets)
        centre = axles[0] + radius * np.array([-math.sin(z[2]), math.cos(z[2])])
        radii = steady_circles.steady_radii(radius, lengths, offsets)
        assert np.linalg.norm(axles - centre, axis=1) == pytest.approx(radii, abs=1e-9)
        bends = steady_circles.steady_articulations(radius, lengths, offsets)
        assert -np.diff(z[2:]) == pytest.approx(bends, abs=1e-9)


def possible(radius, lengths, offsets, limits):
    """Tell by the triangles of hitches alone whether a chain can circle within its limits."""
    squared = radius * radius
    for length, offset, limit in zip(lengths[1:], offsets[1:], limits[1:], strict=True):
        behind = squared + offset * offset - length * length
        if behind < 0.0:
            return False
        bend = math.atan2(offset, math.sqrt(squared)) + math.atan2(length, math.sqrt(behind))
        if bend > limit:
            return False
        squared = behind
    return True


def test_the_least_radius_keeps_all_limits_and_no_smaller_one_does():
    rng = np.random.default_rng(2)
    binding = 0
    for _ in range(2000):
        lengths, offsets = random_chain(rng, 9, damped=0.9)
        limits = np.radians(rng.uniform(25.0, 130.0, len(lengths)))
        radius = steady_circles.least_radius(lengths, offsets, limits)
        assert possible(radius * (1.0 + 1e-9), lengths, offsets, limits + 1e-6)
        assert not possible(radius * (1.0 - 1e-6), lengths, offsets, limits)
        unlimited = steady_circles.least_radius(lengths, offsets)
        nowhere = np.full(len(lengths), math.pi)
        assert possible(unlimited * (1.0 + 1e-9), lengths, offsets, nowhere)
        assert not possible(unlimited * (1.0 - 1e-6), lengths, offsets, nowhere)
        assert radius >= unlimited
        binding += radius > unlimited
    assert 500 < binding < 2000


def test_on_axle_chains_have_the_papers_least_radius_to_the_bit():
    rng = np.random.default_rng(3)
    for cos_limit in (math.cos(math.pi / 2), 0.0, -0.3, -1.0):
        for _ in range(500):
            lengths = rng.uniform(2.0, 12.0, rng.integers(2, 12))
            least = lost = squares = lengths[0] * lengths[0]
            for length in lengths[1:]:
                assert needed_squared(length, 0.0, cos_limit) == length * length
                least, lost = add_joint(least, lost, length, 0.0, cos_limit)
                squares += length * length
            assert least == lost == squares


def test_the_kernels_are_the_chain_functions():
    rng = np.random.default_rng(4)
    for _ in range(200):
        lengths, offsets = random_chain(rng, 9)
        limits = np.radians(rng.uniform(25.0, 130.0, len(lengths)))
        least = lost = 0.0
        for joint in zip(lengths[1:], offsets[1:], np.cos(limits[1:]), strict=True):
            least, lost = add_joint(least, lost, *joint)
        assert math.sqrt(least) == pytest.approx(
            steady_circles.least_radius(lengths, offsets, limits), rel=1e-12
        )


def test_no_steering_passes_the_bound_and_some_comes_near():
    """Bang-bang steering at random, by the classical Runge-Kutta method."""
    rng, chains, most = np.random.default_rng(5), 150, 6
    lengths, offsets = np.full((most, chains), math.inf), np.zeros((most, chains))
    bounds, curvature = np.full((most - 1, chains), math.inf), np.empty(chains)
    for k in range(chains):
        chain = random_chain(rng, most, (-1.0, 1.5))
        units, limits = len(chain[0]), np.full(len(chain[0]), 1.5)
        lengths[:units, k], offsets[:units, k] = chain  # units beyond the last do not turn
        curvature[k] = 1.0 / (1.02 * steady_circles.least_radius_of_any_steering(*chain, limits))
        bounds[: units - 1, k] = steady_circles.articulation_bounds(curvature[k], *chain)
    headings, side, h = np.zeros((most, chains)), np.ones(chains), 0.1
    largest = np.zeros(bounds.shape)
    for _ in range(3000):
        side = np.where(rng.random(chains) < 0.02, -side, side)
        chain = 1.0, side * curvature, lengths, offsets
        k1 = rates(headings, *chain)
        k2 = rates(headings + 0.5 * h * k1, *chain)
        k3 = rates(headings + 0.5 * h * k2, *chain)
        k4 = rates(headings + h * k3, *chain)
        headings = headings + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        np.maximum(largest, np.abs(np.diff(headings, axis=0)), out=largest)
    assert np.all(largest <= bounds + 1e-6)
    assert (largest / bounds).max() > 0.99


def test_fifth_wheels_never_bend_beyond_their_steady_circle():
    rng = np.random.default_rng(6)
    for _ in range(200):
        lengths, offsets = random_chain(rng, 8, (-1.5, 0.0))
        radius = 1.1 * steady_circles.least_radius(lengths, offsets)
        bounds = steady_circles.articulation_bounds(1.0 / radius, lengths, offsets)
        bends = steady_circles.steady_articulations(radius, lengths, offsets)
        assert bounds == pytest.approx(bends, abs=1e-9)


def test_the_ring_is_that_of_points_all_over_the_bodies():
    rng = np.random.default_rng(7)
    for _ in range(50):
        lengths, offsets = random_chain(rng)
        units = len(lengths)
        half_widths, fronts, rears = rng.uniform(0.0, 1.5, (3, units))
        radius = 1.1 * max(2.0, steady_circles.least_radius(lengths, offsets))
        ring = steady_circles.swept_ring(radius, lengths, offsets, half_widths, fronts, rears)
        bends = steady_circles.steady_articulations(radius, lengths, offsets)
        headings = np.r_[0.0, -np.cumsum(bends)]
        axles = positions(0.0, 0.0, headings, lengths, offsets)
        apart = []
        for j in range(units):
            along = np.linspace(-rears[j], lengths[j] + fronts[j], 401)[:, None]
            aside = np.linspace(-half_widths[j], half_widths[j], 101)
            point = complex(*axles[j]) + (along + 1j * aside) * np.exp(1j * headings[j])
            apart.append(np.abs(point - 1j * radius))
        assert max(a.max() for a in apart) == pytest.approx(ring.outer, abs=1e-9)
        assert min(a.min() for a in apart) == pytest.approx(ring.inner, abs=0.05)
        assert min(a.min() for a in apart) >= ring.inner - 1e-9


def test_no_point_is_faster_than_the_gain_says():
    rng, nearest = np.random.default_rng(8), 0.0
    for _ in range(500):
        lengths, offsets = random_chain(rng, 5)
        half_widths, fronts, rears = rng.uniform(0.0, 2.0, (3, len(lengths)))
        shape = lengths, offsets, half_widths, fronts, rears
        gain = steady_circles.fastest_point_gain(0.2, *shape)
        for _ in range(20):
            headings = np.cumsum(rng.uniform(-math.pi, math.pi, len(lengths)))
            turned = rates(headings, 1.0, rng.choice([-0.2, 0.2]), lengths, offsets)
            start = positions(0.0, 0.0, headings, lengths, offsets)
            h = 1e-6
            truck = h * math.cos(headings[0]), h * math.sin(headings[0])
            end = positions(*truck, headings + h * turned, lengths, offsets)
            for j, (one, other) in enumerate(zip(start, end, strict=True)):
                for along in (-rears[j], lengths[j] + fronts[j]):
                    for aside in (-half_widths[j], half_widths[j]):
                        corner = (along + 1j * aside) * np.exp(1j * headings[j])
                        turned_by = np.exp(1j * h * turned[j]) - 1.0
                        moved = abs(complex(*(other - one)) + corner * turned_by) / h
                        assert moved <= gain * (1.0 + 1e-5)
                        nearest = max(nearest, moved / gain)
    assert nearest > 0.95


def test_a_circle_that_is_too_tight_is_refused_with_the_least_radius():
    lengths, offsets = (4.0, 6.0, 2.0), (0.0, 0.0, 1.0)
    with pytest.raises(ValueError, match=r"radius is 6.2 m, but must be at least 6.2449"):
        steady_circles.steady_radii(6.2, lengths, offsets)
    least = steady_circles.least_radius(lengths, offsets)
    assert steady_circles.steady_radii(least, lengths, offsets)[-1] == pytest.approx(0.0, abs=1e-5)


def test_offsets_that_amplify_are_refused():
    steady_circles.check_damped((4.0, 2.0, 2.0), (9.0, -2.0, 2.0))
    for offset in (2.1, -2.1):
        with pytest.raises(ValueError, match=r"offset of unit 2 is -?2.1 m, but must be at most"):
            steady_circles.check_damped((4.0, 2.0, 2.0), (0.0, 0.0, offset))
