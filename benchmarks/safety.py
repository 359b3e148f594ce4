"""This module measures the cost of the safety filter: ``python -m benchmarks.safety``.

It runs policies and vector environments with and without the filter, all in turn, on one thread, in
CPU time. Waiting HAVs do not count.
"""

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import tyro
from rich.console import Console

from benchmarks.tables import new_table
from benchmarks.turns import medians_in_turns
from hav_env import Filtered, SafetyFilter, Task, find_scenario
from hav_env.evaluation.rollout import rollout
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.policies.names import make_policy
from hav_env.vehicles import VEHICLES

# scenario, events to prevent, episodes, steps, worlds of the environment
WORKLOADS = {
    "single": ("paper-single", "jackknife", 256, 2_000, 256),
    "pair": ("paper-pair", "both", 128, 2_000, 256),
    "swarm of 10": ("swarm-10", "both", 64, 500, 64),
}
POLICIES = ("avoid_jack", "dubins_pursuit")
STEPS = 100


def drive(name: str, policy: str, filtered: bool, share: float, vehicle: Any) -> float:
    """Return nanoseconds of a HAV-step of a rollout."""
    scenario, against, episodes, steps, _ = WORKLOADS[name]
    driver = make_policy(policy)
    if filtered:
        driver = Filtered(driver, SafetyFilter(against))
    task = Task(max_steps=max(10, round(share * steps)))
    begin = time.process_time()
    drawn, numbers = find_scenario(scenario), np.arange(episodes)
    table = rollout(driver, drawn, 5, numbers, task, vehicle, threads=1)
    return 1e9 * (time.process_time() - begin) / table["moving_steps"].to_numpy().sum()


def act(name: str, process: DecisionProcess, share: float) -> float:
    """Return nanoseconds of an agent-step of a vector environment with random actions."""
    worlds, outcome = process.num_worlds, process.outcome()
    keys = np.full(worlds, 5), np.arange(worlds), np.ones(worlds, np.bool_)
    process.begin(*keys, outcome)
    steps, rng = max(2, round(share * STEPS)), np.random.default_rng(5)
    actions = rng.uniform(-1, 1, (steps // 10 + 1, worlds, process.num_havs, 2))
    begin = time.process_time()
    for step in range(steps):
        process.step(actions[step // 10].astype(np.float32), outcome)
    return 1e9 * (time.process_time() - begin) / (steps * worlds * process.num_havs)


def runs_of(name: str, share: float, vehicle: Any) -> dict[tuple[str, bool], Callable[[], float]]:
    """Return the measurements of a workload, by what drives and whether the filter is on."""
    runs: dict[tuple[str, bool], Callable[[], float]] = {}
    scenario, against, _, _, worlds = WORKLOADS[name]
    for filtered in (False, True):
        for policy in POLICIES:
            runs[policy, filtered] = lambda p=policy, f=filtered: drive(name, p, f, share, vehicle)
        safety = against if filtered else None
        process = DecisionProcess(
            worlds, scenario=scenario, vehicle=vehicle, safety=safety, threads=1
        )
        runs["environment", filtered] = lambda p=process: act(name, p, share)
    return runs


def main(repetitions: int = 7, share: float = 1.0, vehicle: str = "on_axle") -> None:
    """Print the table.

    Args:
        repetitions: Number of repetitions, of which the table shows the median.
        share: Share of the steps.
        vehicle: Name of the vehicle: on_axle, or limited.
    """
    columns = (*POLICIES, "environment")
    table = new_table("ns for a HAV-step: without filter + cost of the filter", "", *columns)
    for name in WORKLOADS:
        runs = runs_of(name, share, VEHICLES.make(vehicle))
        for run in runs.values():
            run()  # compiles
        figures = medians_in_turns(runs, repetitions)
        costs = [(figures[what, False], figures[what, True]) for what in columns]
        table.add_row(name, *(f"{plain:,.0f} + {full - plain:,.0f}" for plain, full in costs))
    Console(width=100).print(table)


if __name__ == "__main__":
    tyro.cli(main)
