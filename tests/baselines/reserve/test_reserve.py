"""Reserve neither jackknifes nor collides: an independent audit checks every step."""

import math
from typing import NamedTuple

import gymnasium as gym
import numpy as np
import pytest

from baselines.policies.reserve import Reserve
from baselines.policies.reserve.preconditions import check_predicted
from hav_env import (
    Batch,
    Limited,
    OffAxle,
    OnAxle,
    RandomFleet,
    RandomPoses,
    Rectangles,
    Task,
    explicit,
)
from hav_env.evaluation.rollout import rollout
from hav_env.policies.checks import check_policy
from hav_env.policies.driver import PolicyDriver
from tests.support.audit import Audit, drive
from tests.support.budgets import COMPILED, budget


@pytest.mark.parametrize(("num_havs", "area_factor"), [(2, 4.0), (2, 2.0), (5, 2.0), (10, 2.0)])
def test_no_jackknife_and_no_collision(num_havs, area_factor):
    scenario = RandomPoses(num_havs=num_havs, area_factor=area_factor)
    drive(scenario, 11, range(budget(6, 1)), budget(1200, 5)).approve()


def test_a_hav_that_is_alone_arrives_at_both_goals_and_never_jackknifes():
    episodes = range(budget(20, 1))
    seen = drive(RandomPoses(num_havs=1), 12, episodes, budget(3000, 20))
    assert seen.largest.max() < np.pi / 2 - Reserve().articulation_margin + 1e-9
    assert budget(seen.worlds.state.waiting.all(), True)


@pytest.mark.parametrize(
    ("task", "vehicle", "said"),
    [
        (Task(dt=0.1), OnAxle(), "policy dt is 0.2, but must be the task's, 0.1"),
        (Task(distance_tolerance=0.2), OnAxle(), "policy distance_tolerance is 0.5, but must be"),
        (Task(distance_tolerance=1.0), OnAxle(), "policy distance_tolerance is 0.5, but must be"),
        (Task(heading_tolerance=0.05), OnAxle(), "policy heading_tolerance is 0.1, but must be"),
        (Task(), OnAxle(simultaneous=True), "but Reserve has its proof for OnAxle"),
        (Task(), OnAxle(actuators=Limited()), "but Reserve has its proof for OnAxle"),
        (Task(), OnAxle(bodies=Rectangles()), "but Reserve has its proof for OnAxle"),
        (Task(), OffAxle(), "vehicle is OffAxle, but Reserve has its proof for OnAxle"),
        (Task(), OffAxle(integrator="euler"), "but Reserve has its proof for OnAxle"),
        (Task(goal_speed=0.9), OnAxle(), "task goal_speed is 0.9, but must be at least speed_max"),
    ],
)
def test_rules_that_it_does_not_know_are_refused(task, vehicle, said):
    scenario = RandomPoses(num_havs=2)
    with pytest.raises(ValueError, match=said):
        rollout(Reserve(), scenario, 1, np.arange(1), task, vehicle)
    with pytest.raises(ValueError, match=said):
        PolicyDriver("reserve", Batch(scenario, 1, task, vehicle))
    check_policy(Reserve(distance_tolerance=1.0), scenario, Task(distance_tolerance=1.0))


def test_parts_of_other_classes_are_other_parts():
    """Tuples without fields are equal, whatever their classes."""

    class Coasting(NamedTuple):
        """Actuators of another class."""

    assert OnAxle(actuators=Coasting()) == OnAxle()
    check_predicted(OnAxle())
    with pytest.raises(ValueError, match=r"actuators=Coasting\(\)\), but Reserve has its proof"):
        check_predicted(OnAxle(actuators=Coasting()))


def one_fleet(**limits):
    return RandomPoses(num_havs=2, fleet=RandomFleet(**limits))


