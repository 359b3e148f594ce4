"""Policies beside AVOID-JACK on the paper's episodes: ``python -m train.compare``.

For single HAVs and for pairs: a table of every figure with its 95 % interval and its paired
difference from the first policy, the same as Parquet, bars, learning curves, and one episode as
every policy drives it. An interrupted comparison goes on where it stopped.
"""

import dataclasses
import pathlib
import re
import sys
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from baselines.evaluate import compare, markdown, read_columns, score, tabulate_scores
from baselines.files import whole_file, write_text
from baselines.policy_files import load_trained
from baselines.progress import Progress
from baselines.registry import find_policy, policy_file
from baselines.reproduce import PAPER_EXPERIMENTS
from baselines.results import Experiments, check_at_least_one, run_experiments
from baselines.trajectories import record_trajectory
from hav_env import find_scenario
from hav_env.command_line import run_command

SCRIPTED = ("avoid_jack", "dubins_pursuit", "random")


@dataclasses.dataclass(frozen=True)
class Options:
    """What to compare."""

    single: tuple[str, ...] = (*SCRIPTED, "ppo_single")
    """Policies for single HAVs: names, files, or module:Class. The first is compared with."""
    pair: tuple[str, ...] = (*SCRIPTED, "ppo_pair")
    """Policies for pairs."""
    episodes: int = PAPER_EXPERIMENTS
    """Of each scenario and policy: 0, 1, ... of the seed."""
    seed: int = 0
    """Of the episodes."""
    shown: int = 2
    """Number of the episode that is drawn."""
    output: pathlib.Path = pathlib.Path("results/compare")
    """Folder of the results."""
    threads: int | None = None
    """How many; by default HAV_THREADS or all cores."""
    overwrite: bool = False
    """Discard what an earlier run left in the folder."""


def main(words: list[str] | None = None) -> int:
    """Compare; return the exit code. What is wrong is said in one line."""
    usage, about = "python -m train.compare", "Compare policies on the paper's episodes."
    return run_command(usage, about, Options(), compare_all, words)


def compare_all(options: Options) -> str:
    """Run what has not been run, write tables and drawings; return the report, in Markdown.

    Raises:
        ValueError, TypeError, OSError, ImportError: when options are wrong, the folder holds other
            results or cannot be written, or what draws is not installed.
    """
    check_at_least_one("episodes", options.episodes)
    groups = {"paper-single": options.single, "paper-pair": options.pair}
    policies = {
        scenario: {name: find_policy(name)() for name in names}
        for scenario, names in groups.items()
        if names
    }
    parts = [f"# Policies compared\n\n{options.episodes} episodes of seed {options.seed} each.\n"]
    with Progress(options.episodes * sum(map(len, policies.values()))) as progress:
        for scenario, named in policies.items():
            tables = [
                _run(options, scenario, name, policy, progress) for name, policy in named.items()
            ]
            parts += _report(options, scenario, named, tables)
    report = "\n".join(parts)
    write_text(report, options.output / "report.md")
    return report


def _run(options: Options, scenario: str, name: str, policy: Any, progress: Progress) -> pa.Table:
    job = Experiments(policy, find_scenario(scenario), options.episodes, options.seed)
    label = f"{scenario}-{re.sub(r'[^0-9A-Za-z]+', '-', name)}"
    path = run_experiments(
        job, options.output, label, options.threads, options.overwrite, progress.advance
    )
    return read_columns(path)


def _report(
    options: Options, scenario: str, policies: dict[str, Any], tables: list[pa.Table]
) -> list[str]:
    """Write the table and the drawings of a scenario; return what to say of it."""
    # matplotlib is an extra, and what is missing is to be said before hours of work
    from baselines.drawings import save_figure  # noqa: PLC0415
    from train.comparison import draw_bars, draw_curves, draw_side_by_side  # noqa: PLC0415

    names, folder = list(policies), options.output
    scores = score(names, tables)
    with whole_file(folder / f"{scenario}-figures.parquet") as unfinished:
        pq.write_table(tabulate_scores(scores), unfinished)
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
