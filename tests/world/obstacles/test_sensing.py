"""Points of obstacles and rays are those that Shapely finds; rows of learners match them."""

import math

import numpy as np
import pytest
import shapely

from hav_env import Batch, Field, Observation, build_site, explicit, sensing
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.observation.columns import DISTANCE_CUT
from hav_env.vehicles import VEHICLES
from tests.support.budgets import budget
from tests.support.obstacles import body_shapes, wall_shapes

RAYS, MOST, POINTS = 17, 50.0, 4
SEEN = Observation(neighbors=1, obstacles=POINTS, rays=RAYS, ray_range=MOST)


@pytest.fixture(scope="module")
def worlds():
    """Return worlds of two real vehicles among walls, after some driving."""
    batch = Batch(Field(num_havs=2, side=60.0), budget(24, 2), vehicle=VEHICLES.make("realistic"))
    batch.reset(21)
    shape = batch.worlds.state.x.shape
    for _ in range(budget(40, 5)):
        batch.step(np.full(shape, 5.0), np.full(shape, 0.2))
    return batch.worlds


def truck_of(worlds, agent, w):
    """Return where a truck's rear axle is, and its direction, as complex numbers."""
    state = worlds.state
    return complex(state.x[agent, w], state.y[agent, w]), np.exp(1j * state.heading[agent, 0, w])


def test_points_are_shapelys(worlds):
    walls = wall_shapes(worlds)
    for w in range(walls.shape[1]):
        place, direction = truck_of(worlds, 0, w)
        truck = shapely.Point(place.real, place.imag)
        for k in range(sensing.num_obstacles(worlds, 0, w)):
            forward, left = sensing.obstacle_point(worlds, 0, k, w)
            assert math.isclose(
                math.hypot(forward, left), truck.distance(walls[k, w]), abs_tol=1e-9
            )
            seen = place + (forward + 1j * left) * direction
            assert shapely.Point(seen.real, seen.imag).distance(walls[k, w]) < 1e-9


def shapely_ray(worlds, agent, w, angle, most) -> float:
    """Return the length of a ray until it meets a wall or a body of another HAV [m]."""
    place, direction = truck_of(worlds, agent, w)
    end = place + most * direction * np.exp(1j * angle)
    line = shapely.LineString([(place.real, place.imag), (end.real, end.imag)])
    others = [shape for k, shape in enumerate(body_shapes(worlds)[:, :, w]) if k != agent]
    met = shapely.union_all([*wall_shapes(worlds)[:, w], *np.concatenate(others)])
    truck = shapely.Point(place.real, place.imag)
    return min(most, truck.distance(line.intersection(met))) if line.intersects(met) else most


def test_rays_are_shapelys(worlds):
    met = []
    for w in range(min(worlds.lanes, budget(12, 1))):
        for number in range(RAYS):
            angle = 2 * math.pi * number / RAYS + 0.1
            args = math.cos(angle), math.sin(angle), MOST, w
            length = sensing.ray(worlds, 0, *args)
            assert math.isclose(length, shapely_ray(worlds, 0, w, angle, MOST), abs_tol=1e-9)
            met.append(length < MOST)
    assert 0.05 < np.mean(met) < 1.0


def test_rays_see_the_bodies_of_others():
    batch = Batch(Field(num_havs=2, num_segments=1), 1, vehicle=VEHICLES.make("realistic"))
    batch.reset(3)
    state = batch.worlds.state
    dx, dy = state.x[1, 0] - state.x[0, 0], state.y[1, 0] - state.y[0, 0]
    _, direction = truck_of(batch.worlds, 0, 0)
    towards = (dx + 1j * dy) / abs(dx + 1j * dy) / direction
    length = sensing.ray(batch.worlds, 0, towards.real, towards.imag, 1e3, 0)
    assert abs(dx + 1j * dy) - 30.0 < length < abs(dx + 1j * dy)


def scaled(distance):
    return math.log(1 + distance) / math.log(1 + DISTANCE_CUT)


