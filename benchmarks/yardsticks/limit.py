"""This module measures the limit of the hardware: the closed loop of one HAV in C++.

``python -m benchmarks.yardsticks.limit`` builds ``limit.cpp``, checks it and prints its speed on
one thread. It is a yardstick for the compiled simulator: the speed of a program that simulates this
problem alone.
"""

import functools
import json
import math
import os
import pathlib
import platform
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from typing import NamedTuple

import tyro
from rich.console import Console
from rich.table import Table

from baselines.policies.avoid_jack import AvoidJack
from benchmarks.turns import medians_in_turns
from benchmarks.yardsticks.driving import drive_compiled
from benchmarks.yardsticks.five_trailers import (
    GOALS,
    LENGTHS,
    POLICY,
    START,
    STEERING_MAX,
    VEHICLE,
    Outcome,
)
from benchmarks.yardsticks.plain_python import drive_plain_python
from hav_env import OnAxle, explicit

_SOURCE = pathlib.Path(__file__).with_name("limit.cpp")
# Fast mathematics is fair here: it contracts and reorders, and ``check`` verifies the results.
_FLAGS = ["-std=c++17", "-O3", "-march=native", "-ffast-math", "-Wno-psabi"]
_WIDE = ["-mprefer-vector-width=512"]  # compilers prefer 256 bits on machines with 512
_BLOCKS = 64  # of 128 worlds each: the paper's mix by its quantiles
_STEPS = {"closed loop": 500, "kinematics alone": 2_000}
WHAT = tuple(_STEPS)


class Rules(NamedTuple):
    """Rules of the drive that differ between the yardsticks and the defaults."""

    steering_max: float = math.radians(40.0)
    close_factor: float = AvoidJack().close_factor
    simultaneous: bool = OnAxle().simultaneous


def find_compiler() -> str | None:
    """Return the C++ compiler: $CXX, else the first installed one, else None."""
    for name in (os.environ.get("CXX"), "g++", "clang++", "c++"):
        if name and shutil.which(name):
            return name
    return None


def build(folder: str) -> str | None:
    """Build the program in a folder and return its path; None without a compiler."""
    compiler = find_compiler()
    if compiler is None:
        return None
    program = str(pathlib.Path(folder, "limit"))
    wide = _WIDE if platform.machine().lower() in ("x86_64", "amd64") else []
    subprocess.run([compiler, *_FLAGS, *wide, "-o", program, str(_SOURCE)], check=True)
    return program


def drive_limit(program: str, num_steps: int, rules: Rules) -> Outcome:
    """Drive the HAV with five trailers for so many steps, at most to the last goal."""
    numbers: list[Sequence[float]] = [
        (num_steps, *rules),
        (len(LENGTHS), *LENGTHS),
        START,
        (len(GOALS), *(number for goal in GOALS for number in goal)),
    ]
    text = " ".join(repr(float(number)) for row in numbers for number in row)
    return Outcome(**json.loads(_run(program, "drive", text=text)))


def check(program: str, num_steps: int = 1_200, tolerance: float = 1e-9) -> None:
    """Check that the program reproduces the plain Python yardstick and hav_env's defaults.

    Args:
        program: Program from ``build``.
        num_steps: Number of steps; the default passes the first goal.
        tolerance: Tolerance of positions [m] and headings [rad], which differ by rounding.

    Raises:
        AssertionError: If the program deviates; the message states the deviation.
    """
    pinned = Rules(STEERING_MAX, POLICY.close_factor, VEHICLE.simultaneous)
    plain = drive_plain_python(num_steps)
    own = drive_limit(program, num_steps, pinned)
    if not _distance(own, plain) <= tolerance or own[3:] != plain[3:]:
        raise AssertionError(f"limit.cpp ends at {own} instead of {plain}")
    scenario = explicit([LENGTHS], [START], [GOALS], steering_max=Rules().steering_max)
    own = drive_limit(program, num_steps, Rules())
    compiled = drive_compiled(num_steps, AvoidJack(), scenario, OnAxle())
    if not _distance(own, compiled) <= tolerance:
        raise AssertionError(f"limit.cpp ends at {own} instead of {compiled}")


def rate(program: str, what: str, trailers: int | None) -> float:
    """Return HAV-steps/s.

    Args:
        program: Program from ``build``.
        what: One of ``WHAT``.
        trailers: Trailers of every HAV, 1 to 10; None for the paper's mix.
    """
    sizes = trailers or 0, _BLOCKS, _STEPS[what], WHAT.index(what)
    return json.loads(_run(program, "measure", *(str(size) for size in sizes)))["rate"]


def _run(program: str, *arguments: str, text: str = "") -> str:
    done = subprocess.run(
        [program, *arguments], input=text, check=True, capture_output=True, text=True
    )
    return done.stdout


def _distance(one: Outcome, other: Outcome) -> float:
    """Return the largest difference in position [m] or heading [rad], up to whole turns."""
    turns = [
        math.remainder(a - b, math.tau) for a, b in zip(one.headings, other.headings, strict=True)
    ]
    return max(abs(each) for each in (one.x - other.x, one.y - other.y, *turns))


def main(repetitions: int = 3) -> None:
    """Measure the limit of the hardware.

    Args:
        repetitions: Repetitions of every measurement; the table shows medians.
    """
    console = Console(width=100)
    table = Table(title="limit of the hardware, C++ on one thread, HAV-steps/s")
    table.add_column("what")
    for name in WHAT:
        table.add_column(name, justify="right")
    with tempfile.TemporaryDirectory() as folder:
        program = build(folder)
        if program is None:
            console.print("There is no C++ compiler: neither $CXX nor g++, clang++ or c++.")
            return
        check(program)
        for trailers in (None, 1, 5, 10):
            runs = {what: functools.partial(rate, program, what, trailers) for what in WHAT}
            rates = medians_in_turns(runs, repetitions)
            name = "single HAV (paper)" if trailers is None else f"trailers: {trailers}"
            table.add_row(name, *(f"{value:,.0f}" for value in rates.values()))
    console.print(table)


if __name__ == "__main__":
    tyro.cli(main)
