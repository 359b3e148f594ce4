"""An episode recorded is the episode that was rolled out."""

import numpy as np
import pytest

from baselines.policies.avoid_jack import AvoidJack
from baselines.replay.trajectory import chain_points, record_trajectory
from hav_env import RandomPoses, Task
from hav_env.evaluation.rollout import rollout

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
