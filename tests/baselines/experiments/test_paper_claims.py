"""Claims of the paper in words, counted in states one by one."""

import math

import pytest

from baselines.experiments.paper_claims import evading_in_misses
from baselines.policies.avoid_jack import AvoidJack
from baselines.replay.trajectory import record_trajectory
from hav_env import RandomPoses, Task
from tests.support.budgets import budget

WARY = AvoidJack(evasion_truck_share=1.0)
TASK = Task(distance_tolerance=3.0, heading_tolerance=0.7, max_steps=budget(6_000, 200))


@pytest.fixture(scope="module")
def recorded():
    """Return crowded episodes with wide tolerances, in which there are many close misses."""
    crowd = RandomPoses(num_havs=3, area_factor=1.2)
    return [record_trajectory(WARY, crowd, 5, episode, TASK) for episode in range(3)]


def test_evasion_in_close_misses_is_counted_state_by_state(recorded):
    evading = total = 0
    for trajectory in recorded:
        for t in range(len(trajectory.step)):
            for hav in range(3):
                if trajectory.waiting[t, hav]:
                    continue
                x, y, heading = trajectory.goals[hav, trajectory.phase[t, hav]]
                distance = math.dist((x, y), (trajectory.x[t, hav], trajectory.y[t, hav]))
                turn = abs(math.remainder(trajectory.heading[t, hav, 0] - heading, 2 * math.pi))
                missed = (distance < 3.0 and 0.7 <= turn < 1.4) or (
                    turn < 0.7 and 3.0 <= distance < 6.0
                )
                total += missed
                evading += missed and trajectory.evaded[t, hav] >= 0
    if budget(1, 0):
        assert total > evading > 0
    shown = f"{100 * evading / total:.1f} % of {total:,}" if total else "-"
    assert evading_in_misses(recorded, TASK) == shown
