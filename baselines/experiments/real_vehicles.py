"""This module drives the vehicles of the catalogue by policies made for hitches on axles.

``python -m baselines.experiments.real_vehicles`` prints, for each vehicle alone, the shares of
episodes [%] with a jackknife, the first goal and the second goal, as a table of docs/vehicles.md.
"""

import dataclasses
import math
import sys
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from baselines.cli.markup import markdown
from baselines.cli.progress import Progress
from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.dubins_pursuit import DubinsPursuit
from hav_env import OffAxle, RandomPoses, Task, catalogue, catalogue_fleet
from hav_env.cli.options import run_command
from hav_env.evaluation.rollout import rollout
from hav_env.models.protocols import Policy
from hav_env.scenarios import CatalogueFleet
from hav_env.vehicles import COMBINATIONS
from hav_env.vehicles.steady_circles import least_radius

_TOLD = ("jackknifed", "goal_1_hit", "goal_2_hit")
_WHEELS = math.radians(40.0)  # steering limit of the paper's fleet in this project


class Drive(NamedTuple):
    """A column of the table: a policy, and a change of the vehicle."""

    policy: Callable[[float], Policy]
    """Function that makes the policy, given the least limit of the vehicle's joints [rad]."""
    changed: Callable[[CatalogueFleet], CatalogueFleet]
    """Function that changes the fleet."""


def _avoid_jack(limit: float) -> Policy:
    """Return AVOID-JACK with beta at 5/6 of a limit [rad], as in the paper with 90 degrees."""
    return AvoidJack(beta=limit * 5 / 6)


_DRIVES = {
    "AVOID-JACK": Drive(_avoid_jack, lambda fleet: fleet),
    "hitches on axles": Drive(
        _avoid_jack,
        lambda fleet: fleet._replace(offset=np.zeros_like(fleet.offset)),
    ),
    "wheels up to 40 degrees": Drive(
        _avoid_jack,
        lambda fleet: fleet._replace(
            steering=np.full_like(fleet.steering, _WHEELS), steering_max=_WHEELS
        ),
    ),
    "DubinsPursuit": Drive(lambda limit: DubinsPursuit(), lambda fleet: fleet),
}


@dataclasses.dataclass(frozen=True)
class Options:
    """Options of the drives: the episodes are those of the scenario ``paper-single``."""

    vehicles: tuple[str, ...] = tuple(COMBINATIONS.names())
    """Names in the catalogue."""
    episodes: int = 500
    """Number of episodes of each vehicle under each policy."""
    max_steps: int = 20_000
    """Number of steps after which an episode ends."""
    speed_max: float = 1.0
    """Largest speed [m/s]; 1 is the paper's."""
    seed: int = 2026
    """Seed of the episodes."""
    threads: int | None = None
    """Number of threads; by default HAV_THREADS or all cores."""


def tabulate_drives(options: Options) -> str:
    """Return the table, in Markdown.

    Raises:
        ValueError: If a vehicle does not exist.
    """
    head = ["vehicle", "trailers", "wheels [m]", "limits [m]", *_DRIVES]
    rows = [head]
    with Progress(len(options.vehicles) * len(_DRIVES) * options.episodes) as progress:
        for name in options.vehicles:
            vehicle = catalogue(name)
            fleet = catalogue_fleet(vehicle, speed_max=options.speed_max)
            wheels = vehicle.lengths[0] / math.tan(vehicle.steering_max)
            limited = least_radius(vehicle.lengths, vehicle.offsets, vehicle.limits)
            row = [name, str(len(vehicle.units) - 1), f"{wheels:.1f}", f"{limited:.1f}"]
            for drive in _DRIVES.values():
                table = rollout(
                    drive.policy(fleet.articulation_max),
                    RandomPoses(fleet=drive.changed(fleet)),
                    options.seed,
                    np.arange(options.episodes),
                    Task(max_steps=options.max_steps),
                    OffAxle(),
                    options.threads,
                )
                shares = (np.mean(table[figure].to_pylist()) for figure in _TOLD)
                row.append(" / ".join(f"{100 * share:.1f}" for share in shares))
                progress.advance(options.episodes, int(np.sum(table["moving_steps"].to_numpy())))
            rows.append(row)
    return markdown(rows)


def main(words: list[str] | None = None) -> int:
    """Print the table."""
    return run_command(
        "python -m baselines.experiments.real_vehicles",
        "Drives the vehicles of the catalogue by policies made for hitches on axles.",
        Options(),
        tabulate_drives,
        words,
        "nothing was stored: the same command begins anew",
    )


if __name__ == "__main__":
    sys.exit(main())
