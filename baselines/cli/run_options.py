"""This module declares the options of the commands that run and show episodes."""

import dataclasses
import pathlib
from collections.abc import Iterator
from typing import Annotated, Any, Literal

import tyro

from baselines.cli.options import take_option
from baselines.cli.tables import Format
from hav_env import Explicit, Task
from hav_env.evaluation.evaluate import USUAL_SCENARIO
from hav_env.models.annotations import is_model, values_of
from hav_env.policies.backup import NoBackup
from hav_env.policies.demands import guidance_of
from hav_env.policies.names import POLICIES
from hav_env.scenarios.presets import REGISTRY as SCENARIO_NAMES
from hav_env.scenarios.presets import scenario_of
from hav_env.simulator.guiding import GUIDANCES
from hav_env.vehicles import COMBINATIONS, VEHICLES

RESUMED = "the same command goes on where this one stopped"
_MOST_OWNERS = 3  # names of models that an error lists
Safety = Literal["jackknife", "collision", "both"] | None
Backup = Literal["reserve"] | None


@dataclasses.dataclass
class Run:
    """Options of a run: its folder, its seed and its threads."""

    output: pathlib.Path | None = None
    """Folder of the results; an interrupted run resumes in it."""
    seed: int = 0
    """Seed of all experiments, from 0 to 2**32 - 1."""
    threads: int | None = None
    """Number of threads; by default HAV_THREADS or all cores. Results do not depend on it."""
    overwrite: bool = False
    """Delete the results of an earlier run in the folder."""
    format: Format = "text"
    """Form of the printed tables: text, Markdown or comma-separated values."""


@dataclasses.dataclass
class Evaluate(Run):
    """Options of ``evaluate``."""

    output: pathlib.Path | None = None
    """Folder of the results; an interrupted run resumes in it. Without a folder, no results are
    kept. For films and pages (mp4, gif, html) see hav-env watch."""
    differences: bool = False
    """Print a second table: the differences of the policies from the first one."""
    safety: Safety = None
    """Filter all commands of the policy so that no HAV jackknifes, collides, or both."""
    backup: Backup = None
    """Policy that drives wherever a command would leave it no safe way on."""
    engine: str = "local"
    """Engine that runs the episodes: local, on this machine; ray, on a Ray cluster, with --threads
    (1) for each part of the episodes. Results do not depend on it."""
    address: str | None = None
    """Address of the Ray cluster, HOST:PORT or auto; by default Ray starts on this machine."""


@dataclasses.dataclass
class Display:
    """Options of showing an episode."""

    output: pathlib.Path | None = None
    """Output file: .mp4, .gif or .html. Without it and without --record, a window opens."""
    speed: float | None = None
    """Speed over real time; by default 10, or more to limit an mp4 to 60 s and a gif to 30 s."""
    fps: int | None = None
    """Frames per second of a film or the window; by default 30, of a gif 15."""
    begin: Annotated[float | None, tyro.conf.arg(name="from")] = None
    """First shown time of the episode [s]; by default its start."""
    end: Annotated[float | None, tyro.conf.arg(name="until")] = None
    """Last shown time of the episode [s]; by default its end."""


@dataclasses.dataclass
class Watch(Display):
    """Options of recording an episode."""

    safety: Safety = None
    """Filter all commands of the policy so that no HAV jackknifes, collides, or both."""
    backup: Backup = None
    """Policy that drives wherever a command would leave it no safe way on."""
    record: pathlib.Path | None = None
    """File for the recorded episode, .npz; ``watch FILE.npz`` shows it again."""
    seed: int = 0
    """Seed of the episode, from 0 to 2**32 - 1."""
    episode: int = 0
    """Number of the episode, as in the tables of ``evaluate``."""
    every: int = 1
    """Number of steps between recorded states; motion between them is interpolated."""


def take_scenario(arguments: list[str]) -> tuple[str, Any, list[str]]:
    """Return the scenario of a command line, with its site and fleet, and the other arguments.

    Returns:
        A name for tables and titles, the scenario, the other arguments.

    Raises:
        ValueError: If there is no such scenario, site or fleet, or they do not fit together.
    """
    name, arguments = take_option(arguments, "--scenario", USUAL_SCENARIO)
    site, arguments = take_option(arguments, "--site", "")
    fleet, arguments = take_option(arguments, "--fleet", "")
    title = name + (f" at {site}" if site else "") + (f" with {fleet}" if fleet else "")
    return title, scenario_of(name, site=site or None, fleet=fleet or None), arguments


