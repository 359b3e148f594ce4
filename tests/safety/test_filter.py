"""No HAV jackknifes or collides under the filter, whatever the commands: an independent audit."""

from typing import NamedTuple

import numpy as np
import pytest

import hav_env
from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.dubins_pursuit import DubinsPursuit
from hav_env import (
    Filtered,
    OffAxle,
    OnAxle,
    Rectangles,
    SafetyFilter,
    Task,
    build_site,
    explicit,
    find_scenario,
    rollout,
)
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.safety import check_safety
from hav_env.safety.keeping_apart import has_right_of_way
from hav_env.vehicles import VEHICLES
from tests.support.audit import Audit, drive
from tests.support.budgets import budget
from tests.support.obstacles import touching_walls


class Own(NamedTuple):
    """Actuators of a user."""


def at_random(process, rng):
    """Return actions that change the speed at random, and steer hard one way or the other."""
    shape = process.num_worlds, process.num_controlled
    speed = rng.choice([-1.0, -0.99, 0.0, 1.0], shape) * rng.choice([1.0, 0.7], shape)
    return np.stack([speed, rng.choice([-1.0, 0.3, 1.0], shape)], axis=-1)


def at_each_other(process, rng):
    """Return actions at full speed that steer every HAV to the nearest other one."""
    state = process.batch.worlds.state
    here = state.x + 1j * state.y
    way = here[None] - here[:, None]
    way[np.arange(len(here)), np.arange(len(here))] = np.inf
    nearest = np.take_along_axis(way, np.abs(way).argmin(axis=1)[:, None], axis=1)[:, 0]
    bearing = np.angle(nearest * np.exp(-1j * state.heading[:, 0]))
    return np.stack([np.ones(here.shape), np.clip(3.0 * bearing, -1.0, 1.0)], axis=-1).swapaxes(
        0, 1
    )


def run(process, steps, choose, hold=5, seed=1):
    """Drive worlds by the test's own rule, and return their audit and the outcome."""
    process.begin(
        np.full(process.num_worlds, seed),
        np.arange(process.num_worlds),
        np.ones(process.num_worlds, np.bool_),
        outcome := process.outcome(),
    )
    rng, audit = np.random.default_rng(seed), Audit(process.batch.worlds)
    for step in range(steps):
        if step % hold == 0:
            actions = np.ascontiguousarray(choose(process, rng))
        outcome = process.step(actions, outcome)
        audit.look()
    return audit, dict(zip(process.info, outcome.info, strict=True))


@pytest.mark.parametrize("choose", [at_random, at_each_other])
@pytest.mark.parametrize(
    "scenario", ["paper-pair", pytest.param("dense-10", marks=pytest.mark.exhaustive)]
)
def test_no_command_jackknifes_or_collides(scenario, choose):
    process = DecisionProcess(budget(24, 2), scenario=scenario, safety="both", threads=1)
    audit, info = run(process, budget(500, 30), choose, hold=30)
    audit.approve()
    assert not info["jackknifed"].any()
    assert info["interventions"].sum() > 0.0 or budget(0, 1)


@pytest.mark.exhaustive
def test_without_the_filter_the_same_commands_end_in_both():
    process = DecisionProcess(budget(24, 2), scenario="dense-10", threads=1)
    audit, info = run(process, budget(500, 60), at_each_other, hold=30)
    assert info["jackknifed"].mean() > 0.01 or budget(0, 1)
    assert (np.minimum(audit.least, audit.between) <= 1e-9).any()
    assert "interventions" not in process.info


def two_that_meet(**rules):
    """Return a process of two HAVs that drive at each other, a few centimetres beside."""
    starts = [[0.0, 0.0, 0.0], [2.05, 0.03, np.pi + 0.03]]
    goals = [[[90.0, 0.0, 0.0]], [[-90.0, 0.0, np.pi]]]
    scenario = explicit([[1.0, 1.0], [1.0, 1.0]], starts, goals)
    return DecisionProcess(1, scenario=scenario, safety="both", task=Task(**rules), threads=1)


def test_havs_that_sense_too_little_stand():
    process = two_that_meet(sensing_range=0.02)
    audit, info = run(process, 20, lambda process, rng: np.ones((1, 2, 2)) * [1.0, 0.0])
    audit.approve()
    assert info["path_length"].sum() == 0.0
    assert (info["interventions"] == 20).all()
    audit, _ = run(two_that_meet(), 20, lambda process, rng: np.ones((1, 2, 2)) * [1.0, 0.0])
    audit.approve()


@pytest.mark.exhaustive
def test_a_hav_that_starts_on_an_obstacle_still_keeps_from_others():
    walls = [[[-2.0, 0.6], [1.0, 0.6]], [[9.0, -9.0], [9.0, 9.0]]]  # one along its body
    site = build_site(lines=walls)
    scenario = explicit([[2.0, 4.0]], [[0.0, 0.0, 0.0]], [[[90.0, 0.0, 0.0]]])
    scenario = scenario._replace(site=site)
    vehicle = OffAxle(bodies=Rectangles())
    process = DecisionProcess(1, scenario=scenario, safety="both", vehicle=vehicle, threads=1)
    _, info = run(process, 60, lambda process, rng: np.ones((1, 1, 2)) * [1.0, 0.0])
    assert info["obstacle_collision"].all()
    assert process.batch.worlds.state.x[0, 0] < 7.0