@pytest.mark.parametrize(
    ("scenario", "task", "said"),
    [
        (one_fleet(), Task(sensing_range=0.0), "sensing_range is 0 m, but must be at least 0.4 m"),
        (one_fleet(speed_max=3.0), Task(sensing_range=1.0), "must be at least 1.2 m"),
        (one_fleet(), Task(dt=10.0), "a step of 10 m, but must be at most 4 m, twice the shortest"),
        (one_fleet(speed_max=100.0), Task(), "a step of 20 m, but must be at most 4 m"),
        (one_fleet(speed_max=1e3), Task(), "a step of 200 m, but must be at most 4 m"),
        (one_fleet(speed_max=1e-5), Task(), "a step of 2e-06 m, but must be at least"),
        (one_fleet(speed_max=1e-9), Task(), "a step of 2e-10 m, but must be at least"),
        (one_fleet(), Task(dt=1e-3), "a step of 0.001 m, but must be at least"),
        (one_fleet(steering_max=0.001), Task(), "which steering_max 0.001 rad"),
        (one_fleet(articulation_max=0.02), Task(), "two turns of a circle of radius"),
    ],
)
def test_what_the_theorems_assume_is_checked(scenario, task, said):
    with pytest.raises(ValueError, match=said):
        check_policy(Reserve(dt=task.dt), scenario, task)


@pytest.mark.parametrize(
    ("policy", "said"),
    [
        (Reserve(part=0.1), "a step of 0.2 m, but must be at most policy part, 0.1 m"),
        (Reserve(margin=0.0), "policy margin is 0.0, but must be at least 0.01 m"),
    ],
)
def test_what_leaves_no_part_or_no_margin_is_refused(policy, said):
    with pytest.raises(ValueError, match=said):
        check_policy(policy, one_fleet())


@pytest.mark.parametrize(
    ("limit", "longest", "trailers", "share"),
    [(90.0, 0.6, 1, 1.99), (90.0, 0.6, 1, 2.0), (120.0, 0.6, 1, 1.4), (160.0, 0.6, 1, 0.7)],
)
def test_no_joint_folds_through_within_one_step(limit, longest, trailers, share):
    """Cosines did not show that an articulation had jumped across the forbidden ones."""
    fleet = RandomFleet(
        **{"max_trailers": trailers, "min_length": 0.5, "max_length": longest},
        **{"short_truck_mean": 0.55, "long_truck_mean": 0.6, "speed_max": share * 0.5 / 0.2},
        **{"steering_max": math.radians(58.0), "articulation_max": math.radians(limit)},
    )
    scenario = RandomPoses(num_havs=1, num_goals=3, fleet=fleet)
    seen = drive(scenario, 11, range(budget(24, 1)), budget(600, 3), policy=Reserve(shortlists=4))
    assert seen.largest.max() < math.radians(limit)


def test_an_explicit_scenario_is_measured_by_its_own_units():
    short = explicit([[4.0, 0.05]], [[0, 0, 0]], [[[50, 0, 0]]])
    with pytest.raises(ValueError, match=r"must be at most 0\.1 m, twice the shortest unit"):
        check_policy(Reserve(), short)
    check_policy(Reserve(), explicit([[4.0, 0.3]], [[0, 0, 0]], [[[50, 0, 0]]]))


def test_a_margin_that_leaves_no_articulation_is_refused():
    scenario = RandomPoses(fleet=RandomFleet(articulation_max=math.radians(1.0)))
    with pytest.raises(ValueError, match="articulation_margin"):
        check_policy(Reserve(), scenario)


def test_round_a_hav_that_its_learner_leaves_standing_the_others_arrive():
    env = gym.make("hav_env:HAVSingle-v0", num_havs=4, others="reserve", max_steps=budget(4000, 10))
    env.reset(seed=8)
    process = env.unwrapped._world.process
    audit, over = Audit(process.batch.worlds), False
    while not over:
        *_, terminated, truncated, _ = env.step(np.array([-1.0, 1.0], np.float32))
        audit.look()
        over = terminated or truncated
    audit.approve()
    assert not process.driver.memory[0].any()  # it does not broadcast
    if COMPILED:
        assert process.batch.worlds.state.waiting[:, 0].tolist() == [False, True, True, True]
