"""The recorded episode that tests of films and pages share."""

import pytest

from baselines.policies.avoid_jack import AvoidJack
from baselines.replay.trajectory import Trajectory, record_trajectory
from hav_env import RandomPoses, Task


@pytest.fixture(scope="package")
def trajectory() -> Trajectory:
    """Return a pair that evades each other, from step 330 on."""
    return record_trajectory(AvoidJack(), RandomPoses(num_havs=2), 0, 5, Task(max_steps=400))