def drive_among_walls(process, steps):
    """Take actions at random, check that nothing happens at any step, and return the infos."""
    process.begin(
        np.full(process.num_worlds, 3),
        np.arange(process.num_worlds),
        np.ones(process.num_worlds, np.bool_),
        outcome := process.outcome(),
    )
    rng = np.random.default_rng(3)
    for step in range(steps):
        if step % 10 == 0:
            actions = at_random(process, rng)
        outcome = process.step(actions, outcome)
        assert not touching_walls(process.batch.worlds).any()
    info = dict(zip(process.info, outcome.info, strict=True))
    for event in ("obstacle_collision", "jackknifed", "actual_collision"):
        assert not info[event].any()
    return info


@pytest.mark.exhaustive
@pytest.mark.parametrize("scenario", ["field-1", "gate-2"])
def test_no_hav_hits_an_obstacle(scenario):
    settings = {"vehicle": OffAxle(bodies=Rectangles()), "scenario": scenario, "threads": 1}
    process = DecisionProcess(budget(16, 2), safety="both", **settings)
    drive_among_walls(process, budget(250, 10))


@pytest.mark.exhaustive
def test_a_filtered_policy_drives_as_it_does_in_filtered_environments():
    task = Task(max_steps=budget(600, 40))
    policy = Filtered(DubinsPursuit(), task=task)
    table = rollout(policy, "paper-pair", 5, np.arange(budget(16, 2)), task)
    process = DecisionProcess(budget(16, 2), scenario="paper-pair", safety="both", task=task)
    process.begin(
        np.full(process.num_worlds, 5),
        np.arange(process.num_worlds),
        np.ones(process.num_worlds, np.bool_),
        outcome := process.outcome(),
    )
    driver = hav_env.PolicyDriver(DubinsPursuit(), process.batch)
    limit = process.batch.worlds.fleet.limit
    for _ in range(task.max_steps):
        speed, steering = driver.decide()
        actions = np.stack([2.0 * speed / limit[:, 0] - 1.0, steering / limit[:, 1]], axis=-1)
        outcome = process.step(np.ascontiguousarray(actions.swapaxes(0, 1)), outcome)
    info = dict(zip(process.info, outcome.info, strict=True))
    assert np.array_equal(table["interventions"], info["interventions"].T.ravel())
    assert np.array_equal(table["path_length"], info["path_length"].T.ravel())
    assert info["interventions"].sum() > 0


@pytest.mark.exhaustive
@pytest.mark.parametrize("policy", [DubinsPursuit(), AvoidJack()])
def test_filtered_policies_neither_jackknife_nor_collide(policy):
    task = Task()
    audit = drive(
        find_scenario("dense-5" if budget(1, 0) else "paper-pair"),
        23,
        range(budget(12, 1)),
        budget(1_500, 60),
        policy=Filtered(policy),
        task=task,
    )
    audit.approve()


@pytest.mark.exhaustive
def test_results_are_the_same_on_any_number_of_threads():
    tables = [
        rollout(Filtered(AvoidJack()), "dense-5", 3, np.arange(budget(20, 3)), threads=threads)
        for threads in (1, 2)
        if budget(1, 0) or threads == 1
    ]
    assert all(table.equals(tables[0]) for table in tables)
    assert tables[0].num_rows == 5 * budget(20, 3)


def test_exactly_one_of_two_has_the_right_of_way():
    process = DecisionProcess(1, scenario="paper-pair", safety=SafetyFilter(turn=3), threads=1)
    process.begin(np.zeros(1, int), np.zeros(1, int), np.ones(1, bool), process.outcome())
    world, seen = process.batch.worlds, []
    for step in range(12):
        world.state.clock[0] = step
        ways = [has_right_of_way(process.safety, world, i, 1 - i, 0) for i in (0, 1)]
        assert sum(ways) == 1
        seen.append(ways[0])
    assert seen == [True] * 3 + [False] * 3 + [True] * 3 + [False] * 3


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ({"safety": "none"}, "safety is 'none', but must be jackknife or collision or both"),
        ({"safety": 1}, "safety is 1, but must be None, a SafetyFilter"),
        ({"safety": SafetyFilter(horizon=0)}, "horizon is 0, but must be"),
        ({"safety": "both", "vehicle": "limited", "backup": "reserve"}, "Reserve has its proof"),
    ],
)
def test_errors_name_the_argument_and_what_is_allowed(arguments, told):
    with pytest.raises((ValueError, TypeError), match=told.replace("(", r"\(")):
        DecisionProcess(1, scenario="paper-pair", **arguments)


def test_actuators_that_the_filter_cannot_stop_are_refused():
    with pytest.raises(ValueError, match=r"actuators is Own\(\), but must be Instant or Limited"):
        check_safety(SafetyFilter(), Task(), OnAxle(actuators=Own()))


def test_a_vehicle_that_may_move_in_another_way_is_refused():
    class Sliding(OnAxle):
        """It moves sideways."""

    with pytest.raises(ValueError, match=r"vehicle is Sliding.*must be OnAxle or OffAxle"):
        check_safety(SafetyFilter(), Task(), Sliding())


def test_a_filtered_policy_refuses_other_rules_than_its_own():
    with pytest.raises(ValueError, match="policy task is"):
        rollout(Filtered(AvoidJack(), task=Task()), "paper-pair", 0, [0], Task(max_steps=10))
    policy = Filtered(AvoidJack(), vehicle=OnAxle())
    with pytest.raises(ValueError, match="policy vehicle is"):
        rollout(policy, "paper-pair", 0, [0], vehicle=OnAxle(substeps=2))
    policy, task = Filtered(AvoidJack(), vehicle=VEHICLES.make("limited")), Task(order="in_turn")
    with pytest.raises(ValueError, match="must be 'at_once' where safety is on"):
        rollout(policy, "paper-pair", 0, [0], task, vehicle=policy.vehicle)
