"""This module measures claims of the paper about its experiments in reproduced episodes."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import pyarrow as pa

from baselines.replay.trajectory import Trajectory
from hav_env import Task
from hav_env.evaluation.figures import goals_of
from hav_env.world.arrays import NEVER


def fingerprints(single: pa.Table, pair: pa.Table) -> list[list[str]]:
    """Return rows of text: the paper's claim, and the measure for single HAVs and pairs.

    Args:
        single: Table of the paper's experiments with one HAV, columns as in docs/metrics.md.
        pair: The same with two HAVs.
    """
    measures = (
        ("jackknifes at the last joint ('predominantly at the rear joints')", _last_joint),
        ("jackknifed HAVs with fewer than four trailers (none)", _few_trailers),
        ("first goals hit at 0.3 to 0.5 m ('most')", _far_hits),
        ("share of heading close misses, steps, both goals (67 %, 68 %)", _heading_misses),
        ("the same, goals never hit only", _heading_misses_never_hit),
        ("the same, HAVs that had such a miss instead of steps", _heading_misses_of_havs),
        ("HAVs in actual collision whose truck exceeds the footprint radius", _long_trucks),
        ("HAVs in actual collision from the start", _at_start),
        ("experiments in which no HAV hits its first goal", _none_arrives),
    )
    rows = [["", "single", "pair"]]
    return rows + [[name, measure(single), measure(pair)] for name, measure in measures]


def evading_in_misses(trajectories: Iterable[Trajectory], task: Task) -> str:
    """Return the share of states in a close miss in which the HAV evades, as text.

    The paper states that collision avoidance was inactive during close misses.

    Args:
        trajectories: Trajectories of whole episodes, every state.
        task: Rules of the episodes, for the tolerances.
    """
    evading = total = 0
    for trajectory in trajectories:
        havs = np.arange(trajectory.x.shape[1])
        goal = trajectory.goals[havs, trajectory.phase]  # (T, N, 3)
        distance = np.hypot(trajectory.x - goal[..., 0], trajectory.y - goal[..., 1])
        turn = trajectory.heading[:, :, 0] - goal[..., 2]
        turn = np.abs((turn + np.pi) % (2.0 * np.pi) - np.pi)
        near, aligned = distance < task.distance_tolerance, turn < task.heading_tolerance
        missed = near & ~aligned & (turn < 2.0 * task.heading_tolerance)
        missed |= aligned & ~near & (distance < 2.0 * task.distance_tolerance)
        missed &= ~trajectory.waiting
        total += int(np.count_nonzero(missed))
        evading += int(np.count_nonzero(missed & (trajectory.evaded != NEVER)))
    return _share(evading, total)


def _share(part: Any, whole: Any) -> str:
    return f"{100 * part / whole:.1f} % of {whole:,.0f}" if whole else "-"


def _column(table: pa.Table, name: str) -> np.ndarray:
    return table[name].to_numpy(zero_copy_only=False)


def _last_joint(table: pa.Table) -> str:
    jackknifed = _column(table, "jackknifed").astype(bool)
    last = _column(table, "jackknife_joint") == _column(table, "num_trailers")
    return _share((jackknifed & last).sum(), jackknifed.sum())


def _few_trailers(table: pa.Table) -> str:
    jackknifed = _column(table, "jackknifed").astype(bool)
    few = jackknifed & (_column(table, "num_trailers") < 4)
    return f"{few.sum()} of {jackknifed.sum()}"


def _far_hits(table: pa.Table) -> str:
    distance = _column(table, "goal_1_distance").astype(float)
    return _share(np.sum(distance >= 0.3), np.isfinite(distance).sum())


def _heading_misses(table: pa.Table, never_hit: bool = False, most: float = np.inf) -> str:
    """Return the share of heading misses among close misses, each HAV's counted up to a limit."""
    shares = []
    for goal in goals_of(table.column_names):
        kept = ~_column(table, f"goal_{goal}_hit").astype(bool) | (not never_hit)
        heading, euclidean = (
            np.minimum(_column(table, f"goal_{goal}_{kind}_miss_steps")[kept], most).sum()
            for kind in ("heading", "euclidean")
        )
        shares.append(_share(heading, heading + euclidean))
    return ", ".join(shares)


def _heading_misses_never_hit(table: pa.Table) -> str:
    return _heading_misses(table, never_hit=True)


def _heading_misses_of_havs(table: pa.Table) -> str:
    return _heading_misses(table, most=1.0)


def _long_trucks(table: pa.Table) -> str:
    collided = _column(table, "actual_collision").astype(bool)
    longer = _column(table, "truck_length") > _column(table, "footprint_radius")
    return _share((collided & longer).sum(), collided.sum())


def _at_start(table: pa.Table) -> str:
    collided = _column(table, "actual_collision").astype(bool)
    return f"{np.sum(_column(table, 'actual_collision_step') == 0)} of {collided.sum()}"


def _none_arrives(table: pa.Table) -> str:
    episodes, group = np.unique(_column(table, "episode"), return_inverse=True)
    hits = np.bincount(group, weights=_column(table, "goal_1_hit").astype(float))
    return _share(np.sum(hits == 0), len(episodes))
