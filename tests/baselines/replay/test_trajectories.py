"""A recorded episode equals the rollout of the same episode."""

import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from baselines.replay import recording
from baselines.replay.interpolation import scene_at
from baselines.replay.trajectory import (
    body_corners,
    chain_points,
    front_points,
    record_trajectory,
)
from hav_env import (
    Limited,
    OffAxle,
    OnAxle,
    RandomPoses,
    Rectangles,
    Task,
    catalogue_fleet,
)
from hav_env.evaluation.rollout import rollout
from hav_env.vehicles import catalogue
from tests.support.budgets import budget

TASK = Task(max_steps=300)
SCENARIO = RandomPoses(num_havs=2)


@pytest.fixture(scope="module")
def trajectory():
    return record_trajectory(AvoidJack(), SCENARIO, 4, 7, TASK)


def test_it_ends_like_the_rollout(trajectory):
    table = rollout(AvoidJack(), SCENARIO, 4, np.array([7]), TASK)
    assert trajectory.step[-1] == table["steps"][0].as_py()
    articulation = np.diff(trajectory.heading, axis=-1)
    for hav, count in enumerate(trajectory.num_trailers):
        largest = np.abs(articulation[:, hav, :count]).max()
        assert largest == table["largest_articulation"][hav].as_py()
    assert np.array_equal(trajectory.x[0], table["start_x"].to_numpy())


def test_thinning_keeps_the_first_and_the_last_state(trajectory):
    thin = record_trajectory(AvoidJack(), SCENARIO, 4, 7, TASK, every=7)
    assert thin.step[0] == 0
    assert thin.step[-1] == trajectory.step[-1]
    rows = np.searchsorted(trajectory.step, thin.step)
    assert np.array_equal(thin.heading, trajectory.heading[rows])


def test_axles_of_a_chain_are_a_unit_apart_and_the_second_is_the_trucks(trajectory):
    for hav, count in enumerate(trajectory.num_trailers):
        points = chain_points(trajectory, hav, slice(None))
        gaps = np.linalg.norm(np.diff(points, axis=1), axis=-1)
        assert np.allclose(gaps, trajectory.length[hav, : count + 1])
        assert np.allclose(points[:, 1, 0], trajectory.x[:, hav])


@pytest.mark.parametrize("order", ["at_once", "in_turn"])
def test_decisions_of_a_state_lead_to_the_next_one(order):
    """Decided speed and steering move the truck by the paper's equations; evasions are tied."""
    task = TASK._replace(order=order, max_steps=budget(4_000, 300), next_goal="alone")
    wary = AvoidJack(evasion_truck_share=1.0)
    kept = record_trajectory(wary, SCENARIO, 4, 5, task)
    table = rollout(wary, SCENARIO, 4, np.array([5]), task)
    turn = kept.speed * np.tan(kept.steering) / kept.length[:, 0] * task.dt
    heading = kept.heading[:, :, 0]
    np.testing.assert_allclose(np.diff(heading, axis=0), turn[:-1], rtol=0, atol=1e-9)
    ahead = kept.speed[:-1] * task.dt
    np.testing.assert_allclose(np.diff(kept.x, axis=0), ahead * np.cos(heading[1:]), atol=1e-7)
    path = np.nansum(kept.speed, axis=0) * task.dt
    np.testing.assert_allclose(path, table["path_length"].to_numpy())
    for hav in range(2):
        under_way = kept.phase[:, hav] == 0
        x, y, _ = kept.goals[hav, 0]
        closest = np.hypot(kept.x[:, hav] - x, kept.y[:, hav] - y)[under_way].min()
        hit = table["goal_1_hit"][hav].as_py()
        assert closest == table["goal_1_closest"][hav].as_py() or hit  # the hit ends the phase
    distance = np.hypot(np.diff(kept.x, axis=1), np.diff(kept.y, axis=1))[:-1, 0]
    wide = kept.footprint.sum() + kept.length[:, 0].sum()
    apart = np.abs(distance - wide) > 1.0  # in turn, HAV 1 decides after the movement of HAV 0
    for hav in range(2):
        evades = (kept.evaded[:-1, hav] >= 0) & ~kept.waiting[:-1, hav]
        decides = ~kept.waiting[:-1, hav] & apart
        np.testing.assert_array_equal(evades[decides], (distance < wide)[decides])


