"""This module drives the vehicles of the catalogue by policies made for hitches on axles.

``python -m baselines.experiments.real_vehicles`` prints goals and jackknifes of each vehicle alone,
as a table of docs/vehicles.md.
"""

import dataclasses
import sys
from collections.abc import Callable

import numpy as np

from baselines.cli.markup import markdown
from baselines.cli.progress import Progress
from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.dubins_pursuit import DubinsPursuit
from hav_env import OffAxle, RandomPoses, Task, catalogue, catalogue_fleet
from hav_env.cli.options import run_command
from hav_env.evaluation.rollout import rollout
from hav_env.evaluation.statistics import proportion
from hav_env.models.protocols import Policy
from hav_env.vehicles import COMBINATIONS
from hav_env.vehicles.steady_circles import least_radius

# what makes each policy, given the least limit of the joints [rad]; the paper's beta is 5/6 of its
_MADE: dict[str, Callable[[float], Policy]] = {
    "avoid_jack": lambda limit: AvoidJack(beta=limit * 5 / 6),
    "dubins_pursuit": lambda limit: DubinsPursuit(),
}
_TOLD = {"jackknifed": "jackknifed", "goal_1_hit": "goal 1", "goal_2_hit": "goal 2"}


@dataclasses.dataclass(frozen=True)
class Options:
    """Options of the drives: the episodes are those of the scenario ``paper-single``."""

    vehicles: tuple[str, ...] = tuple(COMBINATIONS.names())
    """Names in the catalogue."""
    episodes: int = 500
    """Number of episodes of each vehicle under each policy."""
    max_steps: int = 20_000
    """An episode ends after so many steps."""
    speed_max: float = 1.0
    """Largest speed [m/s]; 1 is the paper's."""
    seed: int = 2026
    """Seed of the episodes."""
    threads: int | None = None
    """Number of threads; by default HAV_THREADS or all cores."""


def drive(options: Options) -> str:
    """Return the table, in Markdown.

    Raises:
        ValueError: when there is no such vehicle.
    """
    columns = [f"{name}: {figure}" for name in _MADE for figure in _TOLD.values()]
    rows = [["vehicle", "trailers", "radius of the wheels [m]", "of the limits [m]", *columns]]
    with Progress(len(options.vehicles) * len(_MADE) * options.episodes) as progress:
        for name in options.vehicles:
            vehicle = catalogue(name)
            scenario = RandomPoses(fleet=catalogue_fleet(vehicle, speed_max=options.speed_max))
            wheels = vehicle.lengths[0] / np.tan(vehicle.steering_max)
            limited = least_radius(vehicle.lengths, vehicle.offsets, vehicle.limits)
            row = [name, str(len(vehicle.units) - 1), f"{wheels:.1f}", f"{limited:.1f}"]
            for make in _MADE.values():
                table = rollout(
                    make(scenario.articulation_max),
                    scenario,
                    options.seed,
                    np.arange(options.episodes),
                    Task(max_steps=options.max_steps),
                    OffAxle(),
                    options.threads,
                )
                for figure in _TOLD:
                    happened = table[figure].to_numpy(zero_copy_only=False)
                    row.append(proportion(happened, table["episode"].to_numpy()).show(percent=True))
                progress.advance(options.episodes, int(np.sum(table["moving_steps"].to_numpy())))
            rows.append(row)
    return markdown(rows)


def main(words: list[str] | None = None) -> int:
    """Print the table."""
    return run_command(
        "python -m baselines.experiments.real_vehicles",
        "Drives the vehicles of the catalogue by policies made for hitches on axles.",
        Options(),
        drive,
        words,
        "nothing was kept: the same command begins anew",
    )


if __name__ == "__main__":
    sys.exit(main())
