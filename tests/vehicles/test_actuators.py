"""Trucks accelerate, brake and steer at limited rates; by default they follow commands at once."""

import math

import numpy as np
import pytest

from hav_env import Batch, Limited, OnAxle, RandomFleet, RandomPoses, Task
from hav_env.vehicles import Instant, check_vehicle
from hav_env.world.arrays import HIT_STEP, MISS_COUNT, MOVED, PATH, PHASE, SPEED, STEERING
from hav_env.world.sensing import neighbor_speed, own_speed, own_steering
from tests.support.budgets import budget
from tests.support.worlds import aim, limit, open_plane, put

DT = 0.2
QUICK = RandomFleet(speed_max=5.0)
EVENTFUL = Task(dt=DT, distance_tolerance=25.0, heading_tolerance=2.8, sensing_range=30.0)
LIMITS = Limited()
BEHIND_ROUNDING = 1.0 + 1e-12


def drive(vehicle, scenario, num_worlds, steps, task=Task(), seed=3, share=0.1):
    """Drive with random commands, some beyond the limits, each held for a while.

    Yields:
        The batch, commanded speed and steering (N, W), speed and steering (N, W) before the step,
        and the HAVs that waited then.
    """
    batch = Batch(scenario, num_worlds, task, vehicle, threads=1)
    batch.reset(seed)
    state, rng = batch.worlds.state, np.random.default_rng(seed)
    shape = state.x.shape
    command = np.zeros((2, *shape))
    for _ in range(steps):
        fresh = rng.uniform([-2.0, -1.2], [8.0, 1.2], (*shape, 2)).transpose(2, 0, 1)
        command = np.where(rng.random(shape) < share, fresh, command)
        before = state.speed.copy(), state.steering.copy(), state.waiting.copy()
        batch.step(*command)
        yield batch, command, before


def test_every_limit_holds_in_every_step_but_where_brakes_cannot_follow():
    """A6 of the issue: 10^6 random commands."""
    worlds, steps = budget((1_000, 1_000), (10, 200))
    reached, quick, largest = np.zeros(4, int), 0, 0.0
    scenario = RandomPoses(num_havs=1, fleet=QUICK)
    for batch, _, (speed, steering, _) in drive(OnAxle(actuators=LIMITS), scenario, worlds, steps):
        state, fleet = batch.worlds.state, batch.worlds.fleet
        assert (state.speed >= 0.0).all()
        assert (state.speed <= fleet.limit[:, SPEED]).all()
        assert (abs(state.steering) <= fleet.limit[:, STEERING]).all()
        turn, faster = abs(state.steering - steering) / DT, (state.speed - speed) / DT
        assert turn.max() <= LIMITS.steering_rate * BEHIND_ROUNDING + 1e-12
        assert faster.max() <= LIMITS.acceleration * BEHIND_ROUNDING + 1e-12
        assert -faster.min() <= LIMITS.braking * BEHIND_ROUNDING + 1e-12
        lateral = state.speed**2 * np.tan(abs(state.steering)) / fleet.length[:, 0]
        beyond = lateral > LIMITS.lateral * (1.0 + 1e-9)
        assert -faster[beyond] == pytest.approx(LIMITS.braking, abs=1e-9)
        quick, largest = quick + beyond.sum(), max(largest, lateral.max())
        reached += [
            np.isclose(turn, LIMITS.steering_rate).sum(),
            np.isclose(faster, LIMITS.acceleration).sum(),
            np.isclose(-faster, LIMITS.braking).sum(),
            np.isclose(lateral, LIMITS.lateral).sum(),
        ]
    assert (reached > budget(10_000, 1)).all()
    assert quick < 0.02 * worlds * steps
    print(f"{quick} of {worlds * steps} steps beyond the lateral limit, at most {largest:.2f}")


def follow(speed, steering, command, waits, wheelbase, most, limits):
    """Return speed and steering after a step, written for one truck from the definition."""
    steepest, fastest = most[STEERING], most[SPEED]
    target = steering if waits else min(max(command[1], -steepest), steepest)
    after = steering + min(
        max(target - steering, -limits.steering_rate * DT), limits.steering_rate * DT
    )
    speed_target = 0.0 if waits else min(max(command[0], 0.0), fastest)
    if after != 0.0:
        curve = math.sqrt(limits.lateral * wheelbase / math.tan(abs(after)))
        speed_target = min(speed_target, curve)
    change = speed_target - speed
    return speed + min(max(change, -limits.braking * DT), limits.acceleration * DT), after


@pytest.mark.parametrize("limits", [LIMITS, Limited(5.0, 0.5, 3.0, 0.3), Limited(lateral=1e9)])
def test_a_step_is_what_the_definition_says(limits):
    waited = 0
    for batch, command, (speed, steering, waits) in drive(
        OnAxle(actuators=limits), RandomPoses(num_havs=2, fleet=QUICK), 20, 60, EVENTFUL
    ):
        fleet = batch.worlds.fleet
        for agent, w in np.ndindex(speed.shape):
            at = agent, w
            told = follow(
                *(speed[at], steering[at], command[:, agent, w], waits[at]),
                *(fleet.length[agent, 0, w], fleet.limit[agent, :, w], limits),
            )
            found = batch.worlds.state.speed[at], batch.worlds.state.steering[at]
            assert found == pytest.approx(told, abs=1e-12)
        waited += waits.sum()
    assert waited > 100


