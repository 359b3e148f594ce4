"""This module surveys all policies, one HAV to swarms: ``hav-env survey``.

Every policy gets the same episodes, none of which was used to make a policy of this project. The
survey counts separately the worlds that start with touching chains, and those with goals whose
trucks would cross. No policy can solve these. An interrupted survey continues where it stopped.
"""

import dataclasses
import pathlib
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from baselines.cli.markup import file_names, markdown
from baselines.cli.progress import Progress
from baselines.cli.run_options import RESUMED, Backup, backup_of, guidance_for
from baselines.cli.tables import Format, print_table
from baselines.evaluation.arrival_times import world_times
from baselines.evaluation.feasibility import column, goals_crossing, starts_touching
from baselines.evaluation.runs import Experiments, check_experiments, run_experiments
from baselines.storage.atomic_files import write_text
from baselines.storage.locks import sole_user
from hav_env import OnAxle, Task, find_scenario
from hav_env.cli.errors import report_errors
from hav_env.cli.options import parse_options
from hav_env.evaluation.figures import goals_of
from hav_env.evaluation.statistics import Interval, proportion, ratio
from hav_env.models.text import suggest, visible
from hav_env.policies.filtered import filter_policy
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
        "paper-single",
        4_500,
        policies=("avoid_jack", "dubins_pursuit", "ppo_single", "ppo_guided", "reserve"),
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
    """Share of the episodes to run, and the folder of the results."""

    share: float = 1.0
    """Share of the episodes, for a quick result; at least one is run."""
    seed: int = 2026
    """Seed of the episodes."""
    output: pathlib.Path = pathlib.Path("results/survey")
    """Folder of the results."""
    threads: int | None = None
    """Number of threads; by default HAV_THREADS or all cores."""
    overwrite: bool = False
    """Whether to discard the results of an earlier run in the folder."""
    format: Format = "text"
    """Form of the printed table: text, Markdown or comma-separated values."""


@dataclasses.dataclass(frozen=True)
class Options(Sample):
    """Options of a survey."""

    scenarios: tuple[str, ...] = tuple(entry.scenario for entry in SURVEY)
    """Names of the survey's scenarios."""
    policies: tuple[str, ...] = ()
    """Names, files, or module:Class; by default those that the survey has for each scenario."""
    backup: Backup = None
    """Policy that drives wherever a command of the policies would leave it no safe way on."""


class Run(NamedTuple):
    """One row of a table: a policy, an entry, and the name of the stored table."""

    entry: Entry
    name: str
    policy: Any
    task: Task
    label: str


class Findings(NamedTuple):
    """Outcome of a policy in a scenario."""

    harmed: tuple[Interval, ...]
    """Share of HAVs to which each event of ``HARM`` happened, for possible events only."""
    hits: tuple[Interval, ...]
    """Share of HAVs that hit each goal."""
    size: int
    """Number of HAVs in solvable worlds."""
    apart: int
    """Number of worlds that are counted separately ..."""
    hits_apart: tuple[int, ...]
    """... and the goals that were hit there, of ``apart`` worlds of ``num_havs``."""
    time: Interval
    """Ratio of time to shortest time (``world_times``), with worlds as units and absent arrivals at
    the cap.
    """


_ABOUT_SURVEY = "Run all policies, from one HAV to swarms of 200. hav-env list policies names them."


def main(words: list[str]) -> int:
    """Run all policies, from one HAV to swarms of 200."""
    return report_errors(_print_survey, words, RESUMED)


def _print_survey(words: list[str]) -> None:
    options = parse_options(Options, "hav-env survey", _ABOUT_SURVEY, words, Options())
    print_findings(survey(options), options)


def print_findings(rows: list[list[str]], sample: Sample) -> None:
    """Print a table of findings, and where it stands."""
    print_table(
        rows, f"Seed {sample.seed}, {sample.share:.4g} of the episodes", sample.format, keys=2
    )
    if sample.format == "text":
        print(f"\ntable: {visible(str(sample.output))}/report.md")