def test_chunks_do_not_show(monkeypatch):
    whole = record_trajectory(AvoidJack(), SCENARIO, 4, 7, TASK, every=3)
    monkeypatch.setattr(recording, "_CHUNK", 17)
    pieces = record_trajectory(AvoidJack(), SCENARIO, 4, 7, TASK, every=3)
    for one, other in zip(whole, pieces, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize(
    "vehicle",
    [
        OnAxle(),
        pytest.param(OnAxle(actuators=Limited(0.3, 0.1, 0.1)), marks=pytest.mark.exhaustive),
    ],
)
def test_the_recorded_motion_is_what_was_driven(vehicle):
    """For any decision, these speeds and angles move the truck; a HAV at its goal may roll."""
    task = TASK._replace(max_steps=budget(4_000, 300))
    kept = record_trajectory(AvoidJack(), SCENARIO, 4, 5, task, vehicle)
    table = rollout(AvoidJack(), SCENARIO, 4, np.array([5]), task, vehicle)
    speed, steering = kept.motion[:-1, :, 0], kept.motion[:-1, :, 1]
    turn = speed * np.tan(steering) / kept.length[:, 0] * task.dt
    heading = kept.heading[:, :, 0]
    np.testing.assert_allclose(np.diff(heading, axis=0), turn, rtol=0, atol=1e-9)
    ahead = speed * task.dt
    np.testing.assert_allclose(np.diff(kept.x, axis=0), ahead * np.cos(heading[1:]), atol=1e-7)
    np.testing.assert_allclose(ahead.sum(axis=0), table["path_length"].to_numpy())
    as_decided = np.array_equal(speed, kept.speed[:-1])
    assert as_decided == (vehicle == OnAxle())
    rolled = (speed > 0.0) & kept.waiting[:-1]
    assert rolled.any() == (vehicle != OnAxle()) or not kept.waiting[:-1].any()


def test_the_papers_hitches_are_on_the_axles_and_its_bodies_lines(trajectory):
    assert not trajectory.offset.any()
    assert trajectory.shape is None
    assert (trajectory.articulation_max == np.pi / 2).all()


@pytest.mark.parametrize("name", ["baggage-train", "a-double"])
@pytest.mark.exhaustive
def test_hitches_and_bodies_are_recorded_and_move_together(name):
    vehicle, kind = OffAxle(bodies=Rectangles(), actuators=Limited()), catalogue(name)
    scenario = RandomPoses(fleet=catalogue_fleet(kind))
    kept = record_trajectory(AvoidJack(), scenario, 4, 7, Task(max_steps=40), vehicle)
    units, states = len(kind.units), len(kept.step)
    np.testing.assert_array_equal(kept.offset[0, : units - 1], kind.offsets[1:])
    np.testing.assert_array_equal(kept.articulation_max[0, 1:units], kind.limits[1:])
    np.testing.assert_array_equal(kept.shape[0, :units].T, kind.bodies)
    axles, fronts = (points(kept, 0, slice(None)) for points in (chain_points, front_points))
    assert axles.shape == (states, units + 1, 2)
    directions = np.exp(1j * kept.heading[:, 0, :units])
    places, ends = axles[..., 0] + 1j * axles[..., 1], fronts[..., 0] + 1j * fronts[..., 1]
    np.testing.assert_allclose(ends - places[:, 1:], kind.lengths * directions, atol=1e-9)
    behind = kind.offsets[1:] * directions[:, :-1]
    np.testing.assert_allclose(places[:, 1:-1] - ends[:, 1:], behind, atol=1e-9)
    corners = body_corners(kept, 0, slice(None))
    sides = np.linalg.norm(corners - np.roll(corners, -1, axis=2), axis=-1)
    half, ahead, rear = np.array(kind.bodies)
    whole = np.array(kind.lengths) + ahead + rear
    expected = np.stack([whole, 2.0 * half, whole, 2.0 * half], axis=-1)
    np.testing.assert_allclose(sides, np.broadcast_to(expected, sides.shape), atol=1e-9)
    scene = scene_at(kept, 1.3)
    assert scene.offset is kept.offset
    assert scene.shape is kept.shape