def test_what_is_instant_is_commanded_and_cut():
    for batch, command, (_, _, waits) in drive(
        OnAxle(), RandomPoses(num_havs=3, fleet=QUICK), budget(200, 20), 40, EVENTFUL, share=1.0
    ):
        state, most = batch.worlds.state, batch.worlds.fleet.limit
        speed = np.where(waits, 0.0, command[0].clip(0.0, most[:, SPEED]))
        steering = command[1].clip(-most[:, STEERING], most[:, STEERING])
        assert state.speed.tobytes() == speed.tobytes()
        assert state.steering.tobytes() == steering.tobytes()


def test_without_limits_what_is_limited_is_instant():
    free = Limited(*[1e9] * 4)
    scenario = RandomPoses(num_havs=3, fleet=QUICK)
    runs = [
        drive(OnAxle(actuators=actuators), scenario, budget(130, 20), 60, EVENTFUL)
        for actuators in (Instant(), free)
    ]
    waited = 0
    for (one, _, (_, _, waits)), (other, _, _) in zip(*runs, strict=True):
        waited += waits.sum()
        for name in ("x", "y", "heading", "speed", "goal", "waiting"):
            assert (
                getattr(one.worlds.state, name).tobytes()
                == getattr(other.worlds.state, name).tobytes()
            ), name
        turned = (batch.worlds.state.steering[~waits].tobytes() for batch in (one, other))
        assert len(set(turned)) == 1  # commands for a waiting HAV are void
        for name, array in one.worlds.record._asdict().items():
            assert array.tobytes() == getattr(other.worlds.record, name).tobytes(), name
    assert waited > 100


def straight_on(speed, *, task=Task(), goals=1, num_havs=1, worlds=1):
    """Return a batch of HAVs that drive along x at a speed, 20 m apart, 3 m before their goals."""
    vehicle = OnAxle(actuators=LIMITS)
    batch = open_plane(worlds, num_havs, 2, task=task, vehicle=vehicle, goals=goals)
    limit(batch.worlds, speed=10.0)
    for agent in range(num_havs):
        for w in range(worlds):
            put(batch.worlds, [3.0, 4.0, 2.0], 0.0, 20.0 * agent, w=w, agent=agent)
        aim(batch.worlds, agent, slice(None), 3.0, 20.0 * agent, 0.0)
    batch.worlds.state.speed[:] = speed
    return batch


def on_until_hit(batch, speed):
    """Drive at this speed until all wait; return how many steps that took."""
    shape = batch.worlds.state.x.shape
    for step in range(1, 100):
        batch.step(np.full(shape, speed), np.zeros(shape))
        if batch.worlds.state.waiting.all():
            return step
    raise AssertionError("nobody hit a goal")


def test_a_hav_at_its_goal_brakes_with_its_wheels_held_and_goes_on_waiting():
    batch = straight_on(2.0)
    state, record = batch.worlds.state, batch.worlds.record
    # one step to the left, so that there is an angle to be held
    batch.step(np.array([[2.0]]), np.array([[0.02]]))
    while not state.waiting[0, 0]:
        batch.step(np.array([[2.0]]), np.array([[0.02]]))
    at, path, moved = state.x[0, 0], record.total[0, PATH, 0], record.total[0, MOVED, 0]
    hit, step = record.goal[0, 0, HIT_STEP, 0], state.clock[0, 0]
    assert hit == step
    speeds = []
    for _ in range(10):
        batch.step(np.array([[9.0]]), np.array([[-0.5]]))
        speeds.append(state.speed[0, 0])
        assert state.steering[0, 0] == 0.02
        assert state.waiting[0, 0]
    # from 2 m/s by 0.4 m/s in each step
    assert speeds == pytest.approx([1.6, 1.2, 0.8, 0.4, *[0.0] * 6], abs=1e-12)
    assert record.total[0, PATH, 0] - path == pytest.approx(0.2 * 4.0)
    assert state.x[0, 0] - at == pytest.approx(0.8, abs=1e-2)
    assert math.hypot(state.x[0, 0] - 3.0, state.y[0, 0]) > 0.3
    assert record.total[0, MOVED, 0] == moved
    assert record.goal[0, 0, HIT_STEP, 0] == hit


def test_lanes_in_which_a_hav_has_come_to_rest_stand_beside_those_in_which_it_rolls():
    batch = straight_on(0.0, worlds=40)
    state = batch.worlds.state
    state.waiting[:] = True
    state.speed[0] = np.arange(40) % 5 * 0.4
    way = 0.2 * np.array([0.0, 0.0, 0.4, 1.2, 2.4])  # the speeds of all steps in which it brakes
    for _ in range(6):
        batch.step(np.full((1, 40), 5.0), np.zeros((1, 40)))
    assert state.waiting.all()
    assert not state.speed.any()
    assert state.x[0] == pytest.approx(way[np.arange(40) % 5], abs=1e-12)


