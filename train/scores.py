"""This module scores a policy while it trains, and at the end on fresh episodes."""

import pathlib
from typing import Any

import numpy as np
import pyarrow as pa

from baselines.policies.files import load_trained, save_policy
from baselines.policies.network import Network
from hav_env.evaluation.comparison import figures_of, measure
from hav_env.evaluation.figures import goal_hits
from hav_env.evaluation.rollout import rollout
from hav_env.scenarios.presets import scenario_of
from hav_env.vehicles import OnAxle
from hav_env.world.event_table import HARM

# seeds of episodes: those that the best policy is scored on at the end, those that it is chosen by,
# and the first of those to train on
SCORED, HELD_OUT, TRAINING = 0, 1, 1_000_000


def evaluate(
    policy: Network, scenario: Any, episodes: int, vehicle: Any = OnAxle()
) -> dict[str, float]:
    """Return the evaluator's figures of a policy on the first of the held-out episodes."""
    numbers = np.arange(episodes)
    return _figures(rollout(policy, scenario_of(scenario), HELD_OUT, numbers, vehicle=vehicle))


def score(figures: dict[str, float]) -> float:
    """Return by which number the best policy is chosen: goals, less what went wrong, twice."""
    goals = [figures[name] for name in goal_hits(list(figures))]
    harm = sum(figures.get(event.label, 0.0) for event in HARM)
    return float(np.mean(goals)) - 2.0 * harm


def conclude(
    path: pathlib.Path, scenario: Any, episodes: int, vehicle: Any = OnAxle()
) -> dict[str, float]:
    """Score a policy on episodes that nothing was chosen by; write the figures into its file."""
    policy, about = load_trained(path)
    table = rollout(policy, scenario_of(scenario), SCORED, np.arange(episodes), vehicle=vehicle)
    figures = _figures(table)
    first = table.select(["episode", "hav", "path_length", "largest_articulation"]).slice(0, 4)
    told = {"seed": SCORED, "episodes": episodes, "figures": figures, "first": first.to_pylist()}
    save_policy(policy, path, about | {"evaluation": told})
    return figures


def _figures(table: pa.Table) -> dict[str, float]:
    """Return the figures of a table; those without a value are left out."""
    values = {figure.name: measure(table, figure).value for figure in figures_of(table)}
    return {name: value for name, value in values.items() if np.isfinite(value)}
