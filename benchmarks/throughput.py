"""This module measures throughput: steps of moving HAVs in a second, and yardsticks for them.

``python -m benchmarks.throughput`` prints the tables of benchmarks/README.md.
"""

import contextlib
import functools
import io
import json
import pathlib
import subprocess
import tempfile
import time
import zipfile
from collections.abc import Callable, Iterator
from typing import Annotated, NamedTuple

import tyro
from rich.console import Console

from benchmarks.closed_loop import (
    FIVE_TRAILERS,
    NO_POLICY,
    WORKLOADS,
    Version,
    rate_of_both,
)
from benchmarks.interfaces import fresh_process
from benchmarks.interfaces.peers import missing_packages, peer_rates
from benchmarks.tables import by_row, new_table, rate_text, ratio_text
from benchmarks.turns import medians_in_turns
from benchmarks.yardsticks import limit
from benchmarks.yardsticks.driving import check, drive_plain_python, drive_small_arrays
from benchmarks.yardsticks.kinematics import kinematics_rate

EARLIER = "9425713"  # of 2026-11-22, with which ``: earlier`` compares
PLAIN, ARRAYS = "plain Python floats", "small NumPy arrays"
_ROOT = pathlib.Path(__file__).parents[1]
_YARDSTICK_STEPS = 6_000
_MIX = "the paper's mix"
_TRAILERS = {"1 trailer": 1, "5 trailers": 5, "10 trailers": 10, _MIX: None}


class Figures(NamedTuple):
    """Figures of one run of the benchmark, HAV-steps/s except for the last three."""

    closed_loop: dict[
        str, dict[str, float]
    ]  # row -> "1 thread", "2 threads", "2 processes", "earlier"
    limits: dict[str, dict[str, float]]  # trailers -> "kinematics", "C++ kinematics", "C++ ..."
    peers: dict[str, float]  # agent-steps/s
    first_start: float | None  # [s] to a finished experiment on an empty cache
    second_start: float | None  # [s] on the cache it left
    memory: dict[int, float]  # experiments -> peak [MiB]


@contextlib.contextmanager
def earlier_version() -> Iterator[Version | None]:
    """Yield the earlier revision as a running process; None if git does not have it."""
    command = ["git", "archive", "--format=zip", EARLIER, "hav_env", "baselines", "benchmarks"]
    try:
        archive = subprocess.run(command, cwd=_ROOT, check=True, capture_output=True).stdout
    except (OSError, subprocess.CalledProcessError):
        yield None
        return
    with tempfile.TemporaryDirectory() as folder:
        with zipfile.ZipFile(io.BytesIO(archive)) as files:
            files.extractall(folder)
        # today's package would come before a folder without this file
        pathlib.Path(folder, "benchmarks", "__init__.py").touch()
        version = Version(folder)
        try:
            yield version
        finally:
            version.close()


def measure_closed_loop(repetitions: int, share: float) -> dict[str, dict[str, float]]:
    """Measure the workloads with this version and the earlier one, and the yardsticks."""
    runs: dict[tuple[str, str], Callable[[], float]] = {}
    now, beside = Version(str(_ROOT)), Version(str(_ROOT))
    with earlier_version() as earlier:
        for name in (*WORKLOADS, NO_POLICY):
            now.rate(name, 1, 0.0)  # compiles
            beside.rate(name, 1, 0.0)
            runs[name, "1 thread"] = lambda n=name: now.rate(n, 1, share)
            runs[name, "2 threads"] = lambda n=name: now.rate(n, 2, share)
            runs[name, "2 processes"] = lambda n=name: rate_of_both((now, beside), n, share)
            if earlier:
                earlier.rate(name, 1, 0.0)
                runs[name, "earlier"] = lambda n=name: earlier.rate(n, 1, share)
        for name, drive in ((PLAIN, drive_plain_python), (ARRAYS, drive_small_arrays)):
            runs[name, "1 thread"] = lambda d=drive: _yardstick_rate(d)
        rates = by_row(medians_in_turns(runs, repetitions))
    now.close()
    beside.close()
    return rates


