"""This module compares the speed of the own loops with PPO on Stable-Baselines3.

``python -m benchmarks.own_loops`` prints the table of docs/performance.md. All learn on the same
worlds with the same sizes, one after the other, several times; the best turn of each counts. The
times are those of the process on the CPU. Evaluations are left out.
"""

import dataclasses
import time
from collections.abc import Callable

import torch
import tyro
from rich.console import Console

from benchmarks.tables import new_table, rate_text
from benchmarks.training import prepare
from train import ippo, mappo
from train.loops.arguments import LOOP_PRESETS, LoopArguments
from train.loops.worlds import Worlds


def learn_by_loop(module: object, arguments: LoopArguments, iterations: int) -> Callable[[], float]:
    """Return a function that learns for some iterations, and returns decisions per CPU second."""
    learner = module.Learner(arguments, Worlds(arguments))  # type: ignore[attr-defined]
    each = len(learner.worlds.seen) * arguments.rollout_decisions
    learner.update(0.0)

    def run() -> float:
        begun = time.process_time()
        for _ in range(iterations):
            learner.update(0.0)
        return iterations * each / (time.process_time() - begun)

    return run


def main(iterations: int = 3, repetitions: int = 5, rollout: int = 64) -> None:
    """Measure.

    Args:
        iterations: Rollouts with their updates in one turn.
        repetitions: Number of turns.
        rollout: Number of actions of each HAV in a rollout.
    """
    torch.set_num_threads(1)
    # no update ends early, so all learn from each action equally often
    single = dataclasses.replace(
        LOOP_PRESETS["single"], target_divergence=1e6, rollout_decisions=rollout
    )
    pair = dataclasses.replace(single, scenario="paper-pair", worlds=256)
    pooled = dataclasses.replace(pair, network="pooled")
    runs = {}
    for name, plain in (("single", single), ("pair", pair)):
        runs[name, "Stable-Baselines3"] = prepare(plain, False, iterations, time.process_time)
        runs[name, "train.ippo"] = learn_by_loop(ippo, plain, iterations)
        runs[name, "train.mappo"] = learn_by_loop(mappo, plain, iterations)
    runs["pair", "train.ippo, pooled"] = learn_by_loop(ippo, pooled, iterations)
    best: dict[tuple[str, str], float] = dict.fromkeys(runs, 0.0)
    for _ in range(repetitions):
        for key, run in runs.items():
            best[key] = max(best[key], run())
    table = new_table("PPO, one thread, decisions per CPU second", "task", "loop", "rate", "ratio")
    for (name, loop), rate in best.items():
        ratio = rate / best[name, "Stable-Baselines3"]
        table.add_row(name, loop, rate_text(rate), f"{ratio:.2f}")
    Console().print(table)


if __name__ == "__main__":
    tyro.cli(main)
