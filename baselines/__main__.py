"""The command line: ``python -m baselines reproduce | evaluate | calibrate``.

The parameters of the policy and of the scenario that a command line names become its options, so
the names are read first and the rest is left to tyro.
"""

import contextlib
import dataclasses
import pathlib
import re
import sys
import tempfile
from typing import Annotated, Any

import tyro
from rich.console import Console
from rich.table import Table

from baselines.calibrate import calibrate
from baselines.evaluate import compare, markdown, read_columns
from baselines.files import write_text
from baselines.progress import Progress
from baselines.registry import POLICIES, find_policy
from baselines.reproduce import PAPER_EXPERIMENTS, reproduce
from baselines.results import Experiments, run_experiments
from hav_env import Explicit, OnAxle, Task, find_scenario
from hav_env.command_line import parse_options

_COMMANDS = {
    "reproduce": "the paper's 9,000 experiments beside its figures: table, report, plots",
    "evaluate": "policies on a scenario: one table, differences on the same episodes",
    "calibrate": "the effect of every choice that the paper leaves open",
}
# what is read before tyro sees the rest
_NAMES = {
    "reproduce": "[--policy NAME]",
    "evaluate": "POLICY ... [--scenario NAME|FILE.json]",
    "calibrate": "",
}


@dataclasses.dataclass
class _Run:
    """Where the results go and how they are made."""

    output: pathlib.Path | None = None
    """Folder of the results, in which an interrupted run goes on where it stopped. Without one,
    ``evaluate`` keeps nothing."""
    seed: int = 0
    """Of all experiments, from 0 to 2**32 - 1."""
    threads: int | None = None
    """How many; by default HAV_THREADS or all cores. Results do not depend on it."""
    overwrite: bool = False
    """Discard what an earlier run left in the folder."""


def main(arguments: list[str] | None = None) -> int:
    """Run a command; return the exit code. What is wrong is said in one line."""
    arguments = sys.argv[1:] if arguments is None else arguments
    try:
        return _dispatch(arguments)
    except (ValueError, TypeError, OSError, ImportError, MemoryError) as error:
        message = " ".join(str(error).split())
        print(f"error: {message}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted: the same command goes on where this one stopped", file=sys.stderr)
        return 130


def _dispatch(arguments: list[str]) -> int:
    if not arguments or arguments[0] in ("-h", "--help"):
        print("usage: python -m baselines COMMAND [--help]\n")
        for name, meaning in _COMMANDS.items():
            print(f"  {name:10} {meaning}")
        return 0
    command, rest = arguments[0], arguments[1:]
    if command == "reproduce":
        _reproduce(rest)
    elif command == "evaluate":
        _evaluate(rest)
    elif command == "calibrate":
        _calibrate(rest)
    else:
        raise ValueError(f"unknown command {command!r}; known: {', '.join(_COMMANDS)}")
    return 0


def _reproduce(arguments: list[str]) -> None:
    name, arguments = _take(arguments, "--policy", "avoid_jack")
    options = _parse(
        "reproduce",
        arguments,
        [
            ("policy", find_policy(name)),
            ("experiments", int, PAPER_EXPERIMENTS, "Experiments of each scenario."),
            ("vehicle", OnAxle),
        ],
        output=pathlib.Path("results/reproduce"),
    )
    rows = reproduce(
        options.policy,
        options.experiments,
        options.seed,
        options.output,
        options.threads,
        options.overwrite,
        options.vehicle,
    )
    _show(rows, f"{name} beside the paper")
    print(f"report, tables and figures: {options.output}/report.md")


