"""This module searches for readings of the paper that come near its figures.

The search halves its field in rounds: many readings on few experiments, then fewer on more. Fitting
and confirmation use different seeds, and the result states the number of readings tried: a
selection is not a proof.
"""

import functools
import json
import pathlib
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa

from baselines.cli.progress import Progress
from baselines.evaluation.run_description import claim, describe_run
from baselines.evaluation.run_parts import write_table
from baselines.evaluation.runs import Experiments, check_experiments
from baselines.experiments.published import (
    JACKKNIFE_FIGURE,
    PAPER_EXPERIMENTS,
    PAPER_SIZES,
    PUBLISHED,
    Closeness,
    closeness,
)
from baselines.experiments.readings import TEXT, Reading, scenario_of_reading
from baselines.experiments.search_space import (
    RECORDS,
    name_of_single,
    pair_readings,
    single_readings,
    sparsely_recorded,
)
from baselines.storage.locks import sole_user
from hav_env.evaluation.rollout import rollout
from hav_env.simulator.batch import check_seed

FITTING_SEED = 100
CONFIRMING_SEEDS = 3  # number of seeds after the fitting seed


class Round(NamedTuple):
    """One round of the search."""

    experiments: int
    """Number of experiments of each size per reading."""
    kept: int
    """Number of readings that proceed to the next round."""


class Plan(NamedTuple):
    """Rounds of a search."""

    single: Round = Round(500, 120)
    more_singles: Round = Round(PAPER_EXPERIMENTS, 24)
    pair: Round = Round(100, 160)
    more_pairs: Round = Round(500, 24)
    both: Round = Round(1_000, 12)
    full: Round = Round(PAPER_EXPERIMENTS, 3)
    confirm: int = PAPER_EXPERIMENTS
    """Number of experiments of each size with each confirming seed."""


class Scored(NamedTuple):
    """A reading with its distance from the paper on some experiments."""

    reading: Reading
    round: str
    seed: int
    experiments: int
    near: Closeness


def search(
    seed: int = FITTING_SEED,
    output: pathlib.Path = pathlib.Path("results/search"),
    threads: int | None = None,
    overwrite: bool = False,
    plan: Plan = Plan(),
) -> list[Scored]:
    """Search for readings that come near the published figures.

    Writes search.parquet, with a row for each reading and round. An interrupted run continues where
    it stopped.

    Args:
        seed: Seed of the experiments that fit readings; the next seeds confirm the last readings.
        output: Folder of the results.
        threads: Number of threads.
        overwrite: Whether to discard the results of an earlier run in the folder.
        plan: Rounds of the search.

    Returns:
        All measurements, by round, nearest first.

    Raises:
        ValueError: If a parameter is not allowed, or the folder holds another search.
        OSError: If the folder cannot be written.
    """
    job = Experiments(TEXT.policy, scenario_of_reading(TEXT, "pair"), plan.confirm, seed)
    check_experiments(job, threads, "experiments")
    check_seed(seed + CONFIRMING_SEEDS)
    with sole_user(output), Progress(_count_experiments(plan)) as progress:
        measured = _Measurements(output, job, plan, threads, overwrite, progress.advance)
        found = list(_rounds(measured, plan, seed))
        write_table(_tabulate(found), output / "search.parquet")
    return found


def _rounds(measured: "_Measurements", plan: Plan, seed: int) -> Iterator[Scored]:
    """Yield the measurements of each round, nearest first."""

    def play(name: str, readings: list[Reading], size: Round, sizes: tuple[str, ...]):
        scored = [
            Scored(reading, name, seed, size.experiments, near)
            for reading in readings
            for near in [measured.of(reading, seed, size.experiments, sizes)]
        ]
        return sorted(scored, key=lambda one: one.near.score)

    kept = list(single_readings())
    for name, size in (("single", plan.single), ("more singles", plan.more_singles)):
        singles = play(name, kept, size, ("single",))
        yield from singles
        kept = [one.reading for one in singles[: size.kept]]
    # the score of the single HAVs is part of the score of their pairs
    ahead = {one.reading.name: one.near.score for one in singles}
    trials = [pair for reading in kept for pair in pair_readings(reading)]
    for name, size in (("pair", plan.pair), ("more pairs", plan.more_pairs)):
        pairs = play(name, trials, size, ("pair",))
        pairs.sort(key=lambda one: one.near.score + ahead[name_of_single(one.reading)])
        yield from pairs
        trials = [one.reading for one in pairs[: size.kept]]
    trials += [sparse for reading in trials for sparse in sparsely_recorded(reading)]
    both = play("both", trials, plan.both, PAPER_SIZES)
    yield from both
    full = play("full", [one.reading for one in both[: plan.both.kept]], plan.full, PAPER_SIZES)
    yield from full
    for one in full[: plan.full.kept]:
        for other in range(seed + 1, seed + 1 + CONFIRMING_SEEDS):
            near = measured.of(one.reading, other, plan.confirm, PAPER_SIZES)
            yield Scored(one.reading, "confirm", other, plan.confirm, near)