def _yardstick_rate(drive: Callable) -> float:
    start = time.perf_counter()
    drive(_YARDSTICK_STEPS)
    return _YARDSTICK_STEPS / (time.perf_counter() - start)


def measure_limits(repetitions: int, share: float) -> dict[str, dict[str, float]]:
    """Measure single HAVs beside the C++ yardstick, one thread."""
    runs: dict[tuple[str, str], Callable[[], float]] = {}
    now = Version(str(_ROOT))
    with tempfile.TemporaryDirectory() as folder:
        program = limit.build(folder)
        if program:
            limit.check(program)
        for row, trailers in _TRAILERS.items():
            name = "single HAV (paper)" if trailers is None else f"single HAV, {row}"
            now.rate(name, 1, 0.0)
            kinematics_rate(trailers, 1)
            runs[row, "closed loop"] = lambda n=name: now.rate(n, 1, share)
            runs[row, "kinematics"] = lambda t=trailers: kinematics_rate(t)
            if program:
                for what in limit.WHAT:
                    runs[row, f"C++ {what}"] = functools.partial(
                        limit.rate, program, what, trailers
                    )
        rates = by_row(medians_in_turns(runs, repetitions))
    now.close()
    return rates


def show(figures: Figures) -> None:
    """Print the figures as tables and lines."""
    console = Console(width=110)
    plain, arrays = (figures.closed_loop[name]["1 thread"] for name in (PLAIN, ARRAYS))
    columns = "1 thread", "2 threads", "2 : 1", "2 processes : 1", "earlier", ": earlier"
    table = new_table("closed loop, HAV-steps/s (HAVs that wait do not count)", "what", *columns)
    for name, rates in figures.closed_loop.items():
        one, two, earlier = (rates.get(c) for c in ("1 thread", "2 threads", "earlier"))
        both = rates.get("2 processes")
        cells = rate_text(one), rate_text(two), ratio_text(two, one), ratio_text(both, one)
        table.add_row(name, *cells, rate_text(earlier), ratio_text(one, earlier))
    console.print(table)
    like = figures.closed_loop[FIVE_TRAILERS]["1 thread"]
    console.print(f"{FIVE_TRAILERS}: {like / plain:.0f} x {PLAIN}, {like / arrays:.0f} x {ARRAYS}")
    title = "single HAV, one thread, beside the C++ yardstick, HAV-steps/s"
    columns = "closed loop", "C++", ": C++", "kinematics alone", "C++", ": C++"
    table = new_table(title, "trailers", *columns)
    for row, rates in figures.limits.items():
        cells = []
        for own, other in (
            ("closed loop", "C++ closed loop"),
            ("kinematics", "C++ kinematics alone"),
        ):
            one, two = rates[own], rates.get(other)
            cells += [rate_text(one), rate_text(two), ratio_text(one, two)]
        table.add_row(row, *cells)
    console.print(table)
    if figures.peers:
        table = new_table("peers on their own tasks, agent-steps/s", "what", "random actions")
        for name, value in figures.peers.items():
            table.add_row(name, rate_text(value))
        console.print(table)
    for package in missing_packages():
        console.print(f"{package} is not installed: its rows are missing")
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
    """Measure the closed loop and the programs for comparison.

    Args:
        quick: Whether to run one repetition of a tenth of the work, without peers and fresh
            processes, as a smoke test.
        repetitions: Repetitions of every measurement; the tables show medians.
        json_file: File for the figures.
    """
    check()
    first_start = second_start = None
    memory: dict[int, float] = {}
    if not quick:
        first_start, second_start = fresh_process.start_seconds()
        fresh_process.peak_memory(1)  # compiles, which takes additional memory
        memory = {count: fresh_process.peak_memory(count) for count in (500, 2_000)}
    repetitions, share = (1, 0.1) if quick else (repetitions, 1.0)
    figures = Figures(
        measure_closed_loop(repetitions, share),
        measure_limits(repetitions, share),
        {} if quick else peer_rates(),
        first_start,
        second_start,
        memory,
    )
    show(figures)
    if json_file:
        json_file.write_text(json.dumps(figures._asdict(), indent=2) + "\n")


if __name__ == "__main__":
    tyro.cli(main)
