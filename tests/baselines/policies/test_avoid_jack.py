"""AVOID-JACK decides by hand-computed vectors; the other policies keep to their rules."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from baselines.policies.avoid_jack import AvoidJack, jackknife_weight, safe_speed
from baselines.policies.dubins_pursuit import DubinsPursuit
from hav_env import Task
from hav_env.maths.dubins import WORDS, shortest_path
from hav_env.policies.interface import allocate_memory, decide
from tests.support.worlds import ALL, aim, limit, open_plane, put, stand, wrapped

DEGREE = math.pi / 180
PAPER = AvoidJack(
    b=0.5,
    c=2.0,
    beta=75 * DEGREE,
    dt=0.2,
    close_factor=1.0,
    straight_below=1e-3,
    evasion_truck_share=0.0,
    evasion_release=1.0,
    keep_first=True,
)
W0 = 1.0 + math.tanh(-1.5)  # the weight of a straight joint


def weight(articulation, policy=PAPER):
    return jackknife_weight(policy, math.cos(articulation))


@pytest.mark.parametrize(
    ("degrees", "value"),
    [
        (0, 1 + math.tanh(-1.5)),
        (60, 1 + math.tanh(-0.5)),
        (90, 1 + math.tanh(0.5)),
        (180, 1 + math.tanh(2.5)),
        (math.degrees(math.acos(0.25)), 1.0),  # the threshold beta, about 75 degrees
    ],
)
def test_the_jackknife_weight_has_the_values_of_the_paper(degrees, value):
    assert weight(degrees * DEGREE) == pytest.approx(value, rel=1e-12)


@given(st.floats(-math.pi, math.pi), st.floats(-3, 3), st.floats(0, 5))
def test_the_jackknife_weight_is_even_bounded_and_the_hyperbolic_tangent(articulation, b, c):
    policy = PAPER._replace(b=b, c=c)
    value = weight(articulation, policy)
    assert value == pytest.approx(1 + math.tanh(b - c * math.cos(articulation)), abs=1e-12)
    assert 0.0 <= value <= 2.0
    assert value == weight(-articulation, policy)
    assert value <= weight(math.pi, policy) + 1e-15


def test_the_safe_speed_is_that_of_the_equation():
    # 15 degrees = 0.2618 rad in 0.2 s, at sin 75 / 4 + tan 45 / 2 = 0.7415 rad/m
    assert safe_speed(
        0.2, 2.0, 4.0, math.tan(45 * DEGREE), 90 * DEGREE, 75 * DEGREE
    ) == pytest.approx((math.pi / 12) / (0.2 * (0.9659258262890683 / 4 + 0.5)))


def test_the_fleets_of_the_paper_may_always_drive_a_metre_a_second():
    lengths = np.r_[np.linspace(2.0, 12.0, 21)[:-1], np.nextafter(12, 0)]
    for truck in lengths:
        for trailer in lengths:
            speed = safe_speed(0.2, truck, trailer, math.tan(50 * DEGREE), 90 * DEGREE, 75 * DEGREE)
            assert speed >= 1.0


@pytest.mark.parametrize("truck", [2.0, 5.0])
@pytest.mark.parametrize("trailer", [2.0, 11.0])
def test_at_the_safe_speed_one_step_from_the_threshold_reaches_the_limit(truck, trailer):
    beta, most, steering = 75 * DEGREE, 90 * DEGREE, 50 * DEGREE
    speed = safe_speed(0.2, truck, trailer, math.tan(steering), most, beta)
    rate = -speed / trailer * math.sin(-beta) + speed / truck * math.tan(steering)  # (delta_dot)
    assert beta + 0.2 * rate == pytest.approx(most)


def scene(*havs, goal=(1e3, 0.0, 0.0), steering=50 * DEGREE, speed=1.0):
    """Return a world of HAVs given as (lengths, x, y, headings); all share a goal."""
    batch = open_plane(1, len(havs), 4)
    limit(batch.worlds, steering=steering, speed=speed)
    for agent, (lengths, x, y, headings) in enumerate(havs):
        put(batch.worlds, lengths, x, y, headings, agent=agent)
    aim(batch.worlds, ALL, ALL, *goal)
    batch.worlds.state.waiting[:] = True
    stand(batch)  # finds the neighbours
    batch.worlds.state.waiting[:] = False
    return batch


def choice(batch, policy=PAPER, memory=None):
    """Return speed and steering of HAV 0."""
    memory = allocate_memory(policy, *batch.worlds.state.x.shape) if memory is None else memory
    speed, steering = decide(policy, memory, batch)
    return speed[0, 0], steering[0, 0]


HAV = ([3.0, 4.0, 5.0], 0.0, 0.0, 0.0)
R = math.sqrt(50.0)


@pytest.mark.parametrize(
    ("goal", "side"),
    [
        ((100.0, 0.0, 0.0), 0),
        ((100.0, 40.0, 0.0), 1),
        ((100.0, -40.0, 0.0), -1),
        ((0.0, 2 * R + 3.0, math.pi), 1),
        ((0.0, -2 * R - 3.0, math.pi), -1),
        # far: to the approach point, 3 m before the goal, on a tangent of the last circle
        ((R + 4.0, R + 3.0, math.pi / 2), 0),
        # exactly on the circle of R_min through the approach point
        ((R, R + 3.0, math.pi / 2), 1),
        # close: to the goal itself, round the truck's length
        ((2.0, 0.0, 0.0), 0),
        ((2.0, 0.5, 0.5), 1),
        ((2.0, -0.5, -0.5), -1),
    ],
)
def test_goal_attraction_steers_to_where_the_dubins_path_starts(goal, side):
    batch = scene(HAV, goal=goal)
    speed, steering = choice(batch)
    full = 50 * DEGREE
    x, y = math.cos(full) + 2 * W0, math.sin(full)
    assert steering == pytest.approx(side * math.atan2(y, x))
    assert speed == 1.0
    pursuit = DubinsPursuit(close_factor=1.0, straight_below=1e-3)
    assert choice(batch, pursuit) == (1.0, side * full)


def test_close_begins_within_the_given_number_of_truck_lengths():
    # one truck length before the goal lies behind this HAV, which must turn back for it
    for distance, close_factor, close in [(2.99, 1, True), (3, 1, False), (5.9, 2, True)]:
        batch = scene(HAV, goal=(distance, 0.0, 0.3))
        policy = DubinsPursuit(close_factor=float(close_factor), straight_below=1e-3)
        approach = distance - 3.0 * math.cos(0.3), -3.0 * math.sin(0.3), 0.3
        target, radius = ((distance, 0.0, 0.3), 3.0) if close else (approach, R)
        word, first, *_ = shortest_path(*target, radius)
        assert first > 1e-3
        side = 1 if WORDS[word].startswith("L") else -1
        assert choice(batch, policy) == (1.0, side * 50 * DEGREE)


def test_a_first_turn_below_the_threshold_counts_as_none():
    batch = scene(HAV, goal=(100.0, 0.05, 0.0))  # a left turn of a few millimetres
    assert choice(batch, DubinsPursuit(close_factor=1.0, straight_below=1e-3))[1] > 0.0
    assert choice(batch, DubinsPursuit(close_factor=1.0, straight_below=1e-2))[1] == 0.0
    assert choice(batch, PAPER._replace(straight_below=1e-2))[1] == 0.0


def test_jackknife_repulsion_pulls_towards_the_first_trailer_by_the_weights_of_all_joints():
    bends = np.array([70.0, -40.0]) * DEGREE
    batch = scene(([3.0, 4.0, 5.0], 0.0, 0.0, np.r_[0.0, bends.cumsum()]), goal=(200.0, 0.0, 0.0))
    total = weight(bends[0]) + weight(bends[1])
    x, y = 1.0 + total * math.cos(bends[0]), total * math.sin(bends[0])
    assert choice(batch)[1] == pytest.approx(math.atan2(y, x))


def test_steering_is_cut_to_its_limit_on_both_sides():
    for sign in (1, -1):
        folded = ([3.0, 4.0, 5.0], 0.0, 0.0, sign * np.array([0.0, 100.0, 190.0]) * DEGREE)
        batch = scene(folded, goal=(200.0, 0.0, 0.0), steering=30 * DEGREE)
        assert choice(batch)[1] == pytest.approx(sign * 30 * DEGREE)


@pytest.mark.parametrize("fast", [0.7, 1.0, 50.0])
def test_speed_is_the_lesser_of_the_limit_and_the_safe_speed(fast):
    safe = safe_speed(0.2, 3.0, 4.0, math.tan(50 * DEGREE), 90 * DEGREE, 75 * DEGREE)
    assert 1.0 < safe < 50.0
    assert choice(scene(HAV, speed=fast))[0] == pytest.approx(min(fast, safe))


@pytest.mark.parametrize("angle", np.linspace(-3.0, 3.0, 8))
def test_evasion_replaces_the_goal_by_the_direction_away_from_the_other(angle):
    x, y = 12.0 * math.cos(angle), 12.0 * math.sin(angle)  # both footprints: 9 m + 6 m
    batch = scene(HAV, ([3.0, 6.0], x, y, 1.0), goal=(0.0, 40.0, 0.0))
    wanted = math.atan2(-math.sin(angle), -math.cos(angle) + 2 * W0)
    speed, steering = choice(batch)
    assert steering == pytest.approx(np.clip(wanted, -50 * DEGREE, 50 * DEGREE))
    assert speed == 1.0


def test_evasion_from_the_very_same_place_is_finite():
    assert all(map(math.isfinite, choice(scene(HAV, HAV))))


def to_the_left(distance):
    return [3.0, 6.0], 0.0, distance, 0.0


@pytest.mark.parametrize(
    ("share", "distances"),
    [(0.0, (15.0, 15.001)), (0.5, (18.0, 18.001)), (1.0, (21.0, 21.001))],
)
def test_evasion_starts_at_the_collision_distance_and_a_share_of_the_trucks(share, distances):
    policy = PAPER._replace(evasion_truck_share=share)
    near, far = (choice(scene(HAV, to_the_left(d)), policy)[1] for d in distances)
    assert near < -40 * DEGREE
    assert far == 0.0


@pytest.mark.parametrize("keep_first", [True, False])
@pytest.mark.parametrize("release", [1.0, 1.5])
def test_evasion_ends_at_the_release_distance(release, keep_first):
    policy = PAPER._replace(evasion_release=release, keep_first=keep_first)
    memory, ends, evades = allocate_memory(policy, 2, 1), release * 15.0, False
    for distance in (ends - 1e-6, 14.0, ends - 1e-6, ends + 1e-6, ends - 1e-6):
        steering = choice(scene(HAV, to_the_left(distance)), policy, memory)[1]
        # beyond the start at 15 m, only a HAV that has begun continues
        evades = distance <= 15.0 or (evades and distance <= ends)
        assert (steering < 0.0) == (memory[0, 0, 0] == 2.0) == evades


def evaded(distances, policy, memory):
    """Return the index of the HAV on the left that HAV 0 evades."""
    others = [([3.0, 6.0], 0.1 * k, distance, 0.0) for k, distance in enumerate(distances)]
    choice(scene(HAV, *others), policy, memory)
    return int(memory[0, 0, 0]) - 1


FRAMES = [(20.0, 14.0), (13.0, 14.0), (5.0, 14.0), (5.0, 16.0), (5.0, 4.0), (30.0, 30.0)]


@pytest.mark.parametrize(
    ("keep_first", "partners"), [(True, [2, 2, 2, 1, 1, -1]), (False, [2, 1, 1, 1, 2, -1])]
)
def test_priority_is_given_to_the_first_detected_or_to_the_nearest(keep_first, partners):
    policy = PAPER._replace(keep_first=keep_first)
    memory = allocate_memory(policy, 3, 1)
    assert [evaded(frame, policy, memory) for frame in FRAMES] == partners


@pytest.mark.parametrize("frame", [(14.0, 13.0), (13.0, 14.0), (1.0, 14.9)])
def test_of_those_detected_together_the_deepest_is_evaded(frame):
    memory = allocate_memory(PAPER, 3, 1)
    assert evaded(frame, PAPER, memory) == 1 + int(np.argmin(frame))


def test_the_decision_is_the_vector_sum_of_the_paper_in_any_state():
    """Random worlds; the reference works in the frame of the plane, as the paper does."""
    num_worlds, num_havs, rng = 60, 3, np.random.default_rng(8)
    batch = open_plane(num_worlds, num_havs, 4, task=Task(sensing_range=0.0))
    limit(batch.worlds)
    places = rng.uniform(-60, 60, (2, num_havs, num_worlds))
    aim(batch.worlds, ALL, ALL, *places, rng.uniform(-4, 4, (num_havs, num_worlds)))
    for w in range(num_worlds):
        for agent in range(num_havs):
            lengths = rng.uniform(2, 12, rng.integers(2, 6))
            bends = np.r_[rng.uniform(-4, 4), rng.uniform(-1.3, 1.3, len(lengths) - 1)]
            put(batch.worlds, lengths, *rng.uniform(-60, 60, 2), bends.cumsum(), w=w, agent=agent)
    batch.worlds.state.waiting[:] = True
    stand(batch)
    batch.worlds.state.waiting[:] = False
    found = np.array(decide(PAPER, allocate_memory(PAPER, num_havs, num_worlds), batch))
    evading = 0
    for w in range(num_worlds):
        world = batch.world(w)
        for agent in range(num_havs):
            goal_vector, evades = reference_vector(world, agent)
            evading += evades
            units = world.fleet.num_trailers[agent] + 1
            headings = world.state.heading[agent, :units]
            repulsion = (1 + np.tanh(0.5 - 2 * np.cos(np.diff(headings)))).sum()
            total = goal_vector + repulsion * np.exp(1j * headings[1])
            steering = np.clip(wrapped(np.angle(total) - headings[0]), -50 * DEGREE, 50 * DEGREE)
            assert found[:, agent, w] == pytest.approx([1.0, steering], abs=1e-9)
    assert 20 < evading < 160


def reference_vector(world, agent):
    """Return goal attraction or evasion (complex, in the plane), and whether it is evasion."""
    fleet, state = world.fleet, world.state
    places = state.x + 1j * state.y
    radii = [fleet.length[i, 1 : n + 1].sum() for i, n in enumerate(fleet.num_trailers)]
    gaps = np.abs(places - places[agent])
    depths = {i: radii[agent] + radii[i] - gaps[i] for i in range(len(gaps)) if i != agent}
    deepest = max(depths, key=depths.get)
    if depths[deepest] >= 0.0:
        away = places[agent] - places[deepest]
        return away / abs(away), True
    lengths = fleet.length[agent, : fleet.num_trailers[agent] + 1]
    heading = state.heading[agent, 0]
    x, y, goal_heading = world.goals[agent, 0]
    goal, radius = complex(x, y), lengths[0]
    if abs(goal - places[agent]) >= lengths[0]:
        goal, radius = goal - lengths[0] * np.exp(1j * goal_heading), math.hypot(*lengths)
    there = (goal - places[agent]) * np.exp(-1j * heading)
    word, *segments = shortest_path(there.real, there.imag, goal_heading - heading, radius)
    sides = ["RSL".index(letter) - 1 for letter in WORDS[word]]
    side = next((s for s, length in zip(sides, segments, strict=True) if length >= 1e-3), 0)
    return np.exp(1j * (heading + side * 50 * DEGREE)), False
