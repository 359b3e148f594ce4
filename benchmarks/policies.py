"""This module measures a step of one HAV under each policy: ``python -m benchmarks.policies``.

It runs whole episodes of each policy in turn, on one thread, in CPU time: simulation, records and
policy. Waiting HAVs count in the first figure, and not in the second.
"""

import time
from typing import NamedTuple

import numpy as np
import tyro
from rich.console import Console

from benchmarks.tables import new_table
from hav_env import Task, find_scenario
from hav_env.evaluation.rollout import rollout
from hav_env.policies.names import make_policy


class Workload(NamedTuple):
    """A number of episodes of a scenario, and their number of steps."""

    scenario: str
    episodes: int
    max_steps: int = 20_000


WORKLOADS = (
    Workload("paper-single", 2_000),
    Workload("paper-pair", 400),
    Workload("swarm-20", 8),
    Workload("dense-20", 8),
    Workload("swarm-50", 3, 10_000),
    Workload("swarm-200", 1, 10_000),
)
POLICIES = ("random", "avoid_jack", "reserve")


def cost(policy: str, work: Workload, share: float) -> tuple[float, float]:
    """Return nanoseconds of a HAV-step, and of one of a HAV that does not wait."""
    episodes = np.arange(max(1, round(share * work.episodes)))
    task = Task(max_steps=max(10, round(min(1.0, share * 10) * work.max_steps)))
    begin = time.process_time()
    table = rollout(make_policy(policy), find_scenario(work.scenario), 5, episodes, task, threads=1)
    spent = 1e9 * (time.process_time() - begin)
    return spent / table["steps"].to_numpy().sum(), spent / table["moving_steps"].to_numpy().sum()


def main(repetitions: int = 3, share: float = 1.0) -> None:
    """Print the table.

    Args:
        repetitions: Number of repetitions, of which the table shows the median.
        share: Share of the work; below a tenth, of the steps too.
    """
    samples: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for policy in POLICIES:
        cost(policy, WORKLOADS[0], 0.0)  # compiles
    for _ in range(repetitions):
        for work in WORKLOADS:
            for policy in POLICIES:
                samples.setdefault((work.scenario, policy), []).append(cost(policy, work, share))
    table = new_table("ns for a HAV-step (for one of a HAV that moves)", "", *POLICIES)
    for work in WORKLOADS:
        medians = [np.median(samples[work.scenario, policy], axis=0) for policy in POLICIES]
        table.add_row(
            work.scenario, *(f"{every:,.0f} ({moving:,.0f})" for every, moving in medians)
        )
    Console(width=100).print(table)


if __name__ == "__main__":
    tyro.cli(main)
