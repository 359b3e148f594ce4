"""This module measures the cost of real vehicles and obstacles: ``python -m benchmarks.obstacles``.

It measures a step of one HAV with ten trailers, without a policy and in the learner's step, on one
thread, in CPU time. All rows take turns.
"""

import time
from collections.abc import Callable

import numpy as np
import tyro
from rich.console import Console

from benchmarks.tables import new_table, ratio_text
from benchmarks.turns import medians_in_turns
from hav_env import (
    Batch,
    Field,
    Observation,
    OffAxle,
    RandomFleet,
    RandomPoses,
    Rectangles,
    catalogue_fleet,
    find_scenario,
)
from hav_env.mdp.decision_process import DecisionProcess

HAVS, SEEN_WORLDS, STEPS = 4, 256, 60
# in small batches the call from Python takes half of the time, in large ones next to nothing
BATCHES = 64, 1_024
TRAIN = catalogue_fleet("baggage-train")  # ten trailers
REAL = OffAxle(bodies=Rectangles())
PAPER = "the paper's: hitched on axles, lines, an empty plane"


def drive(batch: Batch, seed: int) -> float:
    """Return nanoseconds of a HAV-step of a batch with random commands from the episodes' start."""
    shape, generator = batch.worlds.state.x.shape, np.random.default_rng(seed)
    batch.reset(seed)
    speed, steering = generator.uniform(0, 5, shape), generator.uniform(-0.6, 0.6, shape)
    begin = time.thread_time()
    for step in range(STEPS):
        if step % 10 == 9:
            steering = np.roll(steering, 1, axis=1)
        batch.step(speed, steering)
    return 1e9 * (time.thread_time() - begin) / (STEPS * shape[0] * shape[1])


def learn(process: DecisionProcess, seed: int) -> float:
    """Return nanoseconds of an agent-step of a decision process, with random actions."""
    worlds, havs = process.num_worlds, process.num_havs
    outcome = process.outcome()
    keys = np.full(worlds, seed), np.arange(worlds), np.ones(worlds, np.bool_)
    process.begin(*keys, outcome)
    actions = np.random.default_rng(seed).uniform(-1, 1, (worlds, havs, 2)).astype(np.float32)
    begin = time.thread_time()
    for _ in range(STEPS):
        process.step(actions)
    return 1e9 * (time.thread_time() - begin) / (STEPS * worlds * havs)


def measure(runs: dict[str, Callable[[int], float]], repetitions: int) -> dict[str, float]:
    """Run each once to compile it, then all in turn, each time with another seed."""
    seeds = {name: iter(range(repetitions + 1)) for name in runs}
    for name, run in runs.items():
        run(next(seeds[name]))
    return medians_in_turns(
        {name: lambda n=name: runs[n](next(seeds[n])) for name in runs}, repetitions
    )


def policy_free(worlds: int) -> dict[str, Callable[[int], float]]:
    """Return the steps of a number of worlds without a policy: the first one is the paper's."""
    fleet = RandomFleet(min_trailers=10, max_trailers=10)
    batches = {
        PAPER: Batch(RandomPoses(HAVS, fleet=fleet), worlds, threads=1),
        "OffAxle, Rectangles": Batch(
            RandomPoses(HAVS, fleet=TRAIN), worlds, vehicle=REAL, threads=1
        ),
        "the same in field-4": Batch(Field(HAVS, fleet=TRAIN), worlds, vehicle=REAL, threads=1),
        "the same in docks-6": Batch(
            find_scenario("docks-6")._replace(fleet=TRAIN), worlds, vehicle=REAL, threads=1
        ),
    }
    return {name: lambda seed, b=batch: drive(b, seed) for name, batch in batches.items()}


def observed() -> dict[str, Callable[[int], float]]:
    """Return the learner's steps in field-4: the first one observes no obstacles."""
    rows = {
        "without": Observation(),
        "4 points": Observation(obstacles=4),
        "32 rays": Observation(rays=32),
    }
    processes = {
        name: DecisionProcess(
            SEEN_WORLDS, scenario="field-4", vehicle="realistic", observation=seen, threads=1
        )
        for name, seen in rows.items()
    }
    return {name: lambda seed, p=process: learn(p, seed) for name, process in processes.items()}


def main(repetitions: int = 21) -> None:
    """Print the tables.

    Args:
        repetitions: Number of repetitions, of which the table shows the median.
    """
    for title, runs in (
        *(
            (f"ns for a HAV-step without a policy, {worlds:,} worlds", policy_free(worlds))
            for worlds in BATCHES
        ),
        ("ns for an agent-step of a learner in field-4", observed()),
    ):
        figures = measure(runs, repetitions)
        first = next(iter(figures.values()))
        table = new_table(title, "", "ns", ": first row")
        for name, figure in figures.items():
            table.add_row(name, f"{figure:,.0f}", ratio_text(figure, first))
        Console(width=100).print(table)


if __name__ == "__main__":
    tyro.cli(main)
