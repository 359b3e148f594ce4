"""This module scores policies on the same episodes: ``evaluate("avoid_jack", "reserve")``."""

import os
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa

from hav_env.evaluation.comparison import compare, compare_differences
from hav_env.evaluation.rollout import rollout
from hav_env.models.changes import name_with_changes
from hav_env.models.protocols import Policy, Scenario, Vehicle
from hav_env.places import Site
from hav_env.policies.names import make_policy
from hav_env.scenarios import Explicit
from hav_env.scenarios.presets import scenario_of
from hav_env.simulator.guiding import Guidance
from hav_env.vehicles import OnAxle
from hav_env.world.task import Task

USUAL_SCENARIO = "paper-single"
"""The scenario of evaluations that name none."""
_USUAL_EPISODES = 1_000
_LONGEST_NAME = 50  # characters of a policy with its parameters, above a column


def usual_episodes(scenario: Scenario) -> int:
    """Return the number of episodes of evaluations that name none.

    It is 1 for an explicit scenario, whose episodes are all the same.
    """
    return 1 if isinstance(scenario, Explicit) else _USUAL_EPISODES


class Evaluation(NamedTuple):
    """The episodes of several policies; printed, a table of figures in Markdown."""

    names: list[str]
    """Names of the policies."""
    tables: list[pa.Table]
    """Table of each policy with one row for each HAV and episode; columns as in docs/metrics.md."""
    dt: float
    """Duration of a step [s]."""

    def rows(self) -> list[list[str]]:
        """Return the table of figures as text, one row for each figure after the row of names.

        Each value has its 95 % interval: behind ± its wider half, or both ends in brackets if that
        half would reach below 0 or above 100 %. A star marks a policy that differs from the first
        one on the same HAVs of the same episodes.
        """
        return compare(self.names, self.tables, self.dt)

    def differences(self) -> list[list[str]]:
        """Return the differences of each policy from the first one, with intervals."""
        return compare_differences(self.names, self.tables)

    def __str__(self) -> str:
        """Return the table of figures in Markdown."""
        head, *rows = (f"| {' | '.join(row)} |" for row in self.rows())
        return "\n".join([head, f"|{'---|' * (len(self.names) + 1)}", *rows])


def evaluate(
    *policies: Policy | str | os.PathLike[str],
    scenario: Scenario | str | os.PathLike[str] = USUAL_SCENARIO,
    episodes: int | None = None,
    seed: int = 0,
    num_havs: int | None = None,
    site: Site | str | os.PathLike[str] | None = None,
    fleet: Any = None,
    task: Task = Task(),
    vehicle: Vehicle | str = OnAxle(),
    threads: int | None = None,
    guidance: Guidance | str | None = None,
) -> Evaluation:
    """Run policies on the same episodes.

    Args:
        policies: At least one policy: names, paths of policy files, ``module:Class``, or policies.
        scenario: Scenario: a name, the path of a file, ``module:Class``, or a model.
        episodes: Number of episodes; they have the numbers 0, 1, ... of the seed. By default 1,000,
            or 1 for an explicit scenario, whose episodes are all the same.
        seed: Seed of the episodes, from 0 to 2**32 - 1.
        num_havs: Number of HAVs; by default the scenario's.
        site: Obstacles and bounds of the scenario: a ``Site`` or its file.
        fleet: Vehicles in place of the scenario's: names in the catalogue, or a fleet.
        task: The rules of an episode.
        vehicle: Kinematics: a name, ``module:Class``, or a model.
        threads: Number of threads; by default ``HAV_THREADS`` or all cores. Results do not depend
            on it.
        guidance: Guidance (routes to the goals): ``dubins``, ``lattice``, ``witness``,
            ``feasible``, or a model; by default the one that a policy needs.

    Raises:
        ValueError, TypeError: If an argument is invalid; the message names it.
        PlacementError: If the scenario cannot place its HAVs.
    """
    if not policies:
        raise ValueError("evaluate needs at least one policy")
    made = [make_policy(policy) for policy in policies]
    chosen = scenario_of(scenario, num_havs, site, fleet)
    numbers = np.arange(usual_episodes(chosen) if episodes is None else episodes)
    models = task, vehicle, threads, guidance
    tables = [rollout(policy, chosen, seed, numbers, *models) for policy in made]
    return Evaluation([_name_of(policy) for policy in policies], tables, task.dt)


def _name_of(policy: Any) -> str:
    """Return the name of a policy for a table, with the parameters that are not its defaults."""
    if isinstance(policy, str | os.PathLike):
        return os.fspath(policy)
    if isinstance(policy, type):
        return policy.__name__
    name = type(policy).__name__
    try:
        text = name_with_changes(name, policy, type(policy)())
    except TypeError:  # a parameter without a default
        return name
    return text if len(text) <= _LONGEST_NAME else name
