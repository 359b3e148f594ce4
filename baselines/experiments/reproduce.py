"""This module reproduces the paper's experiments, compares their figures, and draws them."""

import concurrent.futures
import itertools
import pathlib
from collections.abc import Iterable, Iterator

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from baselines.cli.drawing import can_draw
from baselines.cli.markup import code, markdown
from baselines.cli.progress import Progress
from baselines.evaluation.runs import Experiments, check_experiments, run_experiments
from baselines.experiments.paper_claims import fingerprints
from baselines.experiments.published import (
    PAPER_EXPERIMENTS,
    PAPER_SIZES,
    PUBLISHED,
    closeness,
    counting,
    measure_published,
    published_interval,
)
from baselines.experiments.readings import TEXT, Reading, scenario_of_reading
from baselines.experiments.side_thread import side_thread
from baselines.storage.atomic_files import write_text
from baselines.storage.locks import sole_user
from hav_env.evaluation.comparison import compare
from hav_env.evaluation.statistics import proportions_agree

# 95 % quantile of eight independent figures; a HAV that hits its second goal has hit its first, so
# a true reading exceeds it somewhat more often
CHI2_LIMIT = 15.5


def reproduce(
    reading: Reading = TEXT,
    experiments: int = PAPER_EXPERIMENTS,
    seed: int = 0,
    output: pathlib.Path = pathlib.Path("results/reproduce"),
    threads: int | None = None,
    overwrite: bool = False,
) -> list[list[str]]:
    """Run the paper's experiments in a reading of the paper and report them.

    Writes into the output folder single.parquet and pair.parquet (one row per HAV and experiment),
    report.md and the figures. An interrupted run continues where it stopped.

    Args:
        reading: Policy, fleet, rules and kinematics.
        experiments: Number of experiments with a single HAV, and also with two.
        seed: Seed of all of them; the same seed gives the same files.
        output: Folder of the results.
        threads: Number of threads of the simulation; by default ``HAV_THREADS`` or all cores. One
            more thread draws.
        overwrite: Whether to discard the results of an earlier run in the folder.

    Returns:
        The table beside the paper's, as rows of text.

    Raises:
        ValueError: If a parameter is not allowed, or the folder holds another run.
        OSError: If the folder cannot be written.
    """
    jobs = {size: job_of(reading, size, experiments, seed) for size in PAPER_SIZES}
    for job in jobs.values():
        check_experiments(job, threads, "experiments")
    tables: dict[str, pa.Table] = {}
    drawn, draws = [], can_draw()
    with sole_user(output), side_thread("drawing") as submit:
        with Progress(2 * experiments) as progress:
            for name, job in jobs.items():
                path = run_experiments(job, output, name, threads, overwrite, progress.advance)
                tables[name] = pq.read_table(path)
                if draws:
                    drawn.append(submit(_draw(jobs, dict(tables), output, name)))
        rows = beside_paper(tables, reading)
        text = _report(reading, experiments, seed, rows, tables, _files(drawn))
        write_text(text, output / "report.md")
    return rows


def job_of(reading: Reading, size: str, experiments: int, seed: int) -> Experiments:
    """Return the experiments of a reading.

    Args:
        reading: Policy, fleet, rules and kinematics.
        size: "single" or "pair".
        experiments: Number of episodes.
        seed: Seed of the episodes.
    """
    scenario = scenario_of_reading(reading, size)
    return Experiments(reading.policy, scenario, experiments, seed, reading.task, reading.vehicle)


def beside_paper(tables: dict[str, pa.Table], reading: Reading = TEXT) -> list[list[str]]:
    """Return the published figures beside the measured ones, with 95 % intervals, and chi2.

    Args:
        tables: Tables by size, "single" and "pair".
        reading: Reading that was run.
    """
    rows = [["scenario", "figure", "paper", "here", "difference", "agree"]]
    for published in PUBLISHED:
        here = measure_published(tables[published.scenario], published, reading.jackknifed)
        paper = published_interval(published, here)
        rows.append(
            [
                published.scenario,
                published.name,
                paper.show(percent=True),
                here.show(percent=True),
                f"{100 * (here.value - paper.value):+.2f} pp",
                "yes" if proportions_agree(here, paper) else "no",
            ]
        )
    chi2 = closeness(tables, reading.jackknifed).chi2
    agrees = "yes" if chi2 < CHI2_LIMIT else "no"
    rows.append(["both", "chi2 of all eight", f"below {CHI2_LIMIT}", f"{chi2:.1f}", "", agrees])
    return rows


def _draw(
    jobs: dict[str, Experiments], tables: dict[str, pa.Table], output: pathlib.Path, name: str
) -> Iterator[list[str]]:
    """Draw the figures whose table was missing."""
    # matplotlib is an extra; a thread imports it during the simulation
    from baselines.figures.all_figures import draw_pair, draw_single  # noqa: PLC0415

    if name == "single":
        yield from draw_single(jobs[name], tables[name], output)
    else:
        yield from draw_pair(jobs[name], tables[name], tables["single"], output)


def _files(drawn: list[concurrent.futures.Future[list[list[str]]]]) -> Iterator[str]:
    """Yield the names of the drawn files, once all are complete."""
    figures = [files for done in drawn for files in done.result()]
    if not figures:
        return
    from baselines.figures.all_figures import in_order  # noqa: PLC0415  # matplotlib is an extra

    yield from in_order(itertools.chain.from_iterable(figures))


def _show(model) -> str:
    """Return a model with its parameters; for arrays only the number of entries."""
    fields = [
        f"{field}={f'{value.size} numbers' if isinstance(value, np.ndarray) else repr(value)}"
        for field, value in model._asdict().items()
    ]
    return f"{type(model).__name__}({', '.join(fields)})"


def _report(
    reading: Reading,
    experiments: int,
    seed: int,
    rows: list[list[str]],
    tables: dict[str, pa.Table],
    drawn: Iterable[str],
) -> str:
    policy, name = reading.policy, type(reading.policy).__name__
    parts = [
        f"# {name} in the paper's experiments\n",
        f"{experiments} experiments with one HAV and {experiments} with two, seed {seed}, reading"
        f" {code(reading.name)}: {reading.told}.\n\n"
        f"Policy {code(_show(policy))}, fleet {code(_show(reading.fleet))}, rules"
        f" {code(_show(reading.task))}, kinematics {code(_show(reading.vehicle))}.\n\n"
        '"agree": the 95 % interval of the difference (Newcombe, from the Wilson intervals shown in'
        " brackets) contains zero. Experiments are the units: the two HAVs of a pair depend on each"
        " other. chi2 is the sum of the squared standardized differences.\n\n"
        "Figures, and the tables by scenario, count jackknifes beyond the articulation limit.\n",
        markdown(rows),
    ]
    for scenario, table in tables.items():
        parts += [f"## {scenario}\n", markdown(compare([name], [table]))]
    parts += [
        "## Other claims of the paper\n",
        markdown(fingerprints(*(counting(tables[s], reading.jackknifed) for s in PAPER_SIZES))),
    ]
    pictures = [f"![{file}]({file})\n" for file in drawn if file.endswith("png")]
    parts += ["## Figures\n", *pictures] if pictures else []
    parts.append("The columns of the tables are described in docs/metrics.md.\n")
    return "\n".join(parts)
