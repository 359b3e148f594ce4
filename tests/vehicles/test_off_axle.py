"""Chains with off-axle hitches move by the equations of the general n-trailer."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hav_env import Batch, OffAxle, OnAxle, RandomFleet, RandomPoses, Rectangles, Task
from hav_env.vehicles.off_axle import turn_direction
from hav_env.world.arrays import ARTICULATION, JACKKNIFE, STABLE, WHEN, WHERE, derive_radii
from tests.support.budgets import budget
from tests.support.worlds import bits, hitch, limit, open_plane, put

BODIES = Rectangles()  # as most tests of such hitches have
RNG = np.random.default_rng(4)
TRAILERS = budget((1, 2, 3, 5, 7, 10), (1, 4))
LENGTHS = {n: RNG.uniform(2.5, 9.0, n + 1) for n in TRAILERS}
OFFSETS = {n: RNG.uniform(-0.6, 0.6, n) * LENGTHS[n][1:] for n in TRAILERS}  # c_1 .. c_n
MINUTE = 300  # steps of 0.2 s
# turns of 6 s on radii of 14 m and more, as a driver would make
CURVATURES = RNG.uniform(-1 / 14, 1 / 14, MINUTE // 30)


def derivative(_, z, lengths, offsets, speed, steering):
    """Equations of the general n-trailer, written unit by unit."""
    headings, rate = z[2:], speed / lengths[0] * np.tan(steering)
    rates = [speed * np.cos(headings[0]), speed * np.sin(headings[0]), rate]
    for j in range(1, len(lengths)):
        bend, c = headings[j] - headings[j - 1], offsets[j - 1]
        following = speed * np.cos(bend) - c * rate * np.sin(bend)
        rate = -(speed * np.sin(bend) + c * rate * np.cos(bend)) / lengths[j]
        speed = following
        rates.append(rate)
    return rates


def points(z, lengths, offsets):
    """Return the axles and hitches of a chain, (2 N + 1, 2), given x, y and headings."""
    place, found = z[:2], [z[:2]]
    ways = np.stack([np.cos(z[2:]), np.sin(z[2:])], axis=1)
    for j in range(1, len(lengths)):
        hitched = place - offsets[j - 1] * ways[j - 1]
        place = hitched - lengths[j] * ways[j]
        found += [hitched, place]
    return np.array(found)


def exact(n, speed):
    """Return the state of chain n after a minute, integrated by SciPy."""
    z = np.zeros(n + 3)
    for curvature in CURVATURES:
        steering = np.arctan(curvature * LENGTHS[n][0])
        options = {"rtol": 1e-11, "atol": 1e-12, "method": "DOP853"}
        args = LENGTHS[n], OFFSETS[n], speed, steering
        z = solve_ivp(derivative, (0.0, 6.0), z, args=args, **options).y[:, -1]
    return z


def simulated(vehicle, speed, dt=0.2):
    """Return the states of all chains after the same minute, in the order of ``TRAILERS``."""
    batch = open_plane(len(TRAILERS), 1, max(TRAILERS), task=Task(dt=dt), vehicle=vehicle)
    limit(batch.worlds, speed=10.0, steering=1.4)
    for w, n in enumerate(TRAILERS):
        put(batch.worlds, LENGTHS[n], w=w)
        hitch(batch.worlds, OFFSETS[n], w=w)
    trucks = np.array([LENGTHS[n][0] for n in TRAILERS])
    for curvature in CURVATURES:
        steering = np.arctan(curvature * trucks)[None]
        for _ in range(round(6.0 / dt)):
            batch.step(np.full((1, len(TRAILERS)), speed), steering)
    state = batch.worlds.state
    z = np.concatenate([[state.x[0], state.y[0]], state.heading[0]])
    return [z[: n + 3, w] for w, n in enumerate(TRAILERS)]


def errors(vehicle, speed, dt=0.2):
    """Return the distance of the farthest axle or hitch of each chain from its place [m]."""
    return np.array(
        [
            np.hypot(
                *(points(z, LENGTHS[n], OFFSETS[n]) - points(end, LENGTHS[n], OFFSETS[n])).T
            ).max()
            for n, z, end in zip(
                TRAILERS,
                simulated(vehicle, speed, dt),
                (exact(n, speed) for n in TRAILERS),
                strict=True,
            )
        ]
    )


@pytest.mark.parametrize(("speed", "most"), [(1.0, 0.005), (5.0, 0.05)])
def test_a_minute_of_steps_ends_where_scipy_ends(speed, most):
    assert errors(OffAxle(bodies=BODIES), speed).max() <= most


@pytest.mark.parametrize(("integrator", "order"), [("midpoint", 2), ("euler", 1)])
def test_the_order_of_the_integrator(integrator, order):
    coarse, fine = (
        errors(OffAxle(integrator=integrator, bodies=BODIES), 2.0, dt) for dt in (0.2, 0.1)
    )
    ratio = coarse / fine
    assert (ratio > 0.85 * 2**order).all(), ratio
    assert (ratio < 1.2 * 2**order).all(), ratio


def test_substeps_are_shorter_steps():
    one = simulated(OffAxle(substeps=2, bodies=BODIES), 2.0)
    two = simulated(OffAxle(bodies=BODIES), 2.0, dt=0.1)
    for z, other in zip(one, two, strict=True):
        np.testing.assert_allclose(z, other, atol=1e-9)


@pytest.mark.exhaustive
def test_hitches_on_the_axles_in_eulers_order_give_the_bits_of_the_paper():
    scenario = RandomPoses(num_havs=2)
    rng, batches = np.random.default_rng(1), []
    for vehicle in (OnAxle(), OffAxle(integrator="euler")):
        batches.append(Batch(scenario, 3, vehicle=vehicle))
        batches[-1].reset(7)
    for _ in range(budget(2_000, 100)):
        speed, steering = rng.uniform(0, 1, (2, 3)), rng.uniform(-0.7, 0.7, (2, 3))
        for batch in batches:
            batch.step(speed, steering)
    on_axle, off_axle = (batch.worlds for batch in batches)
    plain = off_axle._replace(  # without hitches and scratch
        state=off_axle.state._replace(ahead=on_axle.state.ahead),
        fleet=off_axle.fleet._replace(joints=on_axle.fleet.joints),
    )
    for w in range(3):
        assert bits(on_axle, w) == bits(plain, w)


def test_a_turned_direction_is_a_direction_and_the_right_one():
    for angle in np.linspace(-0.4, 0.4, 81):
        turned = turn_direction(math.cos(0.3), math.sin(0.3), angle)
        assert math.hypot(*turned) == pytest.approx(1.0, abs=1e-14)
        error = math.remainder(math.atan2(turned[1], turned[0]) - 0.3 - angle, 2 * math.pi)
        assert abs(error) <= abs(angle) ** 5 / 120 * 1.05 + 1e-15
    for angle in (-1e6, -3.0, 2.0, 50.0):
        assert math.hypot(*turn_direction(1.0, 0.0, angle)) == pytest.approx(1.0)


def circle(lengths, offsets, radius):
    """Return articulations on the steady circle of the truck's rear axle, NaN where none is."""
    bends = []
    for length, c in zip(lengths[1:], offsets, strict=True):
        squared = radius * radius + c * c - length * length
        if not squared >= 0:  # nor is there a circle for the units behind
            return np.array([*bends, *[math.nan] * (len(offsets) - len(bends))])
        bends.append(math.atan2(c, radius) + math.atan2(length, math.sqrt(squared)))
        radius = math.sqrt(squared)
    return np.array(bends)


