"""A HAV moves as eqs. (1) and (2) state."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hav_env import Batch, OnAxle, RandomFleet, RandomPoses, Task
from hav_env.world.arrays import FOOTPRINT, JACKKNIFE, MOVED, PATH, STABLE, WHEN
from tests.support.budgets import budget
from tests.support.worlds import limit, open_plane, put, stand

RNG = np.random.default_rng(2)
HAVS = {n: RNG.uniform(2.0, 12.0, n + 1) for n in (*range(1, 11), 15)}  # lengths by trailers
BENDS = {n: np.r_[0.3, 0.3 + np.cumsum(RNG.uniform(-0.4, 0.4, n))] for n in HAVS}
CHUNK, STEERINGS = budget(10, 3), RNG.uniform(-0.7, 0.7, 10)  # steps of 0.2 s under each angle
DRIVEN = budget(tuple(HAVS), (1, 4))  # by numbers of trailers


def drive(batch, speed, steering):
    """Drive all HAVs alike; an array of steering angles gives one for each step."""
    shape = batch.worlds.state.x.shape
    for phi in np.atleast_1d(steering):
        batch.step(np.full(shape, speed), np.full(shape, phi))


def positions(batch) -> np.ndarray:
    """Return x, y and all headings (2 + U, N, W)."""
    state = batch.worlds.state
    return np.concatenate([[state.x, state.y], np.moveaxis(state.heading, 1, 0)])


def derivative(_, z, lengths, speed, steering):
    """Both equations of the paper, written unit by unit."""
    headings = z[2:]
    rates = [speed * np.cos(headings[0]), speed * np.sin(headings[0])]
    rates.append(speed / lengths[0] * np.tan(steering))
    for j in range(1, len(lengths)):
        articulation = headings[j] - headings[j - 1]
        rates.append(-speed / lengths[j] * np.sin(articulation))
        speed = speed * np.cos(articulation)
    return rates


def exact(n):
    """Return the state of HAV n after all STEERINGS, integrated by SciPy."""
    z = np.r_[1.0, -2.0, BENDS[n]]
    for steering in STEERINGS:
        options = {"rtol": 1e-10, "atol": 1e-12, "method": "DOP853"}
        span = 0.0, 0.2 * CHUNK
        z = solve_ivp(derivative, span, z, args=(HAVS[n], 0.8, steering), **options).y[:, -1]
    return z


def simulated(vehicle, dt=0.2):
    """Return the states of all HAVs (worlds) after all STEERINGS."""
    most, task = max(DRIVEN), Task(dt=dt)
    batch = open_plane(len(DRIVEN), 1, most, task=task, vehicle=vehicle)
    limit(batch.worlds)
    for w, n in enumerate(DRIVEN):
        put(batch.worlds, HAVS[n], 1.0, -2.0, BENDS[n], w=w)
    drive(batch, 0.8, np.repeat(STEERINGS, round(CHUNK * 0.2 / dt)))
    return {n: positions(batch)[: n + 3, 0, w] for w, n in enumerate(DRIVEN)}


@pytest.fixture(scope="module")
def solutions():
    return {n: exact(n) for n in DRIVEN}


@pytest.fixture(scope="module", params=[True, False], ids=["simultaneous", "in_order"])
def refined(request):
    """States under smaller and smaller Euler steps."""
    orders = {"simultaneous": request.param}
    return {substeps: simulated(OnAxle(substeps, **orders)) for substeps in (10, 20, 40)}


@pytest.mark.parametrize("n", DRIVEN)
def test_the_path_of_every_unit_is_that_of_an_independent_integrator(n, solutions, refined):
    assert np.abs(refined[40][n] - solutions[n]).max() < 0.02
    extrapolated = 2.0 * refined[40][n] - refined[20][n]  # cancels the error of first order
    assert extrapolated == pytest.approx(solutions[n], abs=2e-5)


@pytest.mark.parametrize("n", DRIVEN)
def test_halving_the_time_step_halves_the_error(n, solutions, refined):
    errors = [np.abs(refined[substeps][n] - solutions[n]).max() for substeps in refined]
    assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.15)
    assert errors[1] / errors[2] == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("simultaneous", [True, False])
@pytest.mark.parametrize("substeps", [2, 4])
def test_substeps_are_smaller_time_steps(substeps, simultaneous):
    vehicle = OnAxle(substeps=1, simultaneous=simultaneous)
    one, other = simulated(vehicle._replace(substeps=substeps)), simulated(vehicle, 0.2 / substeps)
    for n in DRIVEN:
        assert one[n].tobytes() == other[n].tobytes()


CIRCLES = [(4.0, 5.0), (3.0, 2.0, 2.5), (5.0, 2.0, 4.0, 3.0), (2.0, 3.0, 2.0, 2.0, 2.0, 3.0)]


def on_circle(lengths, last_radius, steps):
    """Drive where the last axle, once all is steady, has a circle of ``last_radius``, or none."""
    truck_radius = math.sqrt(sum(length**2 for length in lengths[1:]) + last_radius)
    task, vehicle = Task(dt=0.5), OnAxle(simultaneous=True)  # where Euler's steady state is exact
    batch = open_plane(1, 1, len(lengths) - 1, task=task, vehicle=vehicle)
    limit(batch.worlds, steering=1.5)
    put(batch.worlds, lengths)
    drive(batch, 1.0, np.full(steps, math.atan(lengths[0] / truck_radius)))
    return batch, truck_radius


@pytest.mark.parametrize("lengths", CIRCLES)
def test_on_a_steady_circle_each_joint_bends_by_length_over_hitch_radius(lengths):
    batch, radius = on_circle(lengths, 4.0, budget(4000, 2000))
    state = batch.world(0).state
    for joint in range(1, len(lengths)):
        articulation = state.heading[0, joint] - state.heading[0, joint - 1]
        assert math.sin(abs(articulation)) == pytest.approx(lengths[joint] / radius, abs=1e-6)
        assert articulation < 0.0  # a left turn bends trailers to the right
        radius = math.sqrt(radius**2 - lengths[joint] ** 2)
    assert batch.worlds.record.first[0, JACKKNIFE, WHEN, 0] == -1


@pytest.mark.parametrize("lengths", CIRCLES)
def test_no_circle_inside_the_minimal_stable_one_can_be_driven_on_for_long(lengths):
    stable = math.sqrt(sum(length**2 for length in lengths))  # eq. (17), of the front axle
    batch, radius = on_circle(lengths, -0.3, budget(4000, 2000))
    assert math.hypot(radius, lengths[0]) < stable
    assert batch.worlds.record.first[0, JACKKNIFE, WHEN, 0] > 0
    batch, radius = on_circle(lengths, 0.3, budget(4000, 2000))
    assert math.hypot(radius, lengths[0]) > stable
    assert batch.worlds.record.first[0, JACKKNIFE, WHEN, 0] == -1


@pytest.mark.parametrize("num_havs", [1, 7])
@pytest.mark.parametrize("share", [0.0, 0.6])
def test_radii_follow_from_the_lengths(num_havs, share):
    batch = Batch(RandomPoses(num_havs, fleet=RandomFleet(footprint_truck_share=share)), 20)
    batch.reset(3)
    for w in range(20):
        fleet = batch.world(w).fleet
        for agent in range(num_havs):
            lengths = fleet.length[agent, : fleet.num_trailers[agent] + 1]
            assert fleet.radius[agent, STABLE] == pytest.approx(np.linalg.norm(lengths))
            assert fleet.radius[agent, FOOTPRINT] == pytest.approx(
                share * lengths[0] + lengths[1:].sum()
            )


def drive_moved(place, turn=0.0, mirror=1.0):
    """Return truck position (complex) and headings after a drive, moved back."""
    batch = open_plane(1, 1, 5)
    limit(batch.worlds)
    start = (3.0 + 4.0j) * np.exp(1j * turn) + place
    headings = mirror * BENDS[5] + turn
    put(batch.worlds, HAVS[5], start.real, mirror * start.imag if turn == 0 else start.imag)
    put(batch.worlds, HAVS[5], *batch.worlds.state.x[0], *batch.worlds.state.y[0], headings)
    drive(batch, 0.9, mirror * np.repeat(STEERINGS, 30))
    state = batch.world(0).state
    end = complex(state.x[0], mirror * state.y[0])
    return (end - place) * np.exp(-1j * turn), mirror * (state.heading[0] - turn)


@pytest.mark.parametrize(
    "moved",
    [{"place": 1e4 - 2e4j}, {"place": 0j, "turn": 2.0}, {"place": 5 + 6j, "turn": -20.0}],
)
def test_moving_or_turning_the_plane_changes_nothing(moved):
    end, headings = drive_moved(0j)
    other_end, other_headings = drive_moved(**moved)
    assert other_end == pytest.approx(end, abs=1e-8)
    assert other_headings == pytest.approx(headings, abs=1e-10)


def test_mirroring_the_plane_changes_nothing():
    end, headings = drive_moved(0j)
    other_end, other_headings = drive_moved(0j, mirror=-1.0)
    assert other_end == end
    assert (other_headings == headings).all()


@pytest.mark.parametrize("n", [1, 4, 10])
def test_a_straight_hav_that_does_not_steer_stays_straight(n):
    batch = open_plane(1, 1, n)
    limit(batch.worlds)
    put(batch.worlds, HAVS[n], 1.0, 2.0, 0.7)
    drive(batch, 0.5, np.zeros(100))
    assert (batch.world(0).state.heading[0] == 0.7).all()
    there = 1.0 + 10.0 * math.cos(0.7), 2.0 + 10.0 * math.sin(0.7)
    assert positions(batch)[:2, 0, 0] == pytest.approx(there)


def test_a_steady_truck_straightens_any_recoverable_hav():
    batch = open_plane(1, 1, 5)
    limit(batch.worlds)
    put(batch.worlds, HAVS[5], headings=BENDS[5])
    drive(batch, 1.0, np.zeros(2000))
    assert np.ptp(batch.world(0).state.heading[0]) < 1e-3


@pytest.mark.parametrize(
    ("asked", "done"),
    [
        ((5.0, 0.1), (0.6, 0.1)),
        ((-1.0, 0.3), (0.0, 0.3)),
        ((0.5, 2.0), (0.5, 0.4)),
        ((0.5, -1.5), (0.5, -0.4)),
        ((1e300, -1e300), (0.6, -0.4)),
    ],
)
def test_speed_and_steering_are_cut_to_the_limits(asked, done):
    ends, paths = [], []
    for action in (asked, done):
        batch = open_plane(1, 1, 5)
        limit(batch.worlds, speed=0.6, steering=0.4)
        put(batch.worlds, HAVS[5], headings=BENDS[5])
        for _ in range(30):
            drive(batch, *action)
        ends.append(positions(batch).tobytes())
        paths.append(batch.worlds.record.total[0, PATH, 0])
    assert ends[0] == ends[1]
    assert paths == [pytest.approx(30 * 0.2 * done[0])] * 2


def test_a_waiting_hav_stands_whatever_it_is_told():
    batch = open_plane(1, 2, 5)
    limit(batch.worlds)
    for agent, x in enumerate((0.0, 500.0)):
        put(batch.worlds, HAVS[5], x, 0.0, BENDS[5], agent=agent)
    batch.worlds.state.waiting[0] = True
    before = positions(batch)
    drive(batch, 1.0, np.full(20, 0.3))
    after, total = positions(batch), batch.worlds.record.total
    assert (after[:, 0] == before[:, 0]).all()
    assert (after[:, 1] != before[:, 1]).all()
    assert total[0, [PATH, MOVED], 0].tolist() == [0.0, 0.0]
    assert total[1, [PATH, MOVED], 0].tolist() == [pytest.approx(4.0), 20.0]


def test_nothing_moves_without_speed():
    batch = open_plane(1, 1, 5)
    limit(batch.worlds)
    put(batch.worlds, HAVS[5], 3.0, 4.0, BENDS[5])
    before = positions(batch)
    stand(batch, 10)
    assert (positions(batch) == before).all()
