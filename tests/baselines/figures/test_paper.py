"""The histograms of the paper's figures count the right HAVs."""

import numpy as np
import pytest
from matplotlib.patches import StepPatch

from baselines.figures.paper import draw_goal_histograms
from hav_env import RandomPoses, Task
from hav_env.evaluation.rollout import rollout
from tests.support.budgets import budget

EASY = Task(distance_tolerance=3.0, heading_tolerance=1.0, max_steps=budget(6_000, 60))


@pytest.mark.parametrize("next_goal", ["together", "alone"])
def test_steps_count_from_where_a_goal_was_set(next_goal):
    """Together, the second goal is set when both HAVs have hit the first; alone, at the own hit."""
    task = EASY._replace(next_goal=next_goal)
    table = rollout("avoid_jack", RandomPoses(num_havs=2), 3, np.arange(20), task)
    first, second = (table[f"goal_{g}_step"].to_numpy().reshape(-1, 2) for g in (1, 2))
    since = first if next_goal == "alone" else np.max(first, axis=1, keepdims=True)
    steps = (second - since)[~np.isnan(second)]
    if budget(1, 0):
        assert steps.size > 0
    panel = draw_goal_histograms(table, task).axes[2]
    drawn = [patch.get_data() for patch in panel.patches if isinstance(patch, StepPatch)][1]
    counts, _ = np.histogram(np.clip(steps, drawn.edges[0], drawn.edges[-1]), drawn.edges)
    np.testing.assert_allclose(drawn.values, counts / max(steps.size, 1))
