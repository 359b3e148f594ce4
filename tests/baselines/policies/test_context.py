"""Context steering neither jackknifes nor collides, and decides only on the HAV's sensing."""

import numpy as np
import pytest

from baselines.policies.context import Context
from hav_env import Batch, Limited, OnAxle, RandomPoses, Task, evaluate, find_scenario
from hav_env.policies.checks import check_policy
from hav_env.policies.driver import PolicyDriver
from hav_env.policies.interface import allocate_memory, decide
from hav_env.vehicles import OffAxle
from hav_env.world.arrays import INTERVENTIONS
from tests.support.audit import drive
from tests.support.budgets import budget
from tests.support.worlds import ALL, aim, open_plane, put, stand


@pytest.mark.exhaustive
@pytest.mark.parametrize(
    ("scenario", "worlds", "steps"),
    [("paper-pair", budget(24, 2), budget(1000, 40)), ("dense-5", budget(4, 1), budget(500, 10))],
)
def test_an_audit_finds_no_jackknife_and_no_collision(scenario, worlds, steps):
    audit = drive(find_scenario(scenario), 99, range(worlds), steps, policy=Context())
    assert audit.steps > 0
    audit.approve()


@pytest.mark.exhaustive
def test_the_filter_never_changes_a_slot_that_the_masks_leave():
    batch = Batch(find_scenario("paper-pair"), budget(16, 2))
    batch.reset(5)
    driver = PolicyDriver(Context(), batch)
    for _ in range(budget(400, 20)):
        batch.step(*driver.decide())
    assert not batch.worlds.record.total[:, INTERVENTIONS].any()


@pytest.mark.exhaustive
def test_decisions_do_not_depend_on_the_number_of_threads():
    episodes, task = budget(8, 2), Task(max_steps=budget(300, 10))
    one, three = (
        evaluate(Context(), scenario="dense-2", episodes=episodes, task=task, threads=threads)
        for threads in (1, 3)
    )
    assert one.tables[0].equals(three.tables[0])


def decision(far):
    """Return the decision of HAV 0 beside one HAV in range and one beyond it, this far away [m]."""
    batch = open_plane(1, 3, 4)
    for agent, (x, y) in enumerate([(0.0, 0.0), (12.0, 3.0), (far, 0.0)]):
        put(batch.worlds, [3.0, 4.0, 5.0], x, y, 0.0, agent=agent)
    aim(batch.worlds, ALL, ALL, 200.0, 40.0, 0.0)
    batch.worlds.state.waiting[:] = True
    stand(batch)
    batch.worlds.state.waiting[:] = False
    policy = Context()
    memory = allocate_memory(policy, *batch.worlds.state.x.shape)
    speed, steering = decide(policy, memory, batch)
    return speed[0, 0], steering[0, 0], memory[0, :, 0]


@pytest.mark.exhaustive
def test_a_hav_out_of_range_changes_nothing():
    (speed, steering, memory), other = decision(1e3), decision(3e3)
    assert (speed, steering) == other[:2]
    np.testing.assert_array_equal(memory, other[2])
    assert speed > 0.0


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"slots": 2}, "slots"),
        ({"slots": 8}, "slots"),
        ({"look": -1.0}, "look"),
        ({"widening": 0.5}, "widening"),
        ({"recovery": 0}, "recovery"),
        ({"every": 0}, "every"),
    ],
)
def test_parameters_out_of_range_are_refused(change, told):
    with pytest.raises(ValueError, match=told):
        check_policy(Context()._replace(**change), RandomPoses(2))


@pytest.mark.parametrize(
    ("task", "vehicle", "told"),
    [
        (Task(dt=0.1), None, "dt"),
        (Task(sensing_range=5.0), None, "sensing_range"),
        (Task(distance_tolerance=0.4), None, "distance_tolerance"),
        (Task(heading_tolerance=0.2), None, "heading_tolerance"),
        (Task(order="in_turn"), None, "order"),
        (Task(), OffAxle(), "vehicle"),
        (Task(), OnAxle(actuators=Limited()), "policy vehicle is"),
    ],
)
def test_rules_that_its_predictions_do_not_know_are_refused(task, vehicle, told):
    models = () if vehicle is None else (vehicle,)
    with pytest.raises(ValueError, match=told):
        check_policy(Context(), RandomPoses(2), task, *models)


def test_limited_actuators_are_refused():
    vehicle = OnAxle(actuators=Limited())
    with pytest.raises(ValueError, match=r"must be Instant\(\) under context steering"):
        check_policy(Context(vehicle=vehicle), RandomPoses(2), Task(), vehicle)
