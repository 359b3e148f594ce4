"""A HAV leaves its path only for a shorter one, and saves as much as the policy states."""

import numpy as np

from baselines.policies.reserve import Reserve
from baselines.policies.reserve.memory import rows as m
from baselines.policies.reserve.memory import sizes, states
from hav_env import Batch, RandomPoses
from hav_env.policies.driver import PolicyDriver
from tests.support.budgets import budget

PATH = slice(m.CURRENT_PATH, m.CURRENT_PATH + m.LENGTHS + sizes.MAX_SEGMENTS)


def rest_of(memory):
    """Return the rest of the path of every HAV, (N, W) [m]."""
    counts = memory[:, m.CURRENT_PATH + m.NUM_SEGMENTS]
    lengths = memory[:, m.CURRENT_PATH + m.LENGTHS :][:, : sizes.MAX_SEGMENTS]
    used = np.arange(sizes.MAX_SEGMENTS)[:, None] < counts[:, None]
    return np.where(used, lengths, 0.0).sum(1) - memory[:, m.DRIVEN]


def test_a_shortcut_saves_what_it_must():
    policy, worlds = Reserve(shortcut=7.0), budget(6, 1)
    batch = Batch(RandomPoses(num_havs=8, area_factor=1.0), worlds)
    batch.reset(31)
    driver, shortcuts = PolicyDriver(policy, batch), 0
    for _ in range(budget(1500, 3)):
        before = driver.memory.copy()
        speed, steering = driver.decide()
        after = driver.memory
        changed = (before[:, PATH] != after[:, PATH]).any(1)
        # other new paths count as adopted, or lead round a circle or to another place
        kept = before[:, m.ADOPTED] == after[:, m.ADOPTED]
        goal = (before[:, m.PURPOSE] == states.GOAL_PATH) & (
            after[:, m.PURPOSE] == states.GOAL_PATH
        )
        moving = (before[:, m.MODE] == states.RESERVED) & (after[:, m.MODE] == states.RESERVED)
        same_goal = before[:, m.PLANNED_GOALS_LEFT] == after[:, m.PLANNED_GOALS_LEFT]
        cut = changed & kept & goal & moving & same_goal & (before[:, m.BLOCKED] == 0.0)
        # the path after the decision is already one step shorter
        saved = rest_of(before) - rest_of(after) - speed * policy.dt
        assert (saved[cut] >= policy.shortcut - 1e-9).all()
        shortcuts += cut.sum()
        batch.step(speed, steering)
    assert shortcuts >= budget(5, 0)