def survey(options: Options) -> list[list[str]]:
    """Run what is missing; write the table in Markdown, and return its rows.

    Raises:
        ValueError, TypeError, OSError: If options are wrong, or the folder holds other results or
            cannot be written.
    """
    entries = {entry.scenario: entry for entry in SURVEY}
    for name in options.scenarios:
        if name not in entries:
            near = suggest(name, entries)
            raise ValueError(f"scenarios has {name!r}{near}, which is none of {', '.join(entries)}")
    if options.backup and not options.policies:
        raise ValueError("--backup needs --policies: a policy that broadcasts can have no backup")
    behind = f"+{options.backup}" if options.backup else ""
    chosen = [
        (entries[name], f"{policy}{behind}", make_policy(policy))
        for name in options.scenarios
        for policy in options.policies or entries[name].policies
    ]
    labels = file_names([f"{entry.scenario}-{name}" for entry, name, _ in chosen])
    runs = []
    for (entry, name, policy), label in zip(chosen, labels, strict=True):
        task = Task(max_steps=entry.max_steps)
        driver = filter_policy(policy, None, task, OnAxle(), backup_of(options.backup, task))
        runs.append(Run(entry, name, driver, task, label))
    return run_all(runs, options)


def run_all(runs: list[Run], sample: Sample) -> list[list[str]]:
    """Run what is missing; write the table in Markdown, and return its rows.

    Raises:
        ValueError, TypeError, OSError: See ``survey``.
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
                found = look_at(pq.read_table(path), job.scenario.fleet, job.task.max_steps)
                outcomes.append((run.entry.scenario, run.name, found))
        rows = rows_of(outcomes)
        write_text(markdown(rows), sample.output / "report.md")
    return rows


def _job(run: Run, sample: Sample) -> Experiments:
    scenario, episodes = find_scenario(run.entry.scenario), episodes_of(run.entry, sample)
    settings = run.policy, scenario, episodes, sample.seed, run.task
    return Experiments(*settings, guidance=guidance_for(run.policy, None))


def episodes_of(entry: Entry, sample: Sample) -> int:
    """Return the number of episodes of an entry to run.

    Raises:
        ValueError: If the sample's share is invalid.
    """
    if not 0 < sample.share <= 1:
        raise ValueError(f"share is {sample.share}, but must be above 0 and at most 1")
    return max(1, round(sample.share * entry.episodes))


def look_at(table: pa.Table, fleet, cap: int) -> Findings:
    """Return the outcome of a policy.

    Args:
        table: Table of ``hav_env.evaluation.rollout``, whole episodes.
        fleet: Fleet of the scenario, for the limits of speed and steering.
        cap: Largest number of steps of an episode, which counts for HAVs that never arrive.
    """
    num_havs = int(np.max(table["hav"].to_numpy())) + 1
    goals = goals_of(table.column_names)
    worlds = starts_touching(table, num_havs) | goals_crossing(table, num_havs)
    apart = np.repeat(worlds, num_havs)
    hit = np.stack([column(table, f"goal_{g}_hit") > 0 for g in goals])
    times = world_times(table, fleet, cap)
    episodes = table["episode"].to_numpy()[~apart]
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
        ratio(times.driven[~worlds], times.shortest[~worlds]),
    )


def rows_of(outcomes: list[tuple[str, str, Findings]]) -> list[list[str]]:
    """Return the rows of the table, the head first.

    Args:
        outcomes: Scenario, policy and outcome of each row.
    """
    # the event of obstacles comes last, and only scenarios with obstacles have it
    shown = max((len(found.harmed) for _, _, found in outcomes), default=0)
    head = ["scenario", "policy", "HAVs", *(event.state for event in HARM[:shown])]
    head += ["goal 1", "goal 2", "time / shortest", "apart: worlds, goals hit"]
    return [head, *(_row_of(*outcome, shown) for outcome in outcomes)]


def _row_of(scenario: str, policy: str, found: Findings, shown: int) -> list[str]:
    """Return a row of the table, with a given number of events."""
    hits = ", ".join(map(str, found.hits_apart))
    harmed = [share.show(percent=True) for share in found.harmed]
    return [
        scenario,
        policy,
        str(found.size),
        *(harmed + ["-"] * (shown - len(harmed))),
        *(share.show(percent=True) for share in found.hits),
        f"{found.time.value:.3f} [{found.time.low:.3f}, {found.time.high:.3f}]",
        f"{found.apart}: {hits}" if found.apart else "0",
    ]
