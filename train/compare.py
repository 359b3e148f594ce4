"""This module compares policies with AVOID-JACK, as in the paper: ``hav-env compare``.

For single HAVs and for pairs it writes a table of all figures in Markdown and Parquet. It also
plots bars, learning curves, and one episode under every policy. Each figure has its 95 % interval
and its paired difference from the first policy. A second table and performance profiles are over
training seeds and worlds: ``--runs`` adds the runs of several seeds to them. An interrupted
comparison resumes where it stopped.
"""

import dataclasses
import pathlib
import re
import sys
from typing import Any, NamedTuple

import pyarrow.parquet as pq

from baselines.cli.bounds import check_whole
from baselines.cli.drawing import can_draw
from baselines.cli.markup import file_names, markdown
from baselines.cli.progress import Progress
from baselines.cli.tables import TERMINAL_WIDTH, plain_table
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
from hav_env.evaluation.comparison import (
    compare,
    explain_comparison,
    read_columns,
    score,
    tabulate_scores,
)
from hav_env.evaluation.figures import FOLDED_THROUGH
from hav_env.maths.random_numbers import SEED_LIMIT
from hav_env.models.text import visible
from hav_env.policies.names import POLICIES, make_policy
from train.run_groups import find_group
from train.seed_scores import group_rows, score_group, tabulate_groups

Rows = list[list[str]]
"""A table, the head first."""
SCRIPTED = ("avoid_jack", "dubins_pursuit", "random")


class Group(NamedTuple):
    """The policies of a row of the comparison: one policy, or one for each training seed."""

    name: str
    scenario: str
    policies: tuple[Any, ...]
    labels: tuple[str, ...]
    """Names of the tables; ``file_names`` makes names of files from them."""
    curves: list[list[dict[str, Any]]]
    """The learning curve of each seed that has one."""
    of_runs: bool


@dataclasses.dataclass(frozen=True)
class Options:
    """The options of a comparison."""

    single: tuple[str, ...] = (*SCRIPTED, "ppo_single")
    """Policies for single HAVs: names, files, or module:Class. The first one is the reference."""
    pair: tuple[str, ...] = (*SCRIPTED, "ppo_pair")
    """Policies for pairs: names, files, or module:Class. The first one is the reference."""
    runs: tuple[str, ...] = ()
    """Groups of runs: patterns of their folders. The runs of a group differ in their seeds only.
    Their best policies drive the scenario of their training, and are one row."""
    episodes: int = PAPER_EXPERIMENTS
    """Number of episodes of each scenario and policy: 0, 1, ... of the seed."""
    seed: int = 0
    """Seed of the episodes."""
    shown: int = 2
    """Number of the episode to draw."""
    output: pathlib.Path = pathlib.Path("results/compare")
    """Folder of the results."""
    threads: int | None = None
    """Number of threads; by default HAV_THREADS or all cores."""
    overwrite: bool = False
    """Discard what an earlier run left in the folder."""


def main(words: list[str] | None = None) -> int:
    """Compare trained and scripted policies on the paper's episodes."""
    usage, about = "hav-env compare", "Compare policies on the paper's episodes."
    names = {"policies": f"{POLICIES.known()}.", "hav-env list": "Shows what each name stands for."}
    return run_command(usage, about, Options(), compare_all, words, names=names)


def compare_all(options: Options) -> str:
    """Run the missing experiments, write tables, figures and a report; return the report as text.

    Raises:
        ValueError, TypeError, OSError, ImportError: If options are invalid, the folder holds other
            results or is not writable, or the drawing library is missing.
    """
    check_whole("shown", options.shown, 0, SEED_LIMIT - 1)
    groups = _groups_of(options)
    jobs = [
        Experiments(policy, find_scenario(group.scenario), options.episodes, options.seed)
        for group in groups
        for policy in group.policies
    ]
    labels = file_names([name for group in groups for name in group.labels], "[^0-9A-Za-z]+")
    for job in jobs:
        check_experiments(job, options.threads)
    draws = can_draw()
    parts: list[str | Rows] = [
        f"# Policies compared\n\n{options.episodes:,} episodes of seed {options.seed} each.\n"
    ]
    with sole_user(options.output):
        with Progress(options.episodes * len(jobs)) as progress:
            how = options.threads, options.overwrite, progress.advance
            written = iter([
                run_experiments(job, options.output, label, *how)
                for job, label in zip(jobs, labels, strict=True)
            ])  # fmt: skip
        paths = [[next(written) for _ in group.policies] for group in groups]
        for scenario in dict.fromkeys(group.scenario for group in groups):
            chosen = [k for k, group in enumerate(groups) if group.scenario == scenario]
            of_one, theirs = [groups[k] for k in chosen], [paths[k] for k in chosen]
            parts += _report(options, of_one, theirs, jobs[0].task.max_steps, draws)
        path = options.output / "report.md"
        write_text("\n".join(markdown(p) if isinstance(p, list) else p for p in parts), path)
    shown = [plain_table(p, TERMINAL_WIDTH) + "\n" if isinstance(p, list) else p for p in parts]
    # a terminal shows no headings and no pictures
    text = re.sub(r"^#+ |^!.*\n", "", "\n".join(shown), flags=re.MULTILINE)
    return f"{text.rstrip()}\n\nreport, tables and figures: {visible(str(path))}"


