"""This module computes ratios of times to shortest times; HAVs that never arrive count at the cap.

A world is the unit: its time is the sum of the times of its HAVs, and so is its shortest time.
"""

from typing import NamedTuple

import numpy as np
import pyarrow as pa

from baselines.evaluation.feasibility import column, shortest_times
from hav_env.evaluation.figures import goals_of


class WorldTimes(NamedTuple):
    """The times of the worlds of a table, in the order of episodes."""

    driven: np.ndarray
    """(W,) sum over the HAVs of the steps until they arrived; the cap for those that never did."""
    shortest: np.ndarray
    """(W,) sum over the HAVs of the steps of their shortest paths."""


def world_times(table: pa.Table, fleet, cap: int) -> WorldTimes:
    """Return the times of worlds, as in README's table of the survey.

    The time of a lone HAV runs to its last goal, and its shortest path has the truck's own radius.
    The time of HAVs in company runs to their first goals, because the next ones begin for all of
    them together. Their shortest paths have the radius on which trailers can also drive without
    end.

    Args:
        table: Table of ``hav_env.evaluation.rollout``, whole episodes.
        fleet: Fleet of the scenario, for the limits of speed and steering.
        cap: Largest number of steps of an episode.
    """
    num_havs = int(np.max(table["hav"].to_numpy())) + 1
    steep, stable = shortest_times(table, fleet)
    goals = goals_of(table.column_names)
    timed, shortest = (goals[-1], steep.sum(0)) if num_havs == 1 else (1, stable[0])
    arrived = column(table, f"goal_{timed}_step")
    driven = np.where(np.isfinite(arrived), arrived, float(cap))
    worlds = (values.reshape(-1, num_havs).sum(1) for values in (driven, shortest))
    return WorldTimes(*worlds)