@pytest.mark.exhaustive
def test_rows_tell_what_is_sensed():
    count = budget(40, 2)
    process = DecisionProcess(
        count, scenario=Field(num_havs=2, side=60.0), vehicle="realistic", observation=SEEN
    )
    outcome, everywhere = process.outcome(), np.ones(count, np.bool_)
    process.begin(np.full(count, 4), np.arange(count), everywhere, outcome)
    worlds, columns = process.batch.worlds, process.columns
    for w in range(count):
        for agent in range(2):
            row = dict(zip(columns, outcome.observation[w, agent], strict=True))
            points = [sensing.obstacle_point(worlds, agent, k, w) for k in range(32)]
            points.sort(key=lambda point: math.hypot(*point))
            for k, (forward, left) in enumerate(points[:POINTS]):
                far = math.hypot(forward, left)
                assert row[f"obstacle_{k}_present"] == 1.0
                expected = scaled(far), forward / far, left / far
                seen = [
                    row[f"obstacle_{k}_{part}"]
                    for part in ("distance", "bearing_cosine", "bearing_sine")
                ]
                assert np.allclose(seen, expected, atol=2e-5)
            for number in range(RAYS):
                angle = 2 * math.pi * number / RAYS
                length = sensing.ray(worlds, agent, math.cos(angle), math.sin(angle), MOST, w)
                # a ray that grazes an end may pass it in single precision
                others = [
                    sensing.ray(worlds, agent, math.cos(angle + e), math.sin(angle + e), MOST, w)
                    for e in (-1e-5, 1e-5)
                ]
                seen = row[f"ray_{number}"] * MOST
                assert any(abs(seen - known) < 2e-3 for known in (length, *others))


def test_the_plane_has_no_obstacles_to_see():
    process = DecisionProcess(2, num_havs=2, observation=SEEN)
    outcome = process.outcome()
    process.begin(np.zeros(2, int), np.arange(2), np.ones(2, np.bool_), outcome)
    seen = [k for k, name in enumerate(process.columns) if name.startswith("obstacle")]
    rays = [k for k, name in enumerate(process.columns) if name.startswith("ray")]
    assert len(seen) == 4 * POINTS
    assert len(rays) == RAYS
    assert (outcome.observation[..., seen] == 0.0).all()
    assert (outcome.observation[..., rays] > 0.0).all()


def test_more_rays_than_lanes_are_refused():
    with pytest.raises(ValueError, match="rays is 129, but must be at least 0 and at most 128"):
        DecisionProcess(1, observation=Observation(rays=129))


@pytest.mark.exhaustive
def test_rays_see_what_lies_on_them():
    wall = build_site(lines=[[[20.0, 0.0], [30.0, 0.0]], [[0.0, -9.0], [0.0, -30.0]]])
    havs = (
        [[4.0, 5.0]] * 2,
        [[0.0, 0.0, 0.0], [60.0, 0.0, 0.0]],
        [[[9.0, 9.0, 0.0]], [[60.0, 40.0, 0.0]]],
    )
    process = DecisionProcess(
        1, scenario=explicit(*havs, site=wall), observation=Observation(rays=4)
    )
    outcome = process.outcome()
    process.begin(np.zeros(1, int), np.zeros(1, int), np.ones(1, np.bool_), outcome)
    rays = outcome.observation[0, 0, [process.columns.index(f"ray_{k}") for k in range(4)]]
    assert np.allclose(rays * 50.0, [20.0, 50.0, 50.0, 9.0], atol=1e-5)
    worlds = process.batch.worlds
    for cosine, sine, length in ((1.0, 0.0, 20.0), (0.0, -1.0, 9.0), (-1.0, 0.0, 99.0)):
        assert math.isclose(sensing.ray(worlds, 0, cosine, sine, 99.0, 0), length, abs_tol=1e-9)
    plane = explicit(*havs)
    process = DecisionProcess(1, scenario=plane)
    process.begin(np.zeros(1, int), np.zeros(1, int), np.ones(1, np.bool_), process.outcome())
    # the end of the trailer of the HAV ahead
    assert math.isclose(sensing.ray(process.batch.worlds, 0, 1.0, 0.0, 99.0, 0), 55.0, abs_tol=1e-6)
