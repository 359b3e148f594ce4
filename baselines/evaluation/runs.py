"""This module runs evaluations on disk: it writes them in parts, and resumes them."""

import contextlib
import functools
import logging
import pathlib
import shutil
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa

from baselines.cli.bounds import check_episodes, check_threads
from baselines.evaluation.executors import Engine, run_here
from baselines.evaluation.run_description import claim, describe_run, seal
from baselines.evaluation.run_parts import find_parts, join_parts, write_part
from baselines.storage.atomic_files import digest_of
from baselines.storage.locks import sole_user
from hav_env import Task
from hav_env.evaluation.rollout import rollout
from hav_env.policies.checks import check_policy
from hav_env.policies.demands import check_guided
from hav_env.scenarios import check_scenario
from hav_env.simulator.batch import check_parts, check_seed
from hav_env.simulator.guiding import check_guidance
from hav_env.vehicles import OnAxle, check_vehicle
from hav_env.world.place.guidance import Dubins
from hav_env.world.task import check_task

PART = 2_250  # HAV episodes in one part: seconds of work, and the amount in memory at a time
Advance = Callable[[int, int], None]


class Experiments(NamedTuple):
    """A number of episodes of one policy in one scenario."""

    policy: Any
    scenario: Any
    num_episodes: int
    seed: int = 0
    task: Task = Task()
    vehicle: Any = OnAxle()
    guidance: Any = Dubins()


def check_experiments(
    experiments: Experiments, threads: int | None = None, name: str = "episodes"
) -> None:
    """Check experiments before any of them runs or is written.

    Args:
        experiments: Experiments to run.
        threads: Number of threads; None is ``HAV_THREADS`` or all cores.
        name: Name of the number of episodes, for the message.

    Raises:
        TypeError, ValueError: If an argument is invalid; the message names it, its value and the
            rule.
    """
    check_scenario(experiments.scenario)
    check_episodes(name, experiments.num_episodes, experiments.scenario.num_havs)
    check_seed(experiments.seed)
    check_task(experiments.task)
    check_vehicle(experiments.vehicle)
    check_parts(experiments.scenario, experiments.task, experiments.vehicle)
    check_guidance(experiments.guidance, experiments.scenario, experiments.vehicle)
    check_guided(experiments.policy, experiments.guidance)
    check_policy(*experiments[:2], experiments.task, experiments.vehicle)
    check_threads(threads)


def run_experiments(
    experiments: Experiments,
    folder: pathlib.Path,
    name: str,
    threads: int | None = None,
    overwrite: bool = False,
    advance: Advance = lambda episodes, steps: None,
    engine: Engine = run_here,
) -> pathlib.Path:
    """Run experiments and store their table as ``name.parquet`` in a folder.

    The folder ``name.parts`` stores the parts of an interrupted run, which do not run again. The
    file is the same, byte for byte, after any interrupts and with any engine. Tables and parts have
    digests: one that has changed since it was written is made again.

    Args:
        experiments: Experiments to run.
        folder: Folder, created if it does not exist; no other run works in it at the same time.
        name: Name of the table.
        threads: Number of threads.
        overwrite: Whether to discard the results of an earlier run under this name.
        advance: Function called after every part with its numbers of episodes and of moving
            HAV-steps.
        engine: Engine that runs the missing parts, from
            ``baselines.evaluation.executors.open_engine``.

    Returns:
        The path of the table.

    Raises:
        ValueError: If the folder holds another run under this name, or a parameter is invalid.
        OSError: If the folder cannot be written, or another run works in it.
    """
    check_experiments(experiments, threads)
    target, description = folder / f"{name}.parquet", folder / f"{name}.json"
    with sole_user(folder):
        _check_kinds(target)
        if overwrite:
            _discard(target)
        described = describe_run(experiments, (run_part, write_part, join_parts))
        digest = claim(description, described)
        if digest is not None and digest == digest_of(target):
            advance(experiments.num_episodes, 0)
        else:
            if digest is not None:
                warn = logging.getLogger(__name__).warning
                warn("%s is broken or missing: its episodes are run again", target)
            work = functools.partial(run_part, experiments)
            digest = _make(experiments, target, work, threads, advance, engine)
        seal(description, described, digest)
        if target.with_suffix(".parts").exists():
            shutil.rmtree(target.with_suffix(".parts"))
    return target


def _make(
    experiments: Experiments,
    target: pathlib.Path,
    work: Callable[[range, int | None], pa.Table],
    threads: int | None,
    advance: Advance,
    engine: Engine,
) -> str:
    """Run the missing parts; write the table and return its digest."""
    folder = target.with_suffix(".parts")
    folder.mkdir(exist_ok=True)
    parts = find_parts(folder)
    for span in spans_of(experiments):
        if span.start in parts:
            advance(len(span), 0)
    kept = frozenset(parts)
    missing = (span for span in spans_of(experiments) if span.start not in kept)
    with contextlib.closing(engine(work, missing, threads)) as done:
        for span, table in done:
            parts[span.start] = write_part(table, folder, span.start)
            advance(len(span), int(np.sum(table["moving_steps"].to_numpy())))
    return join_parts((parts[span.start] for span in spans_of(experiments)), target)


def spans_of(experiments: Experiments) -> Iterator[range]:
    """Yield the numbers of the episodes of each part."""
    count, step = experiments.num_episodes, max(1, PART // experiments.scenario.num_havs)
    return (range(first, min(first + step, count)) for first in range(0, count, step))


def run_part(experiments: Experiments, span: range, threads: int | None) -> pa.Table:
    """Return the table of some of the experiments."""
    return rollout(
        experiments.policy,
        experiments.scenario,
        experiments.seed,
        np.arange(span.start, span.stop),
        experiments.task,
        experiments.vehicle,
        threads,
        experiments.guidance,
    )


def _discard(target: pathlib.Path) -> None:
    """Remove earlier results; the description goes last, so no data are ever without one."""
    shutil.rmtree(target.with_suffix(".parts"), ignore_errors=True)
    target.unlink(missing_ok=True)
    target.with_suffix(".json").unlink(missing_ok=True)


def _check_kinds(target: pathlib.Path) -> None:
    """Raise ValueError if a folder is in the place of a file, or vice versa."""
    for path in (target, target.with_suffix(".json")):
        if path.is_dir():
            raise ValueError(f"{path} is a folder, but must be a file: choose another --output")
    parts = target.with_suffix(".parts")
    if parts.exists() and not parts.is_dir():
        raise ValueError(f"{parts} is a file, but must be a folder: choose another --output")
