"""This module surveys all policies, one HAV to swarms: ``python -m baselines.experiments.survey``.

Every policy gets the same episodes, which no policy of this project was made with. The survey
counts apart the worlds that start with chains that touch, and those with goals whose trucks would
cross. No policy can solve these. An interrupted survey goes on where it stopped.
"""

import dataclasses
import math
import pathlib
import sys
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from baselines.cli.markup import file_names, markdown
from baselines.cli.progress import Progress
from baselines.evaluation.feasibility import column, goals_crossing, shortest_times, starts_touching
from baselines.evaluation.runs import Experiments, check_experiments, run_experiments
from baselines.storage.atomic_files import write_text
from baselines.storage.locks import sole_user
from hav_env import Task, find_scenario
from hav_env.cli.options import run_command
from hav_env.evaluation.figures import goals_of
from hav_env.evaluation.statistics import Interval, proportion
from hav_env.policies.names import make_policy
from hav_env.world.event_table import HARM


class Entry(NamedTuple):
    """A scenario of the survey, and its numbers of episodes and steps."""

    scenario: str
    episodes: int
    max_steps: int = 20_000
    policies: tuple[str, ...] = ("avoid_jack", "dubins_pursuit", "ppo_pair", "reserve")


_LONG = ("avoid_jack", "reserve")
SURVEY = (
    Entry(
        "paper-single", 4_500, policies=("avoid_jack", "dubins_pursuit", "ppo_single", "reserve")
    ),
    Entry("paper-pair", 4_500),
    Entry("dense-2", 4_500),
    Entry("swarm-5", 400),
    Entry("dense-5", 400),
    Entry("swarm-10", 200),
    Entry("dense-10", 200),
    Entry("swarm-20", 100),
    Entry("dense-20", 100),
    Entry("swarm-50", 8, 60_000, _LONG),
    Entry("dense-50", 8, 60_000, _LONG),
    Entry("swarm-200", 2, 60_000, _LONG),
)


@dataclasses.dataclass(frozen=True)
class Sample:
    """The share of the episodes that is run, and the folder of the results."""

    share: float = 1.0
    """Share of the episodes, to see something soon; at least one is run."""
    seed: int = 2026
    """Seed of the episodes."""
    output: pathlib.Path = pathlib.Path("results/survey")
    """Folder of the results."""
    threads: int | None = None
    """Number of threads; by default HAV_THREADS or all cores."""
    overwrite: bool = False
    """Discard what an earlier run left in the folder."""


@dataclasses.dataclass(frozen=True)
class Options(Sample):
    """Options of a survey."""

    scenarios: tuple[str, ...] = tuple(entry.scenario for entry in SURVEY)
    """Names of the survey's scenarios."""
    policies: tuple[str, ...] = ()
    """Names, files, or module:Class; by default those that the survey has for each scenario."""


class Run(NamedTuple):
    """One row of a table: which policy is run on which entry, and under which name it is kept."""

    entry: Entry
    name: str
    policy: Any
    task: Task
    label: str


class Findings(NamedTuple):
    """The outcome of a policy in a scenario."""

    harmed: tuple[Interval, ...]
    """Share of HAVs to which each event of ``HARM`` happened; of those alone that can happen."""
    hits: tuple[Interval, ...]
    """Share of HAVs that hit each goal."""
    size: int
    """HAVs in worlds in which all can be done."""
    apart: int
    """Worlds that are counted apart ..."""
    hits_apart: tuple[int, ...]
    """... and the goals that were hit there, of ``apart`` worlds of ``num_havs``."""
    steep: float
    """Mean time to all goals, of HAVs that hit them, in shortest times at the truck's radius."""
    stable: float
    """Mean time to the first goal, in shortest times at a radius that can be driven on for ever."""


def main(words: list[str] | None = None) -> int:
    """Run the survey, report an error in one line, and return the exit code."""
    usage, about = "python -m baselines.experiments.survey", "All policies from one HAV to swarms."
    return run_command(usage, about, Options(), survey, words)


def survey(options: Options) -> str:
    """Run what has not been run; return the table in Markdown, which is written too.

    Raises:
        ValueError, TypeError, OSError: when options are wrong, or the folder holds other results or
            cannot be written.
    """
    entries = {entry.scenario: entry for entry in SURVEY}
    for name in options.scenarios:
        if name not in entries:
            raise ValueError(f"scenarios has {name!r}, which is none of {', '.join(entries)}")
    chosen = [
        (entries[name], policy, make_policy(policy))
        for name in options.scenarios
        for policy in options.policies or entries[name].policies
    ]
    labels = file_names([f"{entry.scenario}-{name}" for entry, name, _ in chosen])
    runs = [
        Run(entry, name, policy, Task(max_steps=entry.max_steps), label)
        for (entry, name, policy), label in zip(chosen, labels, strict=True)
    ]
    return run_all(runs, options)


