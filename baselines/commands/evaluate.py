"""This module is ``hav-env evaluate``: policies on the same episodes of a scenario.

The parameters of the named policy and scenario become options of the command line. So the module
reads these two names first, and tyro parses the rest.
"""

import contextlib
import pathlib
import tempfile

from baselines.cli.markup import file_names, markdown
from baselines.cli.options import asks_for_help, read_options, take_words
from baselines.cli.progress import Progress
from baselines.cli.run_options import (
    RESUMED,
    Evaluate,
    backup_of,
    guidance_for,
    known_names,
    model_fields,
    options_elsewhere,
    take_guidance,
    take_scenario,
    take_vehicle,
)
from baselines.cli.tables import print_table
from baselines.cli.titles import count_of, parts_of
from baselines.evaluation.executors import open_engine
from baselines.evaluation.runs import Experiments, check_experiments, run_experiments
from baselines.storage.atomic_files import write_text
from baselines.storage.locks import sole_user
from hav_env import OnAxle, Task
from hav_env.cli.errors import report_errors
from hav_env.evaluation.comparison import (
    compare,
    compare_differences,
    explain_comparison,
    read_columns,
    score,
    tabulate_scores,
)
from hav_env.evaluation.evaluate import usual_episodes
from hav_env.models.changes import changes_of, name_with_changes
from hav_env.models.text import visible
from hav_env.policies.filtered import filter_policy
from hav_env.policies.names import POLICIES
from hav_env.world.place.guidance import Dubins

_USAGE = "hav-env evaluate POLICY ... [--scenario NAME] [--vehicle NAME]"
_ABOUT = "Compare policies on the same episodes of a scenario, in one table."


def main(words: list[str]) -> int:
    """Compare policies on the same episodes of a scenario."""
    return report_errors(_evaluate, words, RESUMED)


def _evaluate(arguments: list[str]) -> None:
    names, arguments = take_words(arguments)
    if not names and not asks_for_help(arguments):
        raise ValueError(f"name the policies to evaluate: {POLICIES.known()}")
    scenario_name, scenario, arguments = take_scenario(arguments)
    vehicle, arguments = take_vehicle(arguments)
    guidance, arguments = take_guidance(arguments)
    makers = [POLICIES.find(name) for name in names]
    fields: list[tuple] = [
        ("episodes", int, usual_episodes(scenario), "Number of episodes: 0, 1, ... of the seed."),
        *model_fields(makers, scenario, vehicle, guidance),
    ]
    helpers = known_names(), options_elsewhere
    options = read_options(_USAGE, _ABOUT, arguments, fields, Evaluate(), *helpers)
    usual, scenario = scenario, getattr(options, "scenario", scenario)
    policies = [getattr(options, "policy", None) or POLICIES.make(make) for make in makers]
    guidance = getattr(options, "guidance", guidance)
    rules = options.task, options.vehicle
    shared = scenario, options.episodes, options.seed, *rules
    backup = backup_of(options.backup, options.task)
    drivers = [filter_policy(one, options.safety, *rules, backup) for one in policies]
    jobs = [Experiments(one, *shared, guidance_for(one, guidance)) for one in drivers]
    for job in jobs:
        check_experiments(job, options.threads)
    with contextlib.ExitStack() as stack:
        kept = options.output is not None
        engine = stack.enter_context(open_engine(options.engine, options.address))
        output = options.output or pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory()))
        stack.enter_context(sole_user(output))
        progress = stack.enter_context(Progress(options.episodes * len(policies)))
        how = options.threads, options.overwrite, progress.advance, engine
        paths = [
            run_experiments(job, output, label, *how)
            for job, label in zip(jobs, file_names(names), strict=True)
        ]
        tables = [read_columns(path) for path in paths]
        rows = compare(list(names), tables, options.task.dt)
        write_text(markdown(rows), output / "table.md")
    named = name_with_changes(scenario_name, scenario, usual)
    changes = [
        *(f"task.{change}" for change in changes_of(options.task, Task())),
        *changes_of(options.vehicle, OnAxle(), "vehicle."),
        *changes_of(Dubins() if guidance is None else guidance, Dubins(), "guidance."),
        *([f"safety={options.safety}"] if options.safety else []),
        *([f"backup={options.backup}"] if options.backup else []),
        *(
            part
            for name, policy in zip(names, policies, strict=True)
            for part in parts_of(name, policy, options.safety is not None)
        ),
        *(f"policy.{c}" for one in policies[:1] for c in changes_of(one, POLICIES.make(names[0]))),
    ]
    title = f"{count_of(options.episodes, 'episode')} of {named}, seed {options.seed}"
    title += f"; {', '.join(changes)}" if changes else ""
    if options.format == "csv":
        scores = tabulate_scores(score(list(names), tables)).to_pylist()
        cells = [["" if v is None else str(v) for v in row.values()] for row in scores]
        print_table([list(scores[0]), *cells], title, "csv")
        return
    legend = explain_comparison(list(names), scenario.num_havs > 1)
    print_table(rows, title, options.format, legend)
    if options.differences and len(names) > 1:
        print()
        differences = compare_differences(list(names), tables)
        print_table(differences, "Differences, with 95 % intervals", options.format)
    if kept:
        print(f"\ntables: {visible(', '.join(map(str, paths)))}")