def _count_experiments(plan: Plan) -> int:
    """Return the number of experiments of all rounds."""
    singles = list(single_readings())
    pairs = plan.more_singles.kept * len(list(pair_readings(singles[0])))
    both = plan.more_pairs.kept * (1 + len(RECORDS))
    return (
        len(singles) * plan.single.experiments
        + plan.single.kept * plan.more_singles.experiments
        + pairs * plan.pair.experiments
        + plan.pair.kept * plan.more_pairs.experiments
        + 2 * both * plan.both.experiments
        + 2 * plan.both.kept * plan.full.experiments
        + 2 * plan.full.kept * CONFIRMING_SEEDS * plan.confirm
    )


class _Measurements:
    """Measurements of readings, stored in a file line by line."""

    def __init__(
        self,
        folder: pathlib.Path,
        job: Experiments,
        plan: Plan,
        threads: int | None,
        overwrite: bool,
        advance: Callable[[int, int], None],
    ) -> None:
        self._threads, self._advance = threads, advance
        self._path, description = folder / "search.jsonl", folder / "search.json"
        if overwrite:
            for path in (self._path, description, folder / "search.parquet"):
                path.unlink(missing_ok=True)
        described = describe_run(job, (search, closeness)) | {"plan": json.loads(json.dumps(plan))}
        claim(description, described)
        self._known = dict(_read_lines(self._path))
        with self._path.open("a", encoding="utf-8") as file:
            file.write("\n")  # the last line may be incomplete if the run was killed

    def of(self, reading: Reading, seed: int, count: int, sizes: tuple[str, ...]) -> Closeness:
        """Return the distance of a reading from the figures of some sizes, measured or stored."""
        key = json.dumps([reading.name, seed, count, sizes])
        if key in self._known:
            self._advance(count * len(sizes), 0)
            return self._known[key]
        tables = self._run(
            reading._replace(name="", told="", jackknifed=JACKKNIFE_FIGURE),
            seed,
            count,
            sizes,
        )
        self._advance(count * len(sizes), _steps_in(tables))
        near = closeness(tables, reading.jackknifed)
        with self._path.open("a", encoding="utf-8") as file:
            file.write(json.dumps([key, near.plain()]) + "\n")
        self._known[key] = near
        return near

    @functools.lru_cache(maxsize=1)  # noqa: B019  # readings that count other jackknifes follow
    def _run(
        self, reading: Reading, seed: int, count: int, sizes: tuple[str, ...]
    ) -> dict[str, pa.Table]:
        return {size: rollout_of(reading, size, seed, count, self._threads) for size in sizes}


def _steps_in(tables: dict[str, pa.Table]) -> int:
    return sum(int(np.sum(table["moving_steps"].to_numpy())) for table in tables.values())


def _read_lines(path: pathlib.Path) -> Iterator[tuple[str, Closeness]]:
    """Yield the complete lines of a file of measurements; the last may be incomplete."""
    if not path.exists():
        return
    for line in path.read_text(encoding="utf-8").splitlines():
        try:
            key, plain = json.loads(line)
            yield key, Closeness(*plain)
        except (ValueError, TypeError, KeyError):
            continue


def rollout_of(reading: Reading, size: str, seed: int, count: int, threads: int | None) -> pa.Table:
    """Return the table of experiments of a reading; nothing is stored on disk.

    Args:
        reading: Policy, fleet, rules and kinematics.
        size: "single" or "pair".
        seed: Seed of the experiments.
        count: Number of experiments.
        threads: Number of threads.
    """
    scenario, numbers = scenario_of_reading(reading, size), np.arange(count)
    return rollout(reading.policy, scenario, seed, numbers, reading.task, reading.vehicle, threads)


def _tabulate(found: list[Scored]) -> pa.Table:
    rows: list[dict[str, Any]] = []
    for one in found:
        head = {"reading": one.reading.name, "round": one.round, "seed": one.seed}
        head |= {"experiments": one.experiments}
        head |= {"chi2": one.near.chi2, "few": one.near.few}
        shares = {published.key: one.near.shares.get(published.key) for published in PUBLISHED}
        rows.append(head | shares)
    return pa.Table.from_pylist(rows)
