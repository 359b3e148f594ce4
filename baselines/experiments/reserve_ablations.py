"""This module runs ablations of Reserve: ``python -m baselines.experiments.reserve_ablations``.

The same episodes run again with all HAVs deciding at once, without broadcast, with less range, and
with noise on the poses of others. An interrupted run goes on where it stopped.
"""

import pathlib
import sys
from typing import NamedTuple

from baselines.experiments.survey import Entry, Run, Sample, run_all
from baselines.policies.reserve import Reserve
from hav_env import Task, find_scenario
from hav_env.cli.options import run_command

ENTRIES = (Entry("paper-pair", 1_000), Entry("swarm-10", 100), Entry("dense-10", 100))


class Variant(NamedTuple):
    """A variant of Reserve: the changes to its parameters and rules."""

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


def main(words: list[str] | None = None) -> int:
    """Run the variants, report an error in one line, and return the exit code."""
    usage, about = (
        "python -m baselines.experiments.reserve_ablations",
        "Reserve with less to go by.",
    )
    default = Sample(output=pathlib.Path("results/variants"))
    return run_command(usage, about, default, run_variants, words)


def run_variants(sample: Sample) -> str:
    """Run what has not been run; return the table in Markdown, which is written too.

    Raises:
        ValueError, OSError: when options are wrong, or the folder holds other results or cannot be
            written.
    """
    runs = []
    for entry in ENTRIES:
        for number, variant in enumerate(VARIANTS):
            policy = variant.policy
            if variant.in_turns:
                policy = policy._replace(turns=find_scenario(entry.scenario).num_havs)
            label = f"{entry.scenario}-{number}"
            runs.append(Run(entry, variant.name, policy, variant.task, label))
    return run_all(runs, sample)


if __name__ == "__main__":
    sys.exit(main())
