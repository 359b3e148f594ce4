"""This module compiles ahead of time: it runs every policy, scenario and environment for a step.

The cache on disk keeps the compiled code, so that later runs start at once.
"""

import concurrent.futures
import dataclasses
import functools
import multiprocessing
import time
from collections.abc import Callable

from hav_env.cli.errors import report_errors
from hav_env.cli.options import parse_options
from hav_env.compiled import default_threads
from hav_env.models.checks import check_value
from hav_env.models.quantities import Threads
from hav_env.policies.names import POLICIES
from hav_env.scenarios.presets import FIELDS, SCENARIOS, SITES


def main(words: list[str]) -> int:
    """Compile policies, scenarios and environments ahead of time."""

    def run(words: list[str]) -> None:
        compile_all(parse_options(Compile, "hav-env compile", main.__doc__ or "", words))

    return report_errors(run, words)


@dataclasses.dataclass
class Compile:
    """Options of ``hav-env compile``."""

    policies: tuple[str, ...] = ()
    """Policies: names (hav-env list policies), files, or module:Class; by default all names."""
    processes: int | None = None
    """Number of processes that compile in parallel; by default HAV_THREADS or all cores."""


def compile_all(options: Compile) -> None:
    """Compile everything that the cache does not hold yet, and print the time of each part.

    Raises:
        ValueError, TypeError: If there is no such policy, or ``processes`` is invalid.
    """
    check_value("processes", Threads | None, options.processes)
    for name in options.policies:
        POLICIES.find(name)
    names = options.policies or POLICIES.names()
    jobs: dict[str, Callable[[], float]] = {
        **{name: functools.partial(compile_policy, name) for name in names},
        "environments": compile_environments,
        "scenarios": compile_scenarios,
    }
    begun = time.monotonic()
    processes = options.processes or default_threads()
    spawn = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(processes, spawn) as pool:
        running = {pool.submit(job): name for name, job in jobs.items()}
        for done in concurrent.futures.as_completed(running):
            print(f"{running[done]}: {done.result():.1f} s", flush=True)
    print(f"all is compiled: {time.monotonic() - begun:.0f} s")


def compile_policy(name: str) -> float:
    """Compile a policy for rollouts and for environments; return the time [s]."""
    # other processes do not need tables
    import numpy as np  # noqa: PLC0415

    from hav_env.evaluation.rollout import rollout  # noqa: PLC0415
    from hav_env.policies.driver import PolicyDriver  # noqa: PLC0415
    from hav_env.simulator.batch import Batch  # noqa: PLC0415
    from hav_env.world.task import Task  # noqa: PLC0415

    begun = time.monotonic()
    policy, pair = POLICIES.make(name), SCENARIOS["paper-pair"]
    rollout(policy, pair, 0, np.arange(2), Task(max_steps=2))
    batch = Batch(pair, 2)
    batch.reset(0)
    batch.step(*PolicyDriver(policy, batch).decide())
    return time.monotonic() - begun


def compile_scenarios() -> float:
    """Compile the resets of every class of scenarios; return the time [s]."""
    from hav_env.simulator.batch import Batch  # noqa: PLC0415
    from hav_env.vehicles import VEHICLES  # noqa: PLC0415

    begun = time.monotonic()
    for scenario in {type(scenario): scenario for scenario in SCENARIOS.values()}.values():
        Batch(scenario, 2).reset(0)
    real = (FIELDS | SITES).values()
    for scenario in {type(scenario): scenario for scenario in real}.values():
        Batch(scenario, 2, vehicle=VEHICLES.make("realistic")).reset(0)
    return time.monotonic() - begun


def compile_environments() -> float:
    """Compile the steps and observations of all environments; return the time [s]."""
    import gymnasium  # noqa: PLC0415

    begun = time.monotonic()
    for made in (
        gymnasium.make("hav_env:HAVSwarm-v0"),
        gymnasium.make_vec(
            "hav_env:HAVSwarm-v0", num_envs=2, vectorization_mode="vector_entry_point"
        ),
    ):
        made.reset(seed=0)
        made.step(made.action_space.sample())
        made.close()
    return time.monotonic() - begun
