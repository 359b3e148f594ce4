"""This module declares the options of the commands that run and show episodes."""

import dataclasses
import pathlib
from typing import Annotated, Any

import tyro

from hav_env import Explicit, Task


@dataclasses.dataclass
class Run:
    """The options of a run: its folder, its seed and its threads."""

    output: pathlib.Path | None = None
    """Folder of the results, in which an interrupted run goes on where it stopped. Without one,
    ``evaluate`` keeps nothing."""
    seed: int = 0
    """Seed of all experiments, from 0 to 2**32 - 1."""
    threads: int | None = None
    """Number of threads; by default HAV_THREADS or all cores. Results do not depend on it."""
    overwrite: bool = False
    """Discard what an earlier run left in the folder."""


@dataclasses.dataclass
class Evaluate(Run):
    """Options of ``evaluate``."""

    engine: str = "local"
    """The engine that runs the episodes: local, on this machine; ray, on a Ray cluster, with
    --threads (1) for each part of them. Results do not depend on it."""
    address: str | None = None
    """Address of the Ray cluster, HOST:PORT or auto; by default one is started on this machine."""


@dataclasses.dataclass
class Display:
    """The options of showing an episode."""

    output: pathlib.Path | None = None
    """A file: .mp4, .gif or .html. Without one, and without --record, a window opens."""
    speed: float | None = None
    """Times real time; by default 10, or what makes a film last a minute."""
    fps: int = 30
    """Frames per second, of a film or the window."""


@dataclasses.dataclass
class Watch(Display):
    """The options of recording an episode."""

    record: pathlib.Path | None = None
    """A file, .npz, to keep the episode in; ``watch FILE.npz`` shows it again."""
    seed: int = 0
    """From 0 to 2**32 - 1."""
    episode: int = 0
    """Number of the episode, as in the tables of ``evaluate``."""
    every: int = 1
    """Keep the states after each so many steps; between them, motion is interpolated."""


def model_fields(policies: list[Any], scenario: Any, vehicle: Any) -> list[tuple]:
    """Return the options for the rules of an episode, its models and a single policy."""
    fields: list[tuple] = [("task", Task), vehicle_field(vehicle), *policy_fields(policies)]
    if not isinstance(scenario, Explicit):
        # its options go without its name: --num-havs, --fleet.max-trailers
        fields.append(("scenario", Annotated[type(scenario), tyro.conf.arg(name="")], scenario))
    return fields


def policy_fields(policies: list[Any]) -> list[tuple]:
    """Return the options for a single policy; one that was trained has none."""
    return [("policy", one) for one in policies if len(policies) == 1 and isinstance(one, type)]


def vehicle_field(vehicle: Any) -> tuple:
    """Return the options for the parameters of a vehicle."""
    return "vehicle", type(vehicle), vehicle
