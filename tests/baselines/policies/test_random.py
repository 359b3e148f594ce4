"""Random actions fill the limits of a HAV, and the same episode gives the same ones."""

import numpy as np
import pytest

from baselines.policies.random import Random
from hav_env import Batch, RandomFleet, RandomPoses
from hav_env.policies.interface import allocate_memory, decide


@pytest.mark.parametrize("hold", [1, 5])
def test_random_actions_fill_the_limits_and_repeat(hold):
    def actions():
        fleet = RandomFleet(speed_max=0.7, steering_max=0.4)
        batch = Batch(RandomPoses(num_havs=2, fleet=fleet), 3)
        batch.reset(3)
        memory, taken = allocate_memory(Random(), 2, 3), []
        for _ in range(300):
            taken.append(decide(Random(hold), memory, batch))
            batch.step(*taken[-1])
        return np.array(taken)  # (T, 2, N, W)

    one = actions()
    assert (one == actions()).all()
    assert 0.0 <= one[:, 0].min() < 0.05
    assert 0.65 < one[:, 0].max() <= 0.7
    assert -0.4 <= one[:, 1].min() < -0.35
    assert 0.35 < one[:, 1].max() <= 0.4
    changes = (np.diff(one, axis=0) != 0.0).any(axis=1)
    held = (np.arange(1, 300) % hold != 0)[:, None, None]
    assert (changes == ~held).all()
    flat = one[::hold].reshape(-1, 12)
    assert len(np.unique(flat)) == flat.size  # no two HAVs or worlds draw alike
