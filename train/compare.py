"""This module compares policies with AVOID-JACK, as in the paper: ``python -m train.compare``.

For single HAVs and for pairs it writes a table of every figure, the same as Parquet, bars, learning
curves, and one episode under every policy. Each figure has its 95 % interval and its paired
difference from the first policy. An interrupted comparison goes on where it stopped.
"""

import dataclasses
import pathlib
import sys
from typing import Any

import pyarrow as pa

from baselines.cli.bounds import check_whole
from baselines.cli.markup import file_names, markdown
from baselines.cli.progress import Progress
from baselines.evaluation.run_parts import write_table
from baselines.evaluation.runs import Experiments, check_experiments, run_experiments
from baselines.experiments.published import PAPER_EXPERIMENTS
from baselines.policies.files import load_trained
from baselines.policies.shipped import policy_file
from baselines.replay.trajectory import record_trajectory
from baselines.storage.atomic_files import write_text
from baselines.storage.locks import sole_user
from hav_env import find_scenario
from hav_env.cli.options import run_command
from hav_env.evaluation.comparison import compare, read_columns, score, tabulate_scores
from hav_env.maths.random_numbers import SEED_LIMIT
from hav_env.policies.names import make_policy

SCRIPTED = ("avoid_jack", "dubins_pursuit", "random")


@dataclasses.dataclass(frozen=True)
class Options:
    """The options of a comparison."""

    single: tuple[str, ...] = (*SCRIPTED, "ppo_single")
    """Policies for single HAVs: names, files, or module:Class. The first is compared with."""
    pair: tuple[str, ...] = (*SCRIPTED, "ppo_pair")
    """Policies for pairs."""
    episodes: int = PAPER_EXPERIMENTS
    """Episodes of each scenario and policy: 0, 1, ... of the seed."""
    seed: int = 0
    """Seed of the episodes."""
    shown: int = 2
    """Number of the episode that is drawn."""
    output: pathlib.Path = pathlib.Path("results/compare")
    """Folder of the results."""
    threads: int | None = None
    """Number of threads; by default HAV_THREADS or all cores."""
    overwrite: bool = False
    """Discard what an earlier run left in the folder."""


def main(words: list[str] | None = None) -> int:
    """Compare, report an error in one line, and return the exit code."""
    usage, about = "python -m train.compare", "Compare policies on the paper's episodes."
    return run_command(usage, about, Options(), compare_all, words)


def compare_all(options: Options) -> str:
    """Run what has not been run, write tables and drawings; return the report, in Markdown.

    Raises:
        ValueError, TypeError, OSError, ImportError: when options are wrong, the folder holds other
            results or cannot be written, or what draws is not installed.
    """
    check_whole("shown", options.shown, 0, SEED_LIMIT - 1)
    groups = {"paper-single": options.single, "paper-pair": options.pair}
    policies = {
        scenario: {name: make_policy(name) for name in names}
        for scenario, names in groups.items()
        if names
    }
    jobs = {
        scenario: [_job(options, scenario, policy) for policy in named.values()]
        for scenario, named in policies.items()
    }
    for job in (job for of_one in jobs.values() for job in of_one):
        check_experiments(job, options.threads)
    parts = [f"# Policies compared\n\n{options.episodes} episodes of seed {options.seed} each.\n"]
    with sole_user(options.output):
        with Progress(options.episodes * sum(map(len, jobs.values()))) as progress:
            how = options.threads, options.overwrite, progress.advance
            for scenario, named in policies.items():
                labels = file_names([f"{scenario}-{name}" for name in named], "[^0-9A-Za-z]+")
                tables = [
                    read_columns(run_experiments(job, options.output, label, *how))
                    for job, label in zip(jobs[scenario], labels, strict=True)
                ]
                parts += _report(options, scenario, named, tables)
        report = "\n".join(parts)
        write_text(report, options.output / "report.md")
    return report


def _job(options: Options, scenario: str, policy: Any) -> Experiments:
    return Experiments(policy, find_scenario(scenario), options.episodes, options.seed)


def _report(
    options: Options, scenario: str, policies: dict[str, Any], tables: list[pa.Table]
) -> list[str]:
    """Write the table and the drawings of a scenario; return what to say of it."""
    # matplotlib is an extra, and what is missing is to be said before hours of work
    from baselines.figures.trajectory_plot import save_figure  # noqa: PLC0415
    from train.comparison_plots import draw_bars, draw_curves, draw_side_by_side  # noqa: PLC0415

    names, folder = list(policies), options.output
    scores = score(names, tables)
    write_table(tabulate_scores(scores), folder / f"{scenario}-figures.parquet")
    drawn = [*save_figure(draw_bars(scores, scenario), folder, f"{scenario}-bars")]
    curves = {name: _curve(name) for name in names if _curve(name)}
    if curves:
        shares = {row[0].figure.name: row[0].measured.value for row in scores
                  if row[0].figure.percent and row[0].figure.name != "folded through"}  # fmt: skip
        drawn += save_figure(draw_curves(curves, names[0], shares), folder, f"{scenario}-curves")
    trajectories = [
        record_trajectory(policy, find_scenario(scenario), options.seed, options.shown)
        for policy in policies.values()
    ]
    drawn += save_figure(draw_side_by_side(trajectories, names), folder, f"{scenario}-episode")
    pictures = [f"![{file}]({file})" for file in drawn if file.endswith(".png")]
    return [f"## {scenario}\n", markdown(compare(names, tables)), "\n".join(pictures), ""]


def _curve(name: str) -> list[dict[str, Any]]:
    """Return the learning curve in a policy's file, empty for a policy without."""
    path = policy_file(name)
    return load_trained(path).about.get("curve", []) if path else []


if __name__ == "__main__":
    sys.exit(main())
