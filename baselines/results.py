"""Experiments on disk: written as they go, resumed, and never half a file."""

import contextlib
import functools
import hashlib
import json
import pathlib
import shutil
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

import hav_env
from baselines.engines import Engine, run_here
from baselines.files import whole_file, write_text
from baselines.policy import check_policy, find_kernel
from baselines.rollout import rollout
from hav_env import Task
from hav_env.batch import check_seed
from hav_env.compiled import source_digest, source_of
from hav_env.scenarios import check_scenario
from hav_env.task import check_task
from hav_env.vehicles import OnAxle, check_vehicle

PART = 2_250  # HAVs' episodes in one part: seconds of work, and what memory holds at a time


class Experiments(NamedTuple):
    """A number of episodes of one policy in one scenario."""

    policy: Any
    scenario: Any
    num_episodes: int
    seed: int = 0
    task: Task = Task()
    vehicle: Any = OnAxle()


def run_experiments(
    experiments: Experiments,
    folder: pathlib.Path,
    name: str,
    threads: int | None = None,
    overwrite: bool = False,
    advance: Callable[[int, int], None] = lambda episodes, steps: None,
    engine: Engine = run_here,
) -> pathlib.Path:
    """Run experiments and keep their table as ``name.parquet`` in a folder.

    What an interrupted run has written is kept in ``name.parts`` and not run again. The file is the
    same, byte for byte, however often the run was interrupted and whichever engine runs it.

    Args:
        experiments: what to run.
        folder: made if it does not exist.
        name: of the table.
        threads: how many.
        overwrite: discard what an earlier run left under this name.
        advance: called after every part with its numbers of episodes and of moving HAV-steps.
        engine: runs what is missing, by ``baselines.engines.open_engine``.

    Returns:
        The path of the table.

    Raises:
        ValueError: when the folder holds another run under this name, or a parameter is wrong.
        OSError: when the folder cannot be written.
    """
    check_at_least_one("episodes", experiments.num_episodes)
    check_seed(experiments.seed)
    check_scenario(experiments.scenario)
    check_task(experiments.task)
    check_vehicle(experiments.vehicle)
    policy, scenario = experiments.policy, experiments.scenario
    check_policy(policy, scenario, experiments.task, experiments.vehicle)
    if threads is not None:
        check_at_least_one("threads", threads)
    parts = folder / f"{name}.parts"
    target = folder / f"{name}.parquet"
    folder.mkdir(parents=True, exist_ok=True)
    if overwrite:
        _discard(folder, name)
    _claim(folder / f"{name}.json", describe(experiments))
    parts.mkdir(exist_ok=True)
    step = max(1, PART // experiments.scenario.num_havs)
    spans = [
        range(first, min(first + step, experiments.num_episodes))
        for first in range(0, experiments.num_episodes, step)
    ]
    files = {span: parts / f"{span.start:09d}.parquet" for span in spans}
    missing = [span for span in spans if not target.exists() and not files[span].exists()]
    for span in set(spans).difference(missing):
        advance(len(span), 0)
    part = functools.partial(run_part, experiments)
    with contextlib.closing(engine(part, missing, threads)) as done:
        for span, table in done:
            write_table(table, files[span])
            advance(len(span), int(np.sum(table["moving_steps"].to_numpy())))
    if not target.exists():
        _join(list(files.values()), target)
    shutil.rmtree(parts)
    return target


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
    )


def check_at_least_one(name: str, value: int) -> None:
    """Raise ValueError when a number of things is below 1."""
    if value < 1:
        raise ValueError(f"{name} is {value}, but must be at least 1")


def _discard(folder: pathlib.Path, name: str) -> None:
    """Remove what earlier runs left; the description goes last, so that no data are without one."""
    shutil.rmtree(folder / f"{name}.parts", ignore_errors=True)
    (folder / f"{name}.parquet").unlink(missing_ok=True)
    (folder / f"{name}.json").unlink(missing_ok=True)


def describe(experiments: Experiments) -> dict:
    """Return what determines the table, as JSON: parameters, versions and digest of the code."""

    def plain(value: Any) -> Any:
        if hasattr(value, "_asdict"):
            return {
                "type": type(value).__name__,
                **{k: plain(v) for k, v in value._asdict().items()},
            }
        if isinstance(value, np.ndarray):
            return hashlib.sha256(value.tobytes()).hexdigest()
        return value.item() if isinstance(value, np.generic) else value

    code = find_kernel(type(experiments.policy)), run_experiments, source_digest
    return {
        **{field: plain(value) for field, value in experiments._asdict().items()},
        "hav_env": hav_env.__version__,
        "sources": source_digest(map(source_of, code)),
    }


def write_table(table: pa.Table, path: pathlib.Path) -> None:
    """Write a Parquet file, whole or not at all."""
    with whole_file(path) as unfinished:
        pq.write_table(table, unfinished)


def _claim(path: pathlib.Path, description: dict) -> None:
    """Write down what is run here, or check that it is what was begun."""
    if not path.exists():
        data = path.with_suffix(".parquet"), path.with_suffix(".parts")
        if any(kept.exists() for kept in data):
            raise ValueError(f"{path.parent} holds results that nothing describes: use --overwrite")
        write_text(json.dumps(description, indent=2) + "\n", path)
        return
    begun = json.loads(path.read_text())
    for key, value in json.loads(json.dumps(description)).items():
        if begun.get(key) != value:
            what = "was made by other code" if key == "sources" else f"has another {key}"
            raise ValueError(
                f"{path.parent} holds a run that {what}: choose another --output, or --overwrite"
            )


def _join(parts: list[pathlib.Path], target: pathlib.Path) -> None:
    with (
        whole_file(target) as unfinished,
        pq.ParquetWriter(unfinished, pq.read_schema(parts[0])) as writer,
    ):
        for part in parts:
            writer.write_table(pq.read_table(part))