def _groups_of(options: Options) -> list[Group]:
    """Return a group for each policy, and one for each scenario of a group of runs."""
    groups = []
    for scenario, names in (("paper-single", options.single), ("paper-pair", options.pair)):
        for name in dict.fromkeys(names):
            curves = [_curve(name)] if _curve(name) else []
            label = f"{scenario}-{name}"
            groups.append(Group(name, scenario, (make_policy(name),), (label,), curves, False))
    for pattern in dict.fromkeys(options.runs):
        for scenario, runs in find_group(pattern).items():
            policies = tuple(run.policy for run in runs)
            labels = tuple(f"{scenario}-{run.folder}" for run in runs)
            curves = [run.curve for run in runs if run.curve]
            groups.append(Group(pattern, scenario, policies, labels, curves, True))
    return groups


def _report(
    options: Options, groups: list[Group], paths: list[list[pathlib.Path]], cap: int, draws: bool
) -> list[str | Rows]:
    """Write the tables of a scenario, and plot them if possible.

    Returns:
        The parts of the report: text in Markdown, or the rows of a table.
    """
    scenario, folder = find_scenario(groups[0].scenario), options.output
    (label,) = file_names([groups[0].scenario], "[^0-9A-Za-z]+")
    scores: list[Any] = []
    told: list[str | Rows] = [f"## {groups[0].scenario}\n"]
    single = [k for k, group in enumerate(groups) if not group.of_runs]
    if single:
        names = [groups[k].name for k in single]
        tables = [read_columns(paths[k][0]) for k in single]
        scores = score(names, tables)
        write_table(tabulate_scores(scores), folder / f"{label}-figures.parquet")
        told += [compare(names, tables), explain_comparison(names, scenario.num_havs > 1) + "\n"]
    of_groups = [
        score_group(group.name, list(map(pq.read_table, of_one)), scenario.fleet, cap)
        for group, of_one in zip(groups, paths, strict=True)
    ]
    write_table(tabulate_groups(of_groups), folder / f"{label}-seeds.parquet")
    told += ["Over training seeds and worlds:\n", group_rows(of_groups)]
    drawn = _draw(options, groups, of_groups, scores, label) if draws else []
    pictures = [f"![{file}]({file})" for file in drawn if file.endswith(".png")]
    return [*told, "\n".join(pictures), ""]


def _draw(
    options: Options, groups: list[Group], of_groups: list[Any], scores: list[Any], label: str
) -> list[str]:
    """Draw the figures of a scenario; return the names of the files."""
    # matplotlib is an extra; tables do not need it
    from baselines.figures.trajectory_plot import save_figure  # noqa: PLC0415
    from train import comparison_plots as plots  # noqa: PLC0415

    scenario, drawn = find_scenario(groups[0].scenario), []
    figures = {"bars": plots.draw_bars(scores, label)} if scores else {}
    figures["profiles"] = plots.draw_profiles(of_groups, label)
    curves = {group.name: group.curves for group in groups if group.curves}
    if curves:
        first = of_groups[0]
        shares = {name: first.measured[name].value for name in first.percent}
        shares.pop(FOLDED_THROUGH.name, None)
        figures["curves"] = plots.draw_curves(curves, first.name, shares)
    trajectories = [
        record_trajectory(group.policies[0], scenario, options.seed, options.shown)
        for group in groups
    ]
    figures["episode"] = plots.draw_side_by_side(trajectories, [group.name for group in groups])
    for name, figure in figures.items():
        drawn += save_figure(figure, options.output, f"{label}-{name}")
    return drawn


def _curve(name: str) -> list[dict[str, Any]]:
    """Return the learning curve in a policy's file; it is empty for a policy without a file."""
    path = policy_file(name)
    return load_trained(path).about.get("curve", []) if path else []


if __name__ == "__main__":
    sys.exit(main())