def test_a_braking_hav_is_sensed_at_its_speed_and_a_standing_one_at_none():
    batch = straight_on(2.0, num_havs=2, task=Task(sensing_range=100.0))
    on_until_hit(batch, 2.0)
    for speed in (2.0, 1.6, 1.2, 0.8, 0.4, 0.0, 0.0):
        assert own_speed(batch.worlds, 0, 0) == pytest.approx(speed, abs=1e-12)
        assert neighbor_speed(batch.worlds, 1, 0, 0) == own_speed(batch.worlds, 0, 0)
        batch.step(np.zeros((2, 1)), np.zeros((2, 1)))


def test_what_was_commanded_to_an_instant_hav_that_waits_is_not_sensed():
    batch = open_plane(1, 2, task=Task(sensing_range=100.0))
    put(batch.worlds, [3.0, 4.0], agent=0)
    put(batch.worlds, [3.0, 4.0], 0.0, 20.0, agent=1)
    batch.step(np.ones((2, 1)), np.full((2, 1), 0.3))
    assert own_speed(batch.worlds, 0, 0) == 1.0
    assert own_steering(batch.worlds, 0, 0) == 0.3
    batch.worlds.state.waiting[0] = True
    assert own_speed(batch.worlds, 0, 0) == own_steering(batch.worlds, 0, 0) == 0.0
    assert neighbor_speed(batch.worlds, 1, 0, 0) == 0.0
    batch.step(np.ones((2, 1)), np.full((2, 1), 0.3))
    assert own_speed(batch.worlds, 0, 0) == own_steering(batch.worlds, 0, 0) == 0.0


def test_a_next_goal_finds_a_hav_that_rolls_and_it_drives_on_from_its_speed():
    batch = straight_on(2.0, goals=2, task=Task(next_goal="alone"))
    state = batch.worlds.state
    batch.worlds.goals[0, 1, :, 0] = 50.0, 0.0, 0.0
    while state.goal[0, PHASE, 0] == 0:
        batch.step(np.array([[2.0]]), np.zeros((1, 1)))
    assert not state.waiting[0, 0]
    batch.step(np.array([[9.0]]), np.zeros((1, 1)))
    assert state.speed[0, 0] == pytest.approx(2.2)


def test_a_removed_hav_stops_where_nobody_is():
    batch = straight_on(4.0, task=Task(on_goal="remove", distance_tolerance=1.0))
    state, total = batch.worlds.state, batch.worlds.record.total
    on_until_hit(batch, 4.0)
    assert state.speed[0, 0] == 4.0
    path, places = total[0, PATH, 0], []
    for _ in range(3):
        batch.step(np.full((1, 1), 9.0), np.full((1, 1), 0.5))
        places.append(state.x[0, 0])
        assert state.speed[0, 0] == 0.0
    assert total[0, PATH, 0] == path
    assert min(places) == max(places) > 1e12


@pytest.mark.parametrize("actuators", [Instant(), Limited(*[1e9] * 4)], ids=["instant", "limited"])
def test_a_goal_is_hit_at_most_as_fast_as_the_task_says(actuators):
    task = Task(goal_speed=0.5, distance_tolerance=1.0)
    batch = open_plane(3, task=task, vehicle=OnAxle(actuators=actuators))
    limit(batch.worlds, speed=2.0)
    for w in range(3):
        put(batch.worlds, [3.0, 4.0], w=w)
    aim(batch.worlds, 0, slice(None), 1.5, 0.0, 0.0)
    for _ in range(20):
        batch.step(np.array([[0.501, 0.5, 0.1]]), np.zeros((1, 3)))
    assert batch.worlds.state.waiting[0].tolist() == [False, True, False]
    # the misses of the first are those before it is near: too fast is no miss
    assert batch.worlds.record.miss[0, 0, :, MISS_COUNT, 0].tolist() == [0.0, 4.0]
    batch.worlds.state.x[0, 0] = 1.5
    batch.step(np.array([[0.0, 0.0, 0.0]]), np.zeros((1, 3)))
    assert batch.worlds.state.waiting[0].tolist() == [True, True, False]


@pytest.mark.parametrize(
    ("actuators", "error", "told"),
    [
        (Limited(braking=-1.0), ValueError, "actuators braking is -1.0, but must be at least"),
        (Limited(lateral=math.nan), ValueError, "actuators lateral is nan, but must be"),
        (Limited(steering_rate="1"), TypeError, "actuators steering_rate is 1, a str"),
        (3, TypeError, "vehicle actuators is 3, but must be Instant or Limited"),
        (Limited, TypeError, "vehicle actuators is <class '.*Limited'>, but must be Instant or"),
        (Task(), TypeError, "vehicle actuators is Task"),
    ],
)
def test_what_are_no_actuators_is_refused_by_name(actuators, error, told):
    with pytest.raises(error, match=f"^{told}"):
        check_vehicle(OnAxle(actuators=actuators))