def run_all(runs: list[Run], sample: Sample) -> str:
    """Run what has not been run; write the table, and return it in Markdown.

    Raises:
        ValueError, TypeError, OSError: as ``survey``.
    """
    jobs = [_job(run, sample) for run in runs]
    for job in jobs:
        check_experiments(job, sample.threads)
    outcomes = []
    with sole_user(sample.output):
        with Progress(sum(job.num_episodes for job in jobs)) as progress:
            how = sample.threads, sample.overwrite, progress.advance
            for run, job in zip(runs, jobs, strict=True):
                path = run_experiments(job, sample.output, run.label, *how)
                found = look_at(pq.read_table(path), job.scenario.fleet)
                outcomes.append((run.entry.scenario, run.name, found))
        report = markdown(rows_of(outcomes))
        write_text(report, sample.output / "report.md")
    return report


def _job(run: Run, sample: Sample) -> Experiments:
    scenario, episodes = find_scenario(run.entry.scenario), episodes_of(run.entry, sample)
    return Experiments(run.policy, scenario, episodes, sample.seed, run.task)


def episodes_of(entry: Entry, sample: Sample) -> int:
    """Return how many episodes of an entry are run.

    Raises:
        ValueError: when the sample's share is none.
    """
    if not 0 < sample.share <= 1:
        raise ValueError(f"share is {sample.share}, but must be above 0 and at most 1")
    return max(1, round(sample.share * entry.episodes))


def look_at(table: pa.Table, fleet) -> Findings:
    """Return what came of a policy.

    Args:
        table: of ``hav_env.evaluation.rollout``, whole episodes.
        fleet: of the scenario, for the limits of speed and steering.
    """
    num_havs = int(np.max(table["hav"].to_numpy())) + 1
    goals = goals_of(table.column_names)
    apart = np.repeat(starts_touching(table, num_havs) | goals_crossing(table, num_havs), num_havs)
    hit = np.stack([column(table, f"goal_{g}_hit") > 0 for g in goals])
    last = column(table, f"goal_{goals[-1]}_step")
    steep, stable = shortest_times(table, fleet)
    episodes = table["episode"].to_numpy()[~apart]
    done, started = ~apart & hit.all(0) & (steep.sum(0) > 0), ~apart & hit[0]
    return Findings(
        tuple(
            proportion(column(table, event.name)[~apart], episodes)
            for event in HARM
            if event.name in table.column_names
        ),
        tuple(proportion(row[~apart], episodes) for row in hit),
        int((~apart).sum()),
        int(apart.sum()) // num_havs,
        tuple(int(row[apart].sum()) for row in hit),
        _share(last[done].sum(), steep.sum(0)[done].sum()) if num_havs == 1 else math.nan,
        _share(column(table, "goal_1_step")[started].sum(), stable[0][started].sum()),
    )


def _share(part: float, whole: float) -> float:
    return float(part / whole) if whole > 0 else math.nan


def rows_of(outcomes: list[tuple[str, str, Findings]]) -> list[list[str]]:
    """Return the rows of the table, the head first.

    Args:
        outcomes: scenario, policy and what came of it, for each row.
    """
    # obstacles have their event, which comes last, where a scenario has some
    told = max((len(found.harmed) for _, _, found in outcomes), default=0)
    head = ["scenario", "policy", "HAVs", *(event.state for event in HARM[:told])]
    head += ["goal 1", "goal 2", "time / shortest", "apart: worlds, goals hit"]
    return [head, *(_row_of(*outcome, told) for outcome in outcomes)]


def _row_of(scenario: str, policy: str, found: Findings, told: int) -> list[str]:
    """Return a row of the table, which tells of so many events."""
    time = found.stable if math.isnan(found.steep) else found.steep
    hits = ", ".join(map(str, found.hits_apart))
    harmed = [share.show(percent=True) for share in found.harmed]
    return [
        scenario,
        policy,
        str(found.size),
        *(harmed + ["-"] * (told - len(harmed))),
        *(share.show(percent=True) for share in found.hits),
        f"{time:.3f}",
        f"{found.apart}: {hits}" if found.apart else "0",
    ]


if __name__ == "__main__":
    sys.exit(main())