def test_least_radius_is_the_tightest_circle_within_the_limits():
    """Also on hitches ahead of axles, and with limits that bind and limits that do not."""
    rng, count = np.random.default_rng(6), budget(2_000, 200)
    batch = open_plane(1, 1, 10, vehicle=OffAxle(bodies=BODIES))
    bound = 0
    for _ in range(count):
        n = rng.integers(1, 11)
        lengths = rng.uniform(1.0, 12.0, n + 1)
        offsets = rng.uniform(-1.0, 1.0, n) * lengths[1:] * rng.integers(0, 2)
        limits = rng.uniform(math.radians(25), math.radians(120), n)
        put(batch.worlds, lengths)
        hitch(batch.worlds, offsets, limits)
        derive_radii(batch.worlds.fleet, 0, 0, 0.0)
        front = batch.worlds.fleet.radius[0, STABLE, 0]
        least = math.sqrt(max(front**2 - lengths[0] ** 2, 0.0))  # of the rear axle
        on_it = circle(lengths, offsets, least * (1 + 1e-9) + 1e-9)
        assert (on_it <= limits + 1e-4).all()
        if least > 0.1:
            inside = circle(lengths, offsets, least * (1 - 1e-6))
            assert not (inside <= limits).all()
            bound += bool((abs(on_it - limits) < 1e-3).any())
    assert bound > 0.3 * count


def test_each_joint_has_its_own_limit():
    batch = open_plane(2, 1, 3, vehicle=OffAxle(bodies=BODIES))
    limit(batch.worlds, articulation=0.3)
    for w, bend in enumerate((0.5, 0.7)):
        put(batch.worlds, [4.0, 5.0, 5.0], headings=[0.0, 0.0, -bend], w=w)
        hitch(batch.worlds, [0.0, 0.0], [0.3, 0.6], w=w)
    batch.step(np.zeros((1, 2)), np.zeros((1, 2)))
    first = batch.worlds.record.first[0, JACKKNIFE]
    assert first[WHEN].tolist() == [-1, 1]
    assert first[WHERE, 1] == 2
    assert (batch.worlds.fleet.limit[0, ARTICULATION] == 0.3).all()


def test_between_steps_collisions_are_looked_for_among_the_papers_chains_only():
    for vehicle in (OffAxle(), OnAxle(bodies=Rectangles())):
        with pytest.raises(ValueError, match="continuous_collisions is True, but must be False"):
            Batch(
                RandomPoses(fleet=RandomFleet()),
                task=Task(continuous_collisions=True),
                vehicle=vehicle,
            )
