"""This module measures readings of the paper, and each of its open choices, beside its figures."""

import math
import pathlib
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from baselines.cli.progress import Progress
from baselines.evaluation.run_parts import write_table
from baselines.evaluation.runs import check_experiments, run_experiments
from baselines.experiments.published import (
    PAPER_SIZES,
    PUBLISHED,
    closeness,
    measure_published,
)
from baselines.experiments.readings import READINGS, TEXT, Reading, vary
from baselines.experiments.reproduce import job_of
from baselines.storage.locks import sole_user

CHOICES = (
    *(
        vary(TEXT, f"steering_max {degrees} deg", fleet={"steering_max": math.radians(degrees)})
        for degrees in (35, 38, 42, 45, 50)
    ),
    *(
        vary(TEXT, f"close_factor {factor}", policy={"close_factor": factor})
        for factor in (1.0, 3.0, 3.25, 3.75, 4.0)
    ),
    vary(TEXT, "trailer count rounded", fleet={"trailer_offset": 0.5}),
    vary(TEXT, "trailer count drawn again", fleet={"trailer_redraw": True}),
    vary(TEXT, "all derivatives at once", vehicle={"simultaneous": True}),
    vary(TEXT, "10 Euler substeps", vehicle={"substeps": 10}),
    vary(TEXT, "next goals alone", task={"next_goal": "alone"}),
    vary(TEXT, "HAVs in turn", task={"order": "in_turn"}),
    *(vary(TEXT, f"record_every {every}", task={"record_every": every}) for every in (10, 100)),
    *(
        vary(TEXT, f"straight_below {limit} m", policy={"straight_below": limit})
        for limit in (1e-9, 0.05, 0.2)
    ),
    *(
        vary(TEXT, f"footprint_truck_share {share}", fleet={"footprint_truck_share": share})
        for share in (0.5, 1.0)
    ),
    *(
        vary(
            TEXT,
            f"evasion and potential collision: truck share {share}",
            policy={"evasion_truck_share": share},
            task={"potential_truck_share": share},
        )
        for share in (0.5, 1.0)
    ),
    *(
        vary(TEXT, f"evasion_truck_share {share}", policy={"evasion_truck_share": share})
        for share in (0.5, 1.0)
    ),
    vary(TEXT, "evasion_clipped", policy={"evasion_clipped": True}),
    *(
        vary(TEXT, f"evasion_release {factor}", policy={"evasion_release": factor})
        for factor in (1.2, 1.5, 2.0)
    ),
    vary(TEXT, "jackknife weight c = 3", policy={"c": 3.0}),
    vary(TEXT, "jackknife weight c = 1", policy={"c": 1.0}),
)
CALIBRATED = (*READINGS.values(), *CHOICES)


def calibrate(
    experiments: int,
    seed: int = 0,
    output: pathlib.Path = pathlib.Path("results/calibrate"),
    threads: int | None = None,
    overwrite: bool = False,
) -> list[list[str]]:
    """Measure the paper's eight figures in every reading, and for every single changed choice.

    Writes calibration.parquet with a row for each reading and choice. For each figure, a row has
    its share, the bounds of its 95 % interval and its standardized difference from the published
    share. An interrupted run continues where it stopped.

    Args:
        experiments: Number of experiments of each size and row.
        seed: Seed of all of them: the rows are compared on the same episodes if possible.
        output: Folder of the results.
        threads: Number of threads.
        overwrite: Whether to discard the results of an earlier run in the folder.

    Raises:
        ValueError: If a parameter is not allowed, or the folder holds another run.
        OSError: If the folder cannot be written.

    Returns:
        The table as rows of text, the paper's figures first.
    """
    jobs = [
        {size: job_of(row, size, experiments, seed) for size in PAPER_SIZES} for row in CALIBRATED
    ]
    for job in (job for both in jobs for job in both.values()):
        check_experiments(job, threads, "experiments")
    folder = output / "choices"
    measured = []
    with sole_user(output), sole_user(folder):
        with Progress(2 * experiments * len(CALIBRATED)) as progress:
            how = threads, overwrite, progress.advance
            for number, (row, both) in enumerate(zip(CALIBRATED, jobs, strict=True)):
                tables = {
                    size: pq.read_table(run_experiments(job, folder, f"{number:02d}-{size}", *how))
                    for size, job in both.items()
                }
                measured.append({"reading": row.name} | _measure(tables, row))
        write_table(pa.Table.from_pylist(measured), output / "calibration.parquet")
    return _show(measured)


def _measure(tables: dict[str, pa.Table], reading: Reading) -> dict[str, float]:
    near = closeness(tables, reading.jackknifed)
    measured = {"chi2": near.chi2, "few_trailers": near.few}
    for published in PUBLISHED:
        here = measure_published(tables[published.scenario], published, reading.jackknifed)
        measured[published.key] = here.value
        measured[f"{published.key} low"] = here.low
        measured[f"{published.key} high"] = here.high
        measured[f"{published.key} z"] = near.deviations[published.key]
    return measured


def _show(measured: list[dict[str, Any]]) -> list[list[str]]:
    """Return the shares in percent, with the published ones above them."""
    head = ["reading", *(f"{published.key} [%]" for published in PUBLISHED), "chi2"]
    paper = ["the paper", *(f"{100 * p.events / p.size:.2f}" for p in PUBLISHED), ""]
    return [head, paper, *([row["reading"], *_cells(row)] for row in measured)]


def _cells(row: dict[str, Any]) -> list[str]:
    shares = [f"{100 * row[published.key]:.2f}" for published in PUBLISHED]
    return [*shares, f"{row['chi2']:.0f}"]
