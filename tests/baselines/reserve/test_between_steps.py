"""Between the steps, the area swept by chains is covered by Reserve's tests and reservations."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from shapely import LineString, MultiPoint

from baselines.policies.reserve.perception.own_state import sag, stride
from hav_env import OnAxle, RandomFleet, RandomPoses, find_scenario
from hav_env.maths.geometry import hull_apart
from hav_env.vehicles import move
from hav_env.world.arrays import allocate_worlds, derive_radii, put_straight, turn_unit
from tests.support.audit import drive
from tests.support.budgets import budget

SHORT = RandomFleet(
    max_trailers=3, max_length=4.0, short_truck_mean=3.0, long_truck_mean=3.5, speed_max=5.0
)


def test_short_havs_at_high_speed_do_not_cross_between_steps():
    """Two chains crossed between steps 363 and 364, and were apart at both."""
    scenario = RandomPoses(num_havs=20, area_factor=2.0, num_goals=1, fleet=SHORT)
    audit = drive(scenario, 7970001, [0], budget(600, 2))
    audit.approve()
    assert budget(audit.between.min() < 1.0, True)


def test_a_yard_where_chains_came_within_a_twentieth_of_a_millimetre():
    audit = drive(find_scenario("yard-10"), 7060102, [0], budget(2000, 2))
    audit.approve()
    assert min(audit.between.min(), audit.least.min()) > 0.005


def to_segment(p, a, b):
    """Return the distance [m] from a point to a segment, all of them x + iy."""
    along = ((p - a) * np.conj(b - a)).real / abs(b - a) ** 2
    return abs(p - a - np.clip(along, 0.0, 1.0) * (b - a))


def axles(length, x, y, heading):
    """Return the axles of a chain, x + iy [m], the front one first."""
    unit = length * np.exp(1j * np.asarray(heading))
    return x + 1j * y + np.concatenate([[unit[0]], [0.0], -np.cumsum(unit[1:])])


def rolled(length, heading, speed, steering, dt):
    """Return the axles at moments of a step (T, A), by SciPy, the truck's rear axle from (0, 0)."""

    def rates(_, state):
        angles, v = state[2:], speed
        found = [v * math.cos(angles[0]), v * math.sin(angles[0])]
        found.append(v * math.tan(steering) / length[0])
        for unit in range(1, len(length)):
            bend = angles[unit] - angles[unit - 1]
            found.append(-v * math.sin(bend) / length[unit])
            v *= math.cos(bend)
        return found

    solved = solve_ivp(
        rates, (0.0, dt), [0.0, 0.0, *heading], t_eval=np.linspace(0.0, dt, 9), rtol=1e-9, atol=1e-9
    )
    return np.array([axles(length, *state[:2], state[2:]) for state in solved.y.T])


def stepped(length, heading, speed, steering, dt):
    """Return the axles after one step of the simulator."""
    units = len(length)
    world = allocate_worlds(1, 1, units, 1)
    world.fleet.num_trailers[0, 0] = units - 1
    world.fleet.length[0, :, 0] = length
    derive_radii(world.fleet, 0, 0, 0.0)
    put_straight(world.state, 0, 0, 0.0, 0.0, 0.0)
    for unit in range(units):
        turn_unit(world.state, 0, unit, 0, heading[unit])
    world.state.speed[0, 0], world.state.steering[0, 0] = speed, steering
    move(OnAxle(), dt, world, 0)
    state = world.state
    return axles(length, state.x[0, 0], state.y[0, 0], state.heading[0, :, 0])


bends = st.floats(math.radians(-89.0), math.radians(89.0))


@given(
    st.lists(st.tuples(st.floats(0.5, 12.0), bends), min_size=2, max_size=11),
    st.floats(0.02, 2.0),
    st.floats(-1.0, 1.0),
    st.floats(0.05, 1.1),
)
def test_rolling_wheels_stay_near_the_ways_of_a_step(units, share, turn, steering_max):
    """The lemma of docs/safety.md: links stay in the hull of a step's paths, widened by the sag."""
    length = np.array([size for size, _ in units])
    heading = np.cumsum([bend for _, bend in units])
    step, steering = share * length.min(), turn * steering_max
    before = axles(length, 0.0, 0.0, heading)
    after = stepped(length, heading, step, steering, 1.0)
    way = rolled(length, heading, step, steering, 1.0)
    steepest, trailers = math.tan(steering_max), len(units) - 1
    allowed = sag(step, steepest, length.min()) + 1e-6
    assert max(to_segment(p, before[0], after[0]) for p in way[:, 0]) <= allowed
    for axle in range(1, len(before)):
        ahead = before[axle] + step * (before[axle - 1] - before[axle]) / length[axle - 1]
        pulled = max(to_segment(p, before[axle], ahead) for p in way[:, axle])
        assert pulled <= allowed
        beyond = to_segment(ahead, before[axle], before[axle - 1])
        assert beyond <= max(0.0, step - length.min()) + 1e-9
    farthest = stride(step, steepest, length.min(), trailers) + 1e-6
    assert abs(after - before).max() <= farthest
    assert abs(way - before).max() <= farthest


place = st.integers(-3_000, 3_000).map(lambda number: number / 1_000)
points = st.lists(st.tuples(place, place), min_size=5, max_size=5)


@given(points, st.tuples(place, place), st.tuples(place, place), st.floats(0.0, 1.0))
def test_the_distance_of_a_hull_from_a_segment_is_shapelys(corners, a, b, margin):
    rows = np.array(corners).ravel()
    distance = MultiPoint(corners).convex_hull.distance(LineString([a, b]))
    if abs(distance - margin) > 1e-6:
        assert hull_apart(rows, 0, 5, *a, *b, margin) == (distance > margin)


def test_a_segment_inside_a_hull_is_not_apart():
    rows = np.array([0.0, 0.0, 10.0, 0.0, 10.0, 10.0, 0.0, 10.0, 5.0, 5.0])
    assert not hull_apart(rows, 0, 5, 4.0, 2.0, 5.0, 2.0, 0.1)
    assert hull_apart(rows, 0, 5, 14.0, 2.0, 15.0, 2.0, 0.1)