def _evaluate(arguments: list[str]) -> None:
    names, arguments = _take_words(arguments)
    if not names and not {"-h", "--help"} & set(arguments):
        raise ValueError(f"name the policies to evaluate: {', '.join(POLICIES)}, module:Class")
    scenario_name, arguments = _take(arguments, "--scenario", "paper-single")
    scenario = find_scenario(scenario_name)
    classes = [find_policy(name) for name in names]
    drawn = not isinstance(scenario, Explicit)  # otherwise all episodes of a policy are the same
    fields: list[tuple] = [
        ("episodes", int, 1_000 if drawn else 1, "Episodes 0 .. of the seed."),
        ("task", Task),
        ("vehicle", OnAxle),
    ]
    if len(classes) == 1:
        fields.append(("policy", classes[0]))
    if drawn:
        # its options go without its name: --num-havs, --fleet.max-trailers
        fields.append(("scenario", Annotated[type(scenario), tyro.conf.arg(name="")], scenario))
    options = _parse("evaluate", arguments, fields, output=None)
    scenario = getattr(options, "scenario", scenario)
    policies = [options.policy] if len(classes) == 1 else [policy() for policy in classes]
    with contextlib.ExitStack() as stack:
        kept = options.output is not None
        output = options.output or pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory()))
        progress = stack.enter_context(Progress(options.episodes * len(policies)))
        paths = []
        for name, policy in zip(names, policies, strict=True):
            job = Experiments(
                policy, scenario, options.episodes, options.seed, options.task, options.vehicle
            )
            label = re.sub(r"\W+", "-", name)
            paths.append(
                run_experiments(
                    job, output, label, options.threads, options.overwrite, progress.advance
                )
            )
        rows = compare(list(names), [read_columns(path) for path in paths])
        write_text(markdown(rows), output / "table.md")
    _show(rows, f"{options.episodes} episodes of {scenario_name}, seed {options.seed}")
    if kept:
        print(f"tables: {', '.join(map(str, paths))}")


def _calibrate(arguments: list[str]) -> None:
    options = _parse(
        "calibrate",
        arguments,
        [("experiments", int, 1_000, "Experiments of each scenario and choice.")],
        output=pathlib.Path("results/calibrate"),
    )
    rows = calibrate(
        options.experiments, options.seed, options.output, options.threads, options.overwrite
    )
    _show(rows, f"{options.experiments} experiments of each scenario and choice")
    print(f"table: {options.output}/calibration.parquet")


def _take(arguments: list[str], option: str, default: str) -> tuple[str, list[str]]:
    """Take one option with its value out of the arguments."""
    kept, value = [], default
    remaining = iter(arguments)
    for argument in remaining:
        if argument == option:
            value = next(remaining, "")
        elif argument.startswith(f"{option}="):
            value = argument.partition("=")[2]
        else:
            kept.append(argument)
    return value, kept


def _take_words(arguments: list[str]) -> tuple[list[str], list[str]]:
    """Take the leading arguments that are no options."""
    count = next((k for k, word in enumerate(arguments) if word.startswith("-")), len(arguments))
    return arguments[:count], arguments[count:]


def _parse(
    command: str, arguments: list[str], fields: list[tuple], output: pathlib.Path | None
) -> Any:
    """Let tyro build the options of a command; what is wrong becomes one line.

    Fields are (name, type), (name, type, default) or (name, type, default, help).
    """
    own = []
    for name, kind, *rest in fields:
        described = Annotated[kind, tyro.conf.arg(help=rest[1])] if len(rest) == 2 else kind
        default = rest[0] if rest else kind()
        own.append((name, described, dataclasses.field(default=default)))
    options_class = dataclasses.make_dataclass("Options", own, bases=(_Run,))
    return parse_options(
        options_class,
        f"python -m baselines {command} {_NAMES[command]}".rstrip(),
        _COMMANDS[command],
        arguments,
        options_class(output=output),
    )


def _show(rows: list[list[str]], title: str) -> None:
    # without a terminal rich would cut every row into slices of 80 columns
    console = Console(width=None if sys.stdout.isatty() else 160)
    table = Table(title=title, title_justify="left")
    for k, head in enumerate(rows[0]):
        table.add_column(head, justify="left" if k == 0 else "right")
    for row in rows[1:]:
        table.add_row(*row)
    console.print(table)


if __name__ == "__main__":
    sys.exit(main())
