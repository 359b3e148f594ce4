"""Reserve with less to go by: ``python -m baselines.variants``.

The same episodes again, with all HAVs deciding at once, without broadcast, with less range, and
with noise on the poses of others. An interrupted run goes on where it stopped.
"""

import dataclasses
import pathlib
import sys
from typing import NamedTuple

import pyarrow.parquet as pq

from baselines.evaluate import markdown
from baselines.files import write_text
from baselines.progress import Progress
from baselines.reserve import Reserve
from baselines.results import Experiments, run_experiments
from baselines.survey import HEAD, Entry, check_share, look_at, row_of
from hav_env import Task, find_scenario
from hav_env.command_line import run_command

ENTRIES = (Entry("paper-pair", 1_000), Entry("swarm-10", 100), Entry("dense-10", 100))


class Variant(NamedTuple):
    """What is different."""

    name: str
    policy: Reserve = Reserve()
    task: Task = Task()
    in_turns: bool = False
    """Whether there are as many turns as HAVs."""


VARIANTS = (
    Variant("as it is"),
    # nobody reserves in the step in which another one does, so it does not matter who is first
    Variant("all at once, reserving in turns", in_turns=True),
    Variant("without broadcast", Reserve(broadcast=False)),
    *(Variant(f"range {r:g} m", task=Task(sensing_range=r)) for r in (20.0, 10.0, 5.0)),
    *(
        Variant(
            f"noise {noise:g} m, {noise / 10:g} rad",
            Reserve(position_noise=noise, heading_noise=noise / 10),
        )
        for noise in (0.1, 0.3, 1.0)
    ),
)


@dataclasses.dataclass(frozen=True)
class Options:
    """What to run."""

    share: float = 1.0
    """Of the episodes, to see something soon; at least one is run."""
    seed: int = 2026
    """Of the episodes."""
    output: pathlib.Path = pathlib.Path("results/variants")
    """Folder of the results."""
    threads: int | None = None
    """How many; by default HAV_THREADS or all cores."""
    overwrite: bool = False
    """Discard what an earlier run left in the folder."""


def main(words: list[str] | None = None) -> int:
    """Run the variants; return the exit code. What is wrong is said in one line."""
    usage, about = "python -m baselines.variants", "Reserve with less to go by."
    return run_command(usage, about, Options(), run_variants, words)


def run_variants(options: Options) -> str:
    """Run what has not been run; return the table in Markdown, which is written too.

    Raises:
        ValueError, OSError: when options are wrong, or the folder holds other results or cannot be
            written.
    """
    check_share(options.share)
    rows = [list(HEAD)]
    counts = [max(1, round(options.share * entry.episodes)) for entry in ENTRIES]
    with Progress(len(VARIANTS) * sum(counts)) as progress:
        for entry, count in zip(ENTRIES, counts, strict=True):
            scenario = find_scenario(entry.scenario)
            for number, variant in enumerate(VARIANTS):
                policy = variant.policy
                if variant.in_turns:
                    policy = policy._replace(turns=scenario.num_havs)
                job = Experiments(policy, scenario, count, options.seed, variant.task)
                path = run_experiments(
                    job,
                    options.output,
                    f"{entry.scenario}-{number}",
                    options.threads,
                    options.overwrite,
                    progress.advance,
                )
                found = look_at(pq.read_table(path), scenario.fleet)
                rows.append(row_of(entry.scenario, variant.name, found))
    report = markdown(rows)
    write_text(report, options.output / "report.md")
    return report


if __name__ == "__main__":
    sys.exit(main())
