"""This module is the command line ``python -m baselines reproduce | evaluate | calibrate | watch``.

The parameters of the policy and of the scenario in a command line become its options. So the module
reads these two names first, and tyro reads the rest. A command imports its own modules alone.
"""

import contextlib
import pathlib
import sys
import tempfile
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from baselines.cli.markup import file_names, markdown
from baselines.cli.options import asks_for_help, read_options, take_option, take_words
from baselines.cli.progress import Progress
from baselines.cli.run_options import (
    Display,
    Evaluate,
    Run,
    Watch,
    model_fields,
    policy_fields,
    vehicle_field,
)
from baselines.evaluation.executors import open_engine
from baselines.evaluation.runs import Experiments, check_experiments, run_experiments
from baselines.storage.atomic_files import write_text
from baselines.storage.locks import sole_user
from hav_env import Explicit, RandomFleet, Task, find_scenario
from hav_env.cli.errors import report_errors
from hav_env.evaluation.comparison import compare, read_columns
from hav_env.models.text import visible
from hav_env.policies.names import POLICIES
from hav_env.vehicles import VEHICLES

_MENU = {
    "reproduce": "the paper's 9,000 experiments beside its figures: table, report, plots",
    "evaluate": "policies on a scenario: one table, differences on the same episodes",
    "calibrate": "readings of the paper, and each choice that it leaves open, beside its figures",
    "watch": "one episode in a window, as a film (mp4, gif) or as a page to replay (html)",
}
# what is read before tyro sees the rest
_NAMES = {
    "reproduce": "[--reading NAME] [--policy NAME] [--vehicle NAME]",
    "evaluate": "POLICY ... [--scenario NAME|FILE.json] [--vehicle NAME]",
    "calibrate": "[--search]",
    "watch": "POLICY|RUN.npz [--scenario NAME|FILE.json] [--vehicle NAME]",
}


def main(arguments: list[str] | None = None) -> int:
    """Run a command, report an error in one line, and return the exit code."""
    arguments = sys.argv[1:] if arguments is None else arguments
    resumed = "the same command goes on where this one stopped"
    hint = "nothing is half written" if arguments[:1] == ["watch"] else resumed
    return report_errors(_dispatch, arguments, hint)


def _dispatch(arguments: list[str]) -> None:
    if not arguments or arguments[0] in ("-h", "--help"):
        print("usage: python -m baselines COMMAND [--help]\n")
        for name, meaning in _MENU.items():
            print(f"  {name:10} {meaning}")
        return
    command, rest = arguments[0], arguments[1:]
    if command == "reproduce":
        _reproduce(rest)
    elif command == "evaluate":
        _evaluate(rest)
    elif command == "calibrate":
        _calibrate(rest)
    elif command == "watch":
        _watch(rest)
    else:
        raise ValueError(f"unknown command {command!r}; known: {', '.join(_MENU)}")


def _reproduce(arguments: list[str]) -> None:
    from baselines.experiments.published import PAPER_EXPERIMENTS  # noqa: PLC0415
    from baselines.experiments.readings import READINGS, TEXT, find_reading  # noqa: PLC0415
    from baselines.experiments.reproduce import reproduce  # noqa: PLC0415

    chosen, arguments = take_option(arguments, "--reading", TEXT.name)
    reading = find_reading(chosen)
    name, arguments = take_option(arguments, "--policy", "avoid_jack")
    vehicle, arguments = take_option(arguments, "--vehicle", "")
    made = POLICIES.make(name)
    policy = reading.policy if type(made) is type(reading.policy) else made
    shown = [("policy", type(policy), policy)] if policy_fields([POLICIES.find(name)]) else []
    options = _parse(
        "reproduce",
        arguments,
        [
            ("experiments", int, PAPER_EXPERIMENTS, "Experiments of each scenario."),
            *shown,
            ("fleet", RandomFleet, reading.fleet),
            ("task", Task, reading.task),
            vehicle_field(VEHICLES.make(vehicle) if vehicle else reading.vehicle),
        ],
        Run(pathlib.Path(f"results/reproduce{'' if reading == TEXT else f'-{chosen}'}")),
        f" Readings: {', '.join(READINGS)}.",
    )
    _check_folder(options)
    run = reading._replace(
        policy=getattr(options, "policy", policy),
        fleet=options.fleet,
        task=options.task,
        vehicle=options.vehicle,
    )
    same = isinstance(run.policy, type(reading.policy)) and run.policy == reading.policy
    if not same or run._replace(policy=None) != reading._replace(policy=None):
        told = f"parameters differ from {chosen}; they are listed below"
        run = run._replace(name=f"{chosen} with changes", told=told)
    rows = reproduce(
        run,
        options.experiments,
        options.seed,
        options.output,
        options.threads,
        options.overwrite,
    )
    _show(rows, f"{name} beside the paper, reading {run.name}")
    print(f"report, tables and figures: {visible(str(options.output))}/report.md")


def _evaluate(arguments: list[str]) -> None:
    names, arguments = take_words(arguments)
    if not names and not asks_for_help(arguments):
        raise ValueError(f"name the policies to evaluate: {POLICIES.known()}")
    scenario_name, arguments = take_option(arguments, "--scenario", "paper-single")
    vehicle, arguments = _take_vehicle(arguments)
    scenario = find_scenario(scenario_name)
    makers = [POLICIES.find(name) for name in names]
    drawn = not isinstance(scenario, Explicit)  # otherwise all episodes of a policy are the same
    fields: list[tuple] = [
        ("episodes", int, 1_000 if drawn else 1, "Episodes 0 .. of the seed."),
        *model_fields(makers, scenario, vehicle),
    ]
    options = _parse("evaluate", arguments, fields, Evaluate())
    scenario = getattr(options, "scenario", scenario)
    policies = [getattr(options, "policy", None) or POLICIES.make(make) for make in makers]
    shared = scenario, options.episodes, options.seed, options.task, options.vehicle
    jobs = [Experiments(policy, *shared) for policy in policies]
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
        rows = compare(list(names), [read_columns(path) for path in paths])
        write_text(markdown(rows), output / "table.md")
    _show(rows, f"{options.episodes} episodes of {scenario_name}, seed {options.seed}")
    if kept:
        print(f"tables: {visible(', '.join(map(str, paths)))}")


