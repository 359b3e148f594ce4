"""This module is ``hav-env reproduce``: the paper's experiments beside its figures."""

import pathlib

from baselines.cli.options import read_options, take_option
from baselines.cli.run_options import RESUMED, Run, check_folder, policy_fields, vehicle_field
from baselines.cli.tables import print_table
from baselines.experiments.published import PAPER_EXPERIMENTS
from baselines.experiments.readings import READINGS, TEXT, find_reading
from baselines.experiments.reproduce import reproduce
from hav_env import RandomFleet, Task
from hav_env.cli.errors import report_errors
from hav_env.models.text import visible
from hav_env.policies.names import POLICIES
from hav_env.vehicles import VEHICLES

_USAGE = "hav-env reproduce [--reading NAME] [--policy NAME] [--vehicle NAME]"
_ABOUT = "Repeat the paper's experiments: its figures, a report and plots."


def main(words: list[str]) -> int:
    """Repeat the paper's 9,000 experiments: its figures, a report, plots."""
    return report_errors(_reproduce, words, RESUMED)


def _reproduce(arguments: list[str]) -> None:
    chosen, arguments = take_option(arguments, "--reading", TEXT.name)
    reading = find_reading(chosen)
    name, arguments = take_option(arguments, "--policy", "avoid_jack")
    vehicle, arguments = take_option(arguments, "--vehicle", "")
    made = POLICIES.make(name)
    policy = reading.policy if type(made) is type(reading.policy) else made
    shown = [("policy", type(policy), policy)] if policy_fields([POLICIES.find(name)]) else []
    options = read_options(
        _USAGE,
        _ABOUT,
        arguments,
        [
            ("experiments", int, PAPER_EXPERIMENTS, "Experiments of each scenario."),
            *shown,
            ("fleet", RandomFleet, reading.fleet),
            ("task", Task, reading.task),
            vehicle_field(VEHICLES.make(vehicle) if vehicle else reading.vehicle),
        ],
        Run(pathlib.Path(f"results/reproduce{'' if reading == TEXT else f'-{chosen}'}")),
        {
            "--reading NAME": f"{', '.join(READINGS)}: a reading of the paper, which leaves some"
            " choices open. docs/reproduction.md explains them.",
            "--policy NAME": f"{POLICIES.known()}.",
            "--vehicle NAME": f"{VEHICLES.known()}.",
        },
    )
    check_folder(options)
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
    print_table(rows, f"{name} beside the paper, reading {run.name}", options.format, keys=2)
    print(f"report, tables and figures: {visible(str(options.output))}/report.md")
