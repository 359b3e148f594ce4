"""This module reproduces the paper's experiments, compares their figures, and draws them."""

import pathlib
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from baselines.cli.markup import code, markdown
from baselines.cli.progress import Progress
from baselines.evaluation.runs import Experiments, check_experiments, run_experiments
from baselines.experiments.paper_claims import fingerprints
from baselines.policies.avoid_jack import AvoidJack
from baselines.storage.atomic_files import write_text
from baselines.storage.locks import sole_user
from hav_env import OnAxle
from hav_env.evaluation.comparison import compare
from hav_env.evaluation.figures import (
    GOAL_HIT,
    Figure,
    figure_of_event,
    figure_of_goal,
    measure,
)
from hav_env.evaluation.statistics import proportions_agree, wilson
from hav_env.scenarios.presets import SCENARIOS
from hav_env.world.arrays import ACTUAL, JACKKNIFE, POTENTIAL
from hav_env.world.event_table import EVENTS


class Published(NamedTuple):
    """One figure of the paper, section VI: how many of how many HAVs."""

    scenario: str
    figure: Figure
    name: str
    """As the paper calls it."""
    events: int
    size: int


_FIRST_GOAL, _SECOND_GOAL = (figure_of_goal(GOAL_HIT, goal) for goal in (1, 2))
_JACKKNIFES, _CIRCLES_MET, _COLLISIONS = (
    figure_of_event(EVENTS[row]) for row in (JACKKNIFE, POTENTIAL, ACTUAL)
)
PUBLISHED = (
    Published("single", _JACKKNIFES, "jackknifed", 7, 4500),
    Published("single", _FIRST_GOAL, "first goal", 3904, 4500),
    Published("single", _SECOND_GOAL, "second goal", 3754, 4500),
    Published("pair", _JACKKNIFES, "jackknifed", 95, 9000),
    Published("pair", _FIRST_GOAL, "first goal", 7142, 9000),
    Published("pair", _SECOND_GOAL, "second goal", 5856, 9000),
    Published("pair", _CIRCLES_MET, "potential collision", 8516, 9000),
    Published("pair", _COLLISIONS, "actual collision", 26, 9000),
)

PAPER_EXPERIMENTS = 4_500  # of each scenario


def reproduce(
    policy=AvoidJack(),
    experiments: int = PAPER_EXPERIMENTS,
    seed: int = 0,
    output: pathlib.Path = pathlib.Path("results/reproduce"),
    threads: int | None = None,
    overwrite: bool = False,
    vehicle=OnAxle(),
) -> list[list[str]]:
    """Run the paper's experiments with a policy and report them.

    Writes into the output folder single.parquet and pair.parquet (one row per HAV and experiment),
    report.md and the figures. Interrupted, it goes on where it stopped.

    Args:
        policy: drives every HAV.
        experiments: how many with a single HAV, and as many with two.
        seed: of all of them; the same seed gives the same files.
        output: the folder.
        threads: how many; by default ``HAV_THREADS`` or all cores.
        overwrite: discard what an earlier run left in the folder.
        vehicle: the kinematics.

    Returns:
        The table beside the paper's, as rows of text.

    Raises:
        ValueError: when a parameter is not allowed, or the folder holds another run.
        OSError: when the folder cannot be written.
    """
    jobs = {
        name: Experiments(policy, SCENARIOS[f"paper-{name}"], experiments, seed, vehicle=vehicle)
        for name in ("single", "pair")
    }
    for job in jobs.values():
        check_experiments(job, threads, "experiments")
    with sole_user(output):
        with Progress(2 * experiments) as progress:
            how = threads, overwrite, progress.advance
            paths = {name: run_experiments(job, output, name, *how) for name, job in jobs.items()}
        tables = {name: pq.read_table(path) for name, path in paths.items()}
        rows = beside_paper(tables["single"], tables["pair"])
        drawn = _draw(tables, output, policy, seed, vehicle)
        write_text(_report(policy, experiments, seed, rows, tables, drawn), output / "report.md")
    return rows


def beside_paper(single: pa.Table, pair: pa.Table) -> list[list[str]]:
    """Return the published figures beside the measured ones, with 95 % Wilson intervals.

    Intervals are clustered by experiment. The paper gives counts of HAVs only, so its intervals
    have the design effect that is measured here: the best estimate that there is.

    Args:
        single: table of the experiments with one HAV.
        pair: table of those with two.
    """
    tables = {"single": single, "pair": pair}
    rows = [["scenario", "figure", "paper", "here", "difference", "agree"]]
    for published in PUBLISHED:
        here = measure(tables[published.scenario], published.figure)
        paper = wilson(published.events, published.size, here.design_effect)
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
    return rows


def _draw(
    tables: dict[str, pa.Table], output: pathlib.Path, policy, seed: int, vehicle
) -> list[str]:
    from baselines.figures.paper import draw_all  # noqa: PLC0415  # matplotlib is an extra

    scenarios = SCENARIOS["paper-single"], SCENARIOS["paper-pair"]
    return draw_all(
        tables["single"], tables["pair"], output, policy, *scenarios, seed, vehicle=vehicle
    )


def _show(policy) -> str:
    """Return a policy with its parameters; of arrays only how many numbers they hold."""
    told = [
        f"{field}={f'{value.size} numbers' if isinstance(value, np.ndarray) else repr(value)}"
        for field, value in policy._asdict().items()
    ]
    return f"{type(policy).__name__}({', '.join(told)})"


def _report(
    policy,
    experiments: int,
    seed: int,
    rows: list[list[str]],
    tables: dict[str, pa.Table],
    drawn: list[str],
) -> str:
    name = type(policy).__name__
    parts = [
        f"# {name} in the paper's experiments\n",
        f"{experiments} experiments with one HAV and {experiments} with two, seed {seed}, policy"
        f" {code(_show(policy))}.\n\n"
        '"agree": the 95 % interval of the difference (Newcombe, from the Wilson intervals shown in'
        " brackets) contains zero.\n",
        markdown(rows),
    ]
    for scenario, table in tables.items():
        parts += [f"## {scenario}\n", markdown(compare([name], [table]))]
    parts += [
        "## What else the paper says\n",
        markdown(fingerprints(tables["single"], tables["pair"])),
    ]
    parts += ["## Figures\n", *(f"![{file}]({file})\n" for file in drawn if file.endswith("png"))]
    parts.append("The columns of the tables are described in docs/metrics.md.\n")
    return "\n".join(parts)