def model_fields(policies: list[Any], scenario: Any, vehicle: Any, guidance: Any) -> list[tuple]:
    """Return the options for the rules of an episode, its models and a single policy."""
    fields: list[tuple] = [("task", Task), vehicle_field(vehicle), *policy_fields(policies)]
    if not isinstance(scenario, Explicit):
        # options of the scenario have no prefix: --num-havs, --fleet.max-trailers
        fields.append(("scenario", Annotated[type(scenario), tyro.conf.arg(name="")], scenario))
    if guidance is not None and guidance._fields:
        fields.append(("guidance", type(guidance), guidance))
    return fields


def known_names() -> dict[str, str]:
    """Return the names that commands take before their options, for the help."""
    return {
        "POLICY": f"{POLICIES.known()}. --help behind one policy lists its parameters. They may"
        " stand behind a name: reserve:patience=5,margin=1.",
        "--scenario NAME": f"{SCENARIO_NAMES.known()}.",
        "--site FILE": "A file with obstacles and bounds among which the scenario is to be.",
        "--fleet NAME[,NAME]": "Real vehicles in place of the scenario's, with --vehicle realistic:"
        f" {COMBINATIONS.known()}.",
        "--vehicle NAME": f"{VEHICLES.known()}.",
        "--guidance NAME": f"{GUIDANCES.known()}.",
        "hav-env list": "Shows what each name stands for.",
    }


def options_elsewhere() -> dict[str, str]:
    """Return the options that models of other names have, each with the first of these names."""
    owners = (
        ("--scenario", "--", SCENARIO_NAMES),
        ("--vehicle", "--vehicle.", VEHICLES),
        ("--guidance", "--guidance.", GUIDANCES),
        ("policy", "--policy.", POLICIES),
    )
    found: dict[str, str] = {}
    for owner, prefix, registry in owners:
        having: dict[str, list[str]] = {}
        for name in registry.names():
            if registry is POLICIES and not isinstance(registry.find(name), type):
                continue  # a trained policy has no options
            for option in _options_of(registry.make(name), prefix):
                having.setdefault(option, []).append(name)
        for option, names in having.items():
            found[option] = f"{owner} {' or '.join(names[:_MOST_OWNERS])}"
    return found


def _options_of(model: Any, prefix: str) -> Iterator[str]:
    """Yield the options of the parameters of a model and of its parts."""
    for field, value in values_of(model).items():
        option = prefix + field.replace("_", "-")
        yield option
        if is_model(value):
            yield from _options_of(value, f"{option}.")


def policy_fields(policies: list[Any]) -> list[tuple]:
    """Return the options for a single policy; a trained policy has none."""
    return [("policy", one) for one in policies if len(policies) == 1 and isinstance(one, type)]


def vehicle_field(vehicle: Any) -> tuple:
    """Return the options for the parameters of a vehicle."""
    return "vehicle", type(vehicle), vehicle


def take_vehicle(arguments: list[str]) -> tuple[Any, list[str]]:
    """Return the vehicle of a command line, and the other arguments.

    Raises:
        ValueError: If there is no such model of vehicles.
    """
    name, arguments = take_option(arguments, "--vehicle", "on_axle")
    return VEHICLES.make(name), arguments


def take_guidance(arguments: list[str]) -> tuple[Any, list[str]]:
    """Return the guidance of a command line, None without one, and the other arguments."""
    name, arguments = take_option(arguments, "--guidance", "")
    return GUIDANCES.make(name) if name else None, arguments


def guidance_for(policy: Any, named: Any) -> Any:
    """Return the named guidance, or by default the guidance that the policy needs."""
    return GUIDANCES.make(guidance_of(policy) or "dubins") if named is None else named


def backup_of(name: Backup, task: Task) -> Any:
    """Return the backup of a name for the rules of the episodes, or no backup."""
    if name is None:
        return NoBackup()
    rules = ("dt", "distance_tolerance", "heading_tolerance")
    return POLICIES.make(name)._replace(**{rule: getattr(task, rule) for rule in rules})


def check_folder(options: Run) -> None:
    """Check that a command that keeps its results has a folder; else raise ValueError."""
    if options.output is None:
        raise ValueError("output is None, but must be a folder")
