"""This module scores policies on the same episodes: ``evaluate("avoid_jack", "reserve")``."""

import os
from typing import NamedTuple

import numpy as np
import pyarrow as pa

from hav_env.evaluation.comparison import compare
from hav_env.evaluation.rollout import rollout
from hav_env.models.protocols import Policy, Scenario, Vehicle
from hav_env.policies.names import make_policy
from hav_env.scenarios.presets import scenario_of
from hav_env.vehicles import OnAxle
from hav_env.world.task import Task


class Evaluation(NamedTuple):
    """The episodes of several policies; printed, it is a table of figures in Markdown."""

    names: list[str]
    """Names of the policies."""
    tables: list[pa.Table]
    """Of each policy one row for each HAV and episode; columns as in docs/metrics.md."""

    def rows(self) -> list[list[str]]:
        """Return the table of figures as text, a row for each figure, the names first.

        Behind every policy but the first stands how much it differs from the first on the same
        HAVs of the same episodes, with its 95 % interval; a star says that it excludes zero.
        """
        return compare(self.names, self.tables)

    def __str__(self) -> str:
        """Return the table of figures in Markdown."""
        head, *rows = (f"| {' | '.join(row)} |" for row in self.rows())
        return "\n".join([head, f"|{'---|' * (len(self.names) + 1)}", *rows])


def evaluate(
    *policies: Policy | str | os.PathLike[str],
    scenario: Scenario | str | os.PathLike[str] = "paper-pair",
    episodes: int = 100,
    seed: int = 0,
    num_havs: int | None = None,
    task: Task = Task(),
    vehicle: Vehicle | str = OnAxle(),
    threads: int | None = None,
) -> Evaluation:
    """Run policies on the same episodes.

    Args:
        policies: at least one: names, paths of policy files, ``module:Class``, or policies.
        scenario: a name, the path of a file, ``module:Class``, or a scenario.
        episodes: how many, with the numbers 0, 1, ... of the seed.
        seed: of the episodes, from 0 to 2**32 - 1.
        num_havs: how many HAVs the scenario has, if not as many as by default.
        task: the rules of an episode.
        vehicle: the kinematics: a name, ``module:Class``, or a vehicle.
        threads: how many; by default ``HAV_THREADS`` or all cores. Results do not depend on it.

    Raises:
        ValueError, TypeError: when an argument is not allowed, naming it.
        PlacementError: when the scenario has no room for its HAVs.
    """
    if not policies:
        raise ValueError("evaluate needs at least one policy")
    made = [make_policy(policy) for policy in policies]
    chosen = scenario_of(scenario, num_havs)
    numbers = np.arange(episodes)
    tables = [rollout(policy, chosen, seed, numbers, task, vehicle, threads) for policy in made]
    names = [p if isinstance(p, str) else type(p).__name__ for p in policies]
    return Evaluation(names, tables)