def _calibrate(arguments: list[str]) -> None:
    from baselines.experiments.calibrate import calibrate  # noqa: PLC0415

    if "--search" in arguments:
        _search([word for word in arguments if word != "--search"])
        return
    options = _parse(
        "calibrate",
        arguments,
        [("experiments", int, 1_000, "Experiments of each scenario and row.")],
        Run(pathlib.Path("results/calibrate")),
        _ON_SEARCH,
    )
    _check_folder(options)
    rows = calibrate(
        options.experiments, options.seed, options.output, options.threads, options.overwrite
    )
    _show(rows, f"{options.experiments} experiments of each scenario and row")
    print(f"table: {visible(str(options.output))}/calibration.parquet")


def _search(arguments: list[str]) -> None:
    from baselines.experiments.search import FITTING_SEED, search  # noqa: PLC0415
    from baselines.experiments.search_report import (  # noqa: PLC0415
        compare_words,
        names_of,
        show_found,
    )

    options = _parse(
        "calibrate", arguments, [], Run(pathlib.Path("results/search"), FITTING_SEED), _ON_SEARCH
    )
    _check_folder(options)
    found = search(options.seed, options.output, options.threads, options.overwrite)
    _show(show_found(found), f"{len({one.reading.name for one in found}):,} readings tried")
    for number, name in enumerate(names_of(found), 1):
        print(f"{number}: {name}")
    _show(compare_words(found, options.threads), "the paper's words, in pairs")
    print(f"table: {visible(str(options.output))}/search.parquet")


def _watch(arguments: list[str]) -> None:
    from baselines.replay import watch  # noqa: PLC0415
    from baselines.replay.trajectory import record_trajectory  # noqa: PLC0415
    from baselines.replay.trajectory_files import load_trajectory, save_trajectory  # noqa: PLC0415

    words, arguments = take_words(arguments)
    if len(words) != 1 and not asks_for_help(arguments):
        raise ValueError(f"name what to watch: {POLICIES.known()} or a RUN.npz")
    if words and words[0].endswith(".npz"):
        options = _parse("watch", arguments, [], Display())
        watch.check_pace(options.speed, options.fps)
        trajectory = load_trajectory(words[0])
        watch.check_display(options.output)
        watch.show(trajectory, options.output, options.speed, options.fps)
        return
    scenario_name, arguments = take_option(arguments, "--scenario", "paper-single")
    vehicle, arguments = _take_vehicle(arguments)
    named = find_scenario(scenario_name)
    makers = [POLICIES.find(name) for name in words]
    options = _parse("watch", arguments, model_fields(makers, named, vehicle), Watch())
    usual = POLICIES.make(makers[0])
    policy = getattr(options, "policy", usual)
    scenario = getattr(options, "scenario", named)
    shown = options.output is not None or options.record is None
    watch.check_pace(options.speed, options.fps)
    job = Experiments(policy, scenario, 1, options.seed, options.task, options.vehicle)
    watch.check_episode(job, options.episode, options.every)
    if options.record is not None:
        watch.check_output(options.record, (".npz",))
    if shown:
        watch.check_display(options.output)
    trajectory = record_trajectory(
        policy,
        scenario,
        options.seed,
        options.episode,
        options.task,
        options.vehicle,
        options.every,
    )._replace(
        policy=watch.name_with_changes(words[0], policy, usual),
        scenario=watch.name_with_changes(scenario_name, scenario, named),
    )
    if options.record is not None:
        save_trajectory(trajectory, options.record)
    if shown:
        watch.show(trajectory, options.output, options.speed, options.fps)


def _take_vehicle(arguments: list[str]) -> tuple[Any, list[str]]:
    """Return the vehicle that a command line names, and the other arguments."""
    name, arguments = take_option(arguments, "--vehicle", "on_axle")
    return VEHICLES.make(name), arguments


def _check_folder(options: Any) -> None:
    """Raise ValueError when a command that keeps its results has no folder."""
    if options.output is None:
        raise ValueError("output is None, but must be a folder")


_ON_SEARCH = (
    " With --search: a search for readings near the figures, about half an hour; --seed fits them,"
    " and the next three seeds confirm."
)


def _parse(
    command: str, arguments: list[str], fields: list[tuple], common: Any, more: str = ""
) -> Any:
    usage = f"python -m baselines {command} {_NAMES[command]}".rstrip()
    return read_options(usage, f"{_MENU[command]}.{more}", arguments, fields, common)


def _show(rows: list[list[str]], title: str) -> None:
    # without a terminal rich would cut every row into slices of 80 columns
    console = Console(width=None if sys.stdout.isatty() else 160)
    # as Text, for brackets in a str are rich's markup
    shown = [[Text(visible(cell)) for cell in row] for row in rows]
    table = Table(title=Text(visible(title)), title_justify="left")
    for k, head in enumerate(shown[0]):
        table.add_column(head, justify="left" if k == 0 else "right")
    for row in shown[1:]:
        table.add_row(*row)
    console.print(table)


if __name__ == "__main__":
    sys.exit(main())
