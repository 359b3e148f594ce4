"""This module measures the effect of every choice that the paper leaves open, one at a time."""

import math
import pathlib
from typing import Any, NamedTuple

import pyarrow as pa
import pyarrow.parquet as pq

from baselines.cli.progress import Progress
from baselines.evaluation.run_parts import write_table
from baselines.evaluation.runs import Experiments, check_experiments, run_experiments
from baselines.experiments.reproduce import PUBLISHED
from baselines.policies.avoid_jack import AvoidJack
from baselines.storage.locks import sole_user
from hav_env.evaluation.figures import FOLDED_THROUGH, measure
from hav_env.scenarios.presets import SCENARIOS
from hav_env.vehicles import OnAxle


class Choice(NamedTuple):
    """One reading of the paper: what differs from the defaults."""

    name: str
    policy: dict[str, Any] = {}  # noqa: RUF012  # never written to
    fleet: dict[str, Any] = {}  # noqa: RUF012
    vehicle: OnAxle = OnAxle()


CHOICES = (
    Choice("defaults"),
    *(
        Choice(f"steering_max {degrees} deg", fleet={"steering_max": math.radians(degrees)})
        for degrees in (35, 38, 42, 45, 50)
    ),
    *(
        Choice(f"close_factor {factor}", {"close_factor": factor})
        for factor in (1.0, 3.0, 3.25, 3.75, 4.0)
    ),
    Choice("trailer count rounded", fleet={"trailer_offset": 0.5}),
    Choice("trailer count drawn again", fleet={"trailer_redraw": True}),
    Choice("all derivatives at once", vehicle=OnAxle(simultaneous=True)),
    Choice("10 Euler substeps", vehicle=OnAxle(substeps=10)),
    Choice(
        "50 deg, close_factor 1, all at once",
        {"close_factor": 1.0},
        {"steering_max": math.radians(50.0)},
        OnAxle(simultaneous=True),
    ),
    Choice(
        "45 deg, close_factor 3.25", {"close_factor": 3.25}, {"steering_max": math.radians(45.0)}
    ),
    *(
        Choice(f"straight_below {limit} m", {"straight_below": limit})
        for limit in (1e-9, 0.05, 0.2)
    ),
    *(Choice(f"footprint_truck_share {s}", fleet={"footprint_truck_share": s}) for s in (0.5, 1.0)),
    *(Choice(f"evasion_truck_share {s}", {"evasion_truck_share": s}) for s in (0.5, 1.0)),
    *(Choice(f"evasion_release {r}", {"evasion_release": r}) for r in (1.2, 1.5, 2.0)),
    Choice("jackknife weight c = 3", {"c": 3.0}),
    Choice("jackknife weight c = 1", {"c": 1.0}),
)


def calibrate(
    experiments: int,
    seed: int = 0,
    output: pathlib.Path = pathlib.Path("results/calibrate"),
    threads: int | None = None,
    overwrite: bool = False,
) -> list[list[str]]:
    """Measure the paper's eight figures for every choice.

    Writes calibration.parquet: a row for each choice, and for each figure its share and the bounds
    of its 95 % Wilson interval. Interrupted, it goes on where it stopped.

    Args:
        experiments: how many of each scenario and choice.
        seed: of all of them: the choices are compared on the same episodes where they can be.
        output: the folder.
        threads: how many.
        overwrite: discard what an earlier run left in the folder.

    Raises:
        ValueError: when a parameter is not allowed, or the folder holds another run.
        OSError: when the folder cannot be written.

    Returns:
        The table as rows of text, the paper's figures first.
    """
    jobs = [_jobs(choice, experiments, seed) for choice in CHOICES]
    for job in (job for both in jobs for job in both.values()):
        check_experiments(job, threads, "experiments")
    folder = output / "choices"
    rows = []
    with sole_user(output), sole_user(folder):
        with Progress(2 * experiments * len(CHOICES)) as progress:
            how = threads, overwrite, progress.advance
            for number, (choice, both) in enumerate(zip(CHOICES, jobs, strict=True)):
                row: dict[str, Any] = {"choice": choice.name}
                for scenario, job in both.items():
                    path = run_experiments(job, folder, f"{number:02d}-{scenario}", *how)
                    row |= _measure(path, scenario)
                rows.append(row)
        write_table(pa.Table.from_pylist(rows), output / "calibration.parquet")
    return _show(rows)


def _jobs(choice: Choice, experiments: int, seed: int) -> dict[str, Experiments]:
    """Return the experiments of a choice, by the paper's scenario."""
    policy, jobs = AvoidJack()._replace(**choice.policy), {}
    for name in ("single", "pair"):
        preset = SCENARIOS[f"paper-{name}"]
        scenario = preset._replace(fleet=preset.fleet._replace(**choice.fleet))
        jobs[name] = Experiments(policy, scenario, experiments, seed, vehicle=choice.vehicle)
    return jobs


def _measure(path: pathlib.Path, scenario: str) -> dict[str, float]:
    figures = [published.figure for published in PUBLISHED if published.scenario == scenario]
    figures.append(FOLDED_THROUGH)
    table = pq.read_table(path, columns=[figure.column for figure in figures])
    measured = {}
    for figure in figures:
        interval, column = measure(table, figure), figure.column
        measured[f"{scenario}_{column}"] = interval.value
        measured[f"{scenario}_{column}_low"] = interval.low
        measured[f"{scenario}_{column}_high"] = interval.high
    return measured


def _show(rows: list[dict[str, Any]]) -> list[list[str]]:
    """Return the shares in percent, the published ones above them."""
    head = ["choice", *(f"{p.scenario} {p.name} [%]" for p in PUBLISHED)]
    paper = ["published", *(f"{100 * p.events / p.size:.2f}" for p in PUBLISHED)]
    shown = [
        [row["choice"], *(f"{100 * row[f'{p.scenario}_{p.figure.column}']:.2f}" for p in PUBLISHED)]
        for row in rows
    ]
    return [head, paper, *shown]
