"""Experiments on disk: written as they go, resumed, and never half a file."""

import json
import os
import pathlib
import shutil
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

import hav_env
from baselines.rollout import rollout
from hav_env import Task
from hav_env.batch import check_seed
from hav_env.compiled import source_digest
from hav_env.vehicles import OnAxle

PART = 500  # episodes in one part: a few seconds of work, and what memory holds at a time


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
    advance: Callable[[int, int], None] = lambda episodes, steps: None,
) -> pathlib.Path:
    """Run experiments and keep their table as ``name.parquet`` in a folder.

    What an interrupted run has written is kept in ``name.parts`` and not run again. The file is the
    same, byte for byte, however often the run was interrupted.

    Args:
        experiments: what to run.
        folder: made if it does not exist.
        name: of the table.
        threads: how many.
        advance: called after every part with its numbers of episodes and of moving HAV-steps.

    Returns:
        The path of the table.

    Raises:
        ValueError: when the folder holds another run under this name, or a parameter is wrong.
        OSError: when the folder cannot be written.
    """
    check_at_least_one("episodes", experiments.num_episodes)
    check_seed(experiments.seed)
    if threads is not None:
        check_at_least_one("threads", threads)
    parts = folder / f"{name}.parts"
    target = folder / f"{name}.parquet"
    parts.mkdir(parents=True, exist_ok=True)
    _claim(folder / f"{name}.json", describe(experiments))
    spans = [
        range(first, min(first + PART, experiments.num_episodes))
        for first in range(0, experiments.num_episodes, PART)
    ]
    for span in spans:
        part = parts / f"{span.start:09d}.parquet"
        if not target.exists() and not part.exists():
            table = rollout(
                experiments.policy,
                experiments.scenario,
                experiments.seed,
                np.arange(span.start, span.stop),
                experiments.task,
                experiments.vehicle,
                threads,
            )
            write_table(table, part)
            advance(len(span), int(np.sum(table["moving_steps"].to_numpy())))
        else:
            advance(len(span), 0)
    if not target.exists():
        _join([parts / f"{span.start:09d}.parquet" for span in spans], target)
    shutil.rmtree(parts)
    return target


def check_at_least_one(name: str, value: int) -> None:
    """Raise ValueError when a number of things is below 1."""
    if value < 1:
        raise ValueError(f"{name} is {value}, but must be at least 1")


def discard(folder: pathlib.Path, names: Iterable[str]) -> None:
    """Remove what earlier runs left in a folder under these names."""
    for name in names:
        for suffix in ("parquet", "json"):
            (folder / f"{name}.{suffix}").unlink(missing_ok=True)
        shutil.rmtree(folder / f"{name}.parts", ignore_errors=True)


def describe(experiments: Experiments) -> dict:
    """Return what determines the table, as JSON: parameters, versions and digest of the code."""

    def plain(value: Any) -> Any:
        if hasattr(value, "_asdict"):
            return {
                "type": type(value).__name__,
                **{k: plain(v) for k, v in value._asdict().items()},
            }
        return value.tolist() if isinstance(value, np.ndarray) else value

    return {
        **{field: plain(value) for field, value in experiments._asdict().items()},
        "hav_env": hav_env.__version__,
        "sources": source_digest(),
    }


def write_table(table: pa.Table, path: pathlib.Path) -> None:
    """Write a Parquet file, whole or not at all."""
    unfinished = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    try:
        pq.write_table(table, unfinished)
        os.replace(unfinished, path)
    finally:
        unfinished.unlink(missing_ok=True)


def write_text(text: str, path: pathlib.Path) -> None:
    """Write a text file, whole or not at all."""
    unfinished = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    try:
        unfinished.write_text(text)
        os.replace(unfinished, path)
    finally:
        unfinished.unlink(missing_ok=True)


def _claim(path: pathlib.Path, description: dict) -> None:
    """Write down what is run here, or check that it is what was begun."""
    if not path.exists():
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
    unfinished = target.with_name(f"{target.name}.{os.getpid()}.tmp")
    try:
        with pq.ParquetWriter(unfinished, pq.read_schema(parts[0])) as writer:
            for part in parts:
                writer.write_table(pq.read_table(part))
        os.replace(unfinished, target)
    finally:
        unfinished.unlink(missing_ok=True)
