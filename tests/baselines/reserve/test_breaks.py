"""Examples that once violated Reserve's guarantees."""

import math

import numpy as np
import pytest

from baselines.policies.reserve import Reserve
from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import states
from baselines.policies.reserve.renewal import recheck_reservation
from hav_env import Batch, RandomFleet, RandomPoses, Task, explicit
from hav_env.policies.driver import PolicyDriver
from tests.baselines.reserve.test_attacks import Others, Stops
from tests.support.audit import drive
from tests.support.budgets import budget

STEEP = math.radians(50.0)


@pytest.mark.parametrize(
    "num_havs", [2, *(pytest.param(havs, marks=pytest.mark.exhaustive) for havs in (1, 5))]
)
def test_who_stood_against_its_own_command_takes_the_step_back(num_havs):
    """The HAV counted the step as driven, steered too tightly, and broadcast a wrong frame."""
    scenario = RandomPoses(num_havs=num_havs, area_factor=2.0)
    stops = Stops(1, often=0.02, long=60)
    drive(scenario, 11, range(budget(20, 1)), budget(800, 2), interfere=stops).approve()


@pytest.mark.parametrize(
    "x", [25.3, *(pytest.param(x, marks=pytest.mark.exhaustive) for x in (25.2, 25.4))]
)
def test_an_old_acquaintance_is_a_newcomer(x):
    """HAV 0 knew the other one in the first phase, and had it in range again one step too late."""
    scenario = explicit(
        [[12.0, 2.0], [12.0, 2.0]],
        [[0.0, 0.0, 0.0], [8.0, 13.0, 0.0]],
        [[[0.9, 0.0, 0.0], [60.0, 0.0, 0.0]], [[x, 0.4, np.pi], [-40.0, 0.4, np.pi]]],
        steering_max=STEEP,
    )
    drive(scenario, 1, [0], budget(900, 3), task=Task(sensing_range=1.0)).approve()


def ring(tip):
    """Return a scenario: a HAV that can only go round one that stands, walled in by four others."""
    radius, inside = 1.02 * 12.0, 17.7
    lengths = [[4.0, 12.0], [tip - 0.85, 0.3], *[[2.0 * inside - 1.0, 0.3]] * 4]
    start = [[0.0, 0.0, 0.0], [0.0, radius + 0.85, np.pi / 2]]
    for heading in np.pi / 2 * np.arange(4):
        along, across = np.array([np.cos(heading), np.sin(heading)]), inside - 0.5
        rear = inside * np.array([along[1], -along[0]]) - across * along + [0.0, radius]
        start.append([*rear, heading])
    goals = [[[300.0 + 40.0 * k, 300.0, 0.0]] for k in range(6)]
    return explicit(lengths, start, goals, steering_max=STEEP)


@pytest.mark.parametrize("tip", [2.6, pytest.param(2.9, marks=pytest.mark.exhaustive)])
def test_a_circle_is_not_periodic_after_two_rounds(tip):
    """The trailer closed in on the circle's centre for many rounds, and hit a standing HAV."""
    drive(ring(tip), 1, [0], budget(2000, 1), interfere=Others(1)).approve()


@pytest.mark.parametrize(
    "degrees",
    [20.0, *(pytest.param(bound, marks=pytest.mark.exhaustive) for bound in (75.0, 45.0))],
)
def test_joints_with_less_freedom_need_wider_circles(degrees):
    """The circle to drive on without end was as tight as joints of 90 degrees allow."""
    fleet = RandomFleet(articulation_max=math.radians(degrees))
    scenario = RandomPoses(num_havs=3, area_factor=2.0, fleet=fleet)
    drive(scenario, 3, range(budget(16, 1)), budget(800, 2)).approve()


def test_nothing_is_reserved_anew_where_not_everybody_had_a_slot():
    """When another HAV came near, the new outline was compared with those in the slots only."""
    batch = Batch(RandomPoses(num_havs=2), 1)
    batch.reset(0)
    driver = PolicyDriver(Reserve(), batch)
    for _ in range(3):
        batch.step(*driver.decide())
    rows = np.ascontiguousarray(driver.memory[0, :, 0])
    assert rows[m.MODE] == states.RESERVED
    rows[m.NUM_SLOTS], rows[m.NEWCOMERS], rows[m.COVERED_RADIUS] = 0.0, 1.0, 10.0
    assert rows[m.OUTLINE_RADIUS] > 10.0
    recheck_reservation(Reserve(), rows)
    assert rows[m.HELD] == 0.0


def test_more_others_than_slots():
    fleet = RandomFleet(max_trailers=2)
    scenario = RandomPoses(num_havs=budget(40, 4), area_factor=2.0, fleet=fleet)
    task = Task(sensing_range=10.0)
    drive(scenario, 3, range(budget(4, 1)), budget(1500, 3), task=task).approve()
