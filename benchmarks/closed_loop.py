"""This module runs the workloads of the benchmark, in a process that waits for requests.

``python benchmarks/closed_loop.py`` reads JSON lists of name, threads and share, one on a line, and
answers each with HAV-steps/s. An earlier revision runs the same workloads by its own file of this
name, so names in hav_env may change.
"""

import contextlib
import json
import os
import pathlib
import subprocess
import sys
import time
from typing import Any, NamedTuple

import numpy as np
import pyarrow.compute as pc

from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.dubins_pursuit import DubinsPursuit
from benchmarks.yardsticks.five_trailers import POLICY, SCENARIO, VEHICLE
from hav_env import Batch, OnAxle, RandomPoses, Task
from hav_env.evaluation.rollout import rollout

FIVE_TRAILERS = "the yardsticks' HAV"
NO_POLICY = "single HAV, no policy"
_ROOT = pathlib.Path(__file__).parents[1]


class Workload(NamedTuple):
    """The workload of one row of the table."""

    scenario: Any
    num_episodes: int
    max_steps: int = Task().max_steps
    policy: Any = AvoidJack()
    vehicle: Any = OnAxle()


def _trailers(count: int) -> RandomPoses:
    fleet = RandomPoses().fleet._replace(min_trailers=count, max_trailers=count)
    return RandomPoses(fleet=fleet)


WORKLOADS = {
    "single HAV (paper)": Workload(RandomPoses(), 2_250),
    "pair (paper)": Workload(RandomPoses(num_havs=2), 900),
    "swarm of 10": Workload(RandomPoses(num_havs=10), 448, 1_000),
    "swarm of 50": Workload(RandomPoses(num_havs=50), 128, 300),
    "swarm of 200": Workload(RandomPoses(num_havs=200), 64, 100),
    "single HAV, 1 trailer": Workload(_trailers(1), 2_250),
    "single HAV, 5 trailers": Workload(_trailers(5), 2_250),
    "single HAV, 10 trailers": Workload(_trailers(10), 2_250),
    "single HAV, Dubins pursuit": Workload(RandomPoses(), 2_250, policy=DubinsPursuit()),
    FIVE_TRAILERS: Workload(SCENARIO, 1_024, 6_000, POLICY, VEHICLE),
}


def rate(name: str, threads: int, share: float) -> float:
    """Return HAV-steps/s of a share of a workload; waiting HAVs do not count.

    A rollout counts from placing the HAVs to its table. Without a policy, a batch is stepped.
    """
    if name == NO_POLICY:
        return _step_rate(threads, round(100 * share))
    workload = WORKLOADS[name]
    episodes = np.arange(max(1, round(share * workload.num_episodes)))
    start = time.perf_counter()
    table = rollout(
        workload.policy,
        workload.scenario,
        0,
        episodes,
        Task(max_steps=workload.max_steps),
        workload.vehicle,
        threads,
    )
    return pc.sum(table["moving_steps"]).as_py() / (time.perf_counter() - start)


def _step_rate(threads: int, num_steps: int, num_worlds: int = 8_200) -> float:
    batch = Batch(RandomPoses(), num_worlds, threads=threads)
    batch.reset(0)
    speed, steering = np.ones((1, num_worlds)), np.full((1, num_worlds), 0.02)
    batch.step(speed, steering)
    start = time.perf_counter()
    for _ in range(num_steps):
        batch.step(speed, steering)
    return num_worlds * num_steps / (time.perf_counter() - start)


class Version:
    """A process that runs workloads with the code in a folder, by that folder's own file."""

    def __init__(self, folder: str) -> None:
        """Start the process."""
        self._process = subprocess.Popen(
            [sys.executable, str(pathlib.Path(folder, "benchmarks", "closed_loop.py"))],
            env=os.environ | {"PYTHONPATH": folder},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def rate(self, name: str, threads: int, share: float) -> float:
        """Return ``rate`` as measured by the process."""
        self.ask(name, threads, share)
        return self.answer()

    def ask(self, name: str, threads: int, share: float) -> None:
        """Start the measurement of ``rate`` without waiting for the answer."""
        assert self._process.stdin is not None
        with contextlib.suppress(BrokenPipeError):  # ``answer`` tells why the process has ended
            self._process.stdin.write(json.dumps([name, threads, share]) + "\n")
            self._process.stdin.flush()

    def answer(self) -> float:
        """Return the result of the last request.

        Raises:
            RuntimeError: If the process has failed; the message has its last lines.
        """
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            _, told = self._process.communicate()
            raise RuntimeError("\n".join(told.splitlines()[-5:]))
        return float(line)

    def close(self) -> None:
        """End the process."""
        if self._process.poll() is None:
            self._process.communicate()


def rate_of_both(versions: tuple[Version, Version], name: str, share: float) -> float:
    """Return the sum of the rates of two simultaneous processes, each on one thread.

    They share nothing but the machine: two threads of one process can hardly reach more.
    """
    for version in versions:
        version.ask(name, 1, share)
    return sum(version.answer() for version in versions)


if __name__ == "__main__":
    for line in sys.stdin:
        print(rate(*json.loads(line)), flush=True)
