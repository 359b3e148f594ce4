"""This module scores a policy during the training, and at the end on fresh episodes."""

import pathlib

import numpy as np
import pyarrow as pa

from baselines.cli.run_options import backup_of
from baselines.policies.files import load_trained, save_policy
from baselines.policies.network import Network
from hav_env.evaluation.comparison import figures_of, measure
from hav_env.evaluation.figures import FIGURES, figure_of_goal, goal_hits
from hav_env.evaluation.rollout import rollout
from hav_env.policies.filtered import filter_policy
from hav_env.scenarios.presets import scenario_of
from hav_env.world.event_table import HARM
from hav_env.world.task import Task
from train.training_task import Exercise

# seeds of episodes: of the final score of the best policy, of the choice of the best policy, and
# the first of the training
SCORED, HELD_OUT, TRAINING = 0, 1, 1_000_000


def evaluate(policy: Network, exercise: Exercise, episodes: int) -> dict[str, float]:
    """Return the evaluator's figures of a policy on the first held-out episodes."""
    return _figures(_roll(policy, exercise, HELD_OUT, episodes))


def score(figures: dict[str, float]) -> float:
    """Return the score that selects the best policy: the share of goals hit minus penalties.

    The penalties are twice the shares of harmful events, and the steps to the last goal over the
    step limit. If no HAV hits the last goal, the steps do not count.
    """
    names = goal_hits(list(figures))
    goals = [figures[name] for name in names]
    harm = sum(figures.get(event.label, 0.0) for event in HARM)
    steps = figures.get(names[-1].replace("hit", "step"), 0.0)
    return float(np.mean(goals)) - 2.0 * harm - steps / Task().max_steps


def conclude(path: pathlib.Path, exercise: Exercise, episodes: int) -> dict[str, float]:
    """Score a policy on episodes that selected nothing; write the figures into its file."""
    policy, about, *behind = load_trained(path)
    table = _roll(policy, exercise, SCORED, episodes)
    figures = _figures(table)
    first = table.select(["episode", "hav", "path_length", "largest_articulation"]).slice(0, 4)
    told = {"seed": SCORED, "episodes": episodes, "figures": figures, "first": first.to_pylist()}
    save_policy(policy, path, about | {"evaluation": told}, *behind)
    return figures


def show_figures(figures: dict[str, float]) -> str:
    """Return the figures of a policy as text: shares in percent, with the units of the others."""
    goals = range(1, len(goal_hits(list(figures))) + 1)
    kinds = {one.name: one for kind in FIGURES for one in (figure_of_goal(kind, k) for k in goals)}

    def show(name: str, value: float) -> str:
        if name in kinds and kinds[name].percent:
            return f"{name} {100 * value:.2f} %"
        return f"{name} {value:,.0f}" if value >= 1_000.0 else f"{name} {value:.3g}"

    return ", ".join(show(name, value) for name, value in figures.items())


def _roll(policy: Network, exercise: Exercise, seed: int, episodes: int) -> pa.Table:
    """Run the first episodes of a seed, with filter, backup and guidance of the training."""
    vehicle, guidance = exercise.vehicle, exercise.guidance
    backup = backup_of(exercise.backup, Task())
    driver = filter_policy(policy, exercise.safety, Task(), vehicle, backup)
    scenario, numbers = scenario_of(exercise.scenario), np.arange(episodes)
    return rollout(driver, scenario, seed, numbers, vehicle=vehicle, guidance=guidance)


def _figures(table: pa.Table) -> dict[str, float]:
    """Return the figures of a table, except those without a value."""
    values = {figure.name: measure(table, figure).value for figure in figures_of(table)}
    return {name: value for name, value in values.items() if np.isfinite(value)}
