"""How many steps of moving HAVs are simulated in a second: the closed loop and its yardsticks.

``python -m benchmarks.throughput`` prints the table of benchmarks/README.md.
"""

import json
import pathlib
import statistics
import time
from collections.abc import Callable
from typing import Annotated, Any, NamedTuple

import numpy as np
import pyarrow.compute as pc
import tyro
from rich.console import Console
from rich.table import Table

from baselines.avoid_jack import AvoidJack
from baselines.pursuit import DubinsPursuit
from baselines.rollout import rollout
from benchmarks import fresh_process
from benchmarks.five_trailers import POLICY, SCENARIO, VEHICLE
from benchmarks.yardsticks import check, drive_plain_python, drive_small_arrays
from hav_env import OnAxle, RandomPoses, Task

FIVE_TRAILERS, PLAIN, ARRAYS = "HAV with 5 trailers", "plain Python floats", "small NumPy arrays"
_MOST_STEPS = 6_000  # of the HAV with five trailers, which has not hit its last goal by then


class Workload(NamedTuple):
    """What one row of the table runs."""

    policy: Any
    scenario: Any
    num_episodes: int
    max_steps: int = Task().max_steps
    vehicle: Any = OnAxle()


WORKLOADS = {
    "single HAV (paper)": Workload(AvoidJack(), RandomPoses(), 320),
    "pair (paper)": Workload(AvoidJack(), RandomPoses(num_havs=2), 128),
    "swarm of 10": Workload(AvoidJack(), RandomPoses(num_havs=10), 64, 1_000),
    "swarm of 200": Workload(AvoidJack(), RandomPoses(num_havs=200), 64, 100),
    "single HAV, Dubins pursuit": Workload(DubinsPursuit(), RandomPoses(), 320),
    FIVE_TRAILERS: Workload(POLICY, SCENARIO, 128, _MOST_STEPS, VEHICLE),
}


class Figures(NamedTuple):
    """What one run of the benchmark measured."""

    rates: dict[str, dict[int, float]]  # row -> threads -> HAV-steps/s
    first_start: float | None  # [s] to a finished experiment on an empty cache
    second_start: float | None  # [s] on the cache it left
    memory: dict[int, float]  # experiments -> peak [MiB]


def compiled_rate(workload: Workload, threads: int, share: float) -> float:
    """Return HAV-steps/s of a whole rollout, its table included; waiting HAVs do not count."""
    episodes = np.arange(max(1, round(share * workload.num_episodes)))
    task = Task(max_steps=workload.max_steps)
    start = time.perf_counter()
    table = rollout(
        workload.policy, workload.scenario, 0, episodes, task, workload.vehicle, threads
    )
    seconds = time.perf_counter() - start
    return pc.sum(table["moving_steps"]).as_py() / seconds


def yardstick_rate(drive: Callable, num_steps: int) -> float:
    """Return HAV-steps/s of a yardstick."""
    start = time.perf_counter()
    drive(num_steps)
    return num_steps / (time.perf_counter() - start)


def measure_rates(repetitions: int, share: float) -> dict[str, dict[int, float]]:
    """Measure all rows in turn, again and again, and return the medians.

    Machines are shared: what is compared is measured close together in time.
    """
    runs: dict[tuple[str, int], Callable[[], float]] = {}
    for name, workload in WORKLOADS.items():
        compiled_rate(workload, 1, 0.0)  # compile
        for threads in (1, 2):
            runs[name, threads] = lambda w=workload, t=threads: compiled_rate(w, t, share)
    for name, drive in ((PLAIN, drive_plain_python), (ARRAYS, drive_small_arrays)):
        runs[name, 1] = lambda d=drive: yardstick_rate(d, _MOST_STEPS)
    samples: dict[tuple[str, int], list[float]] = {key: [] for key in runs}
    for _ in range(repetitions):
        for key, run in runs.items():
            samples[key].append(run())
    rates: dict[str, dict[int, float]] = {}
    for (name, threads), sample in samples.items():
        rates.setdefault(name, {})[threads] = statistics.median(sample)
    return rates


def show(figures: Figures) -> None:
    """Print the figures as a table and two lines."""
    table = Table(title="closed loop, HAV-steps/s (HAVs that wait do not count)")
    table.add_column("what")
    for column in ("1 thread", "2 threads", "2 : 1", ": plain Python", ": NumPy"):
        table.add_column(column, justify="right")
    plain, arrays = figures.rates[PLAIN][1], figures.rates[ARRAYS][1]
    for name, rates in figures.rates.items():
        one, two = rates[1], rates.get(2)
        table.add_row(
            name,
            f"{one:,.0f}",
            f"{two:,.0f}" if two else "",
            f"{two / one:.2f}" if two else "",
            f"{one / plain:.3g}",
            f"{one / arrays:.3g}",
        )
    console = Console(width=100)
    console.print(table)
    if figures.first_start is not None:
        console.print(
            f"process start to first finished experiment: {figures.first_start:.1f} s on an empty"
            f" cache, {figures.second_start:.1f} s on the cache it left"
        )
    for count, memory in figures.memory.items():
        console.print(f"peak memory of {count:,} experiments: {memory:.0f} MiB")


def main(
    quick: bool = False,
    repetitions: int = 3,
    json_file: Annotated[pathlib.Path | None, tyro.conf.arg(name="json")] = None,
) -> None:
    """Measure the closed loop and its yardsticks.

    Args:
        quick: one repetition of a quarter of the work, no fresh processes: to see that it runs.
        repetitions: of every measurement; the table shows medians.
        json_file: where to write the figures.
    """
    check()
    first_start = second_start = None
    memory = {}
    if not quick:
        first_start, second_start = fresh_process.start_seconds()
        fresh_process.peak_memory(1)  # compiles, which takes memory of its own
        memory = {count: fresh_process.peak_memory(count) for count in (500, 2_000)}
    rates = measure_rates(1, 0.25) if quick else measure_rates(repetitions, 1.0)
    figures = Figures(rates, first_start, second_start, memory)
    show(figures)
    if json_file:
        json_file.write_text(json.dumps(figures._asdict(), indent=2) + "\n")


if __name__ == "__main__":
    tyro.cli(main)
