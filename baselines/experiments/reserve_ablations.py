"""This module runs ablations of Reserve: ``hav-env ablate``.

It runs the same episodes with all HAVs deciding at once, without broadcast, with less range, and
with noise on the poses of others. An interrupted run continues where it stopped.
"""

import pathlib
from typing import NamedTuple

from baselines.cli.run_options import RESUMED
from baselines.experiments.survey import Entry, Run, Sample, print_findings, run_all
from baselines.policies.reserve import Reserve
from hav_env import Task, find_scenario
from hav_env.cli.errors import report_errors
from hav_env.cli.options import parse_options

ENTRIES = (Entry("paper-pair", 1_000), Entry("swarm-10", 100), Entry("dense-10", 100))


class Variant(NamedTuple):
    """A variant of Reserve: the changes to its parameters and rules."""

    name: str
    policy: Reserve = Reserve()
    task: Task = Task()
    in_turns: bool = False
    """Whether the number of turns equals the number of HAVs."""


VARIANTS = (
    Variant("as it is"),
    # only one HAV reserves in a step, so the order does not matter
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


_ABOUT_VARIANTS = (
    "Run Reserve without order, broadcast or range, and with noise on the poses of others."
)


def main(words: list[str]) -> int:
    """Run Reserve without order, broadcast or range, and with noise."""
    return report_errors(_print_variants, words, RESUMED)


def _print_variants(words: list[str]) -> None:
    default = Sample(output=pathlib.Path("results/variants"))
    sample = parse_options(Sample, "hav-env ablate", _ABOUT_VARIANTS, words, default)
    print_findings(run_variants(sample), sample)


def run_variants(sample: Sample) -> list[list[str]]:
    """Run what is missing; write the table in Markdown, and return its rows.

    Raises:
        ValueError, OSError: If options are wrong, or the folder holds other results or cannot be
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
