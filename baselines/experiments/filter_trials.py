"""This module tests the safety filter: ``python -m baselines.experiments.filter_trials``.

HAVs of every scenario with a name get random commands, or drive at one another at full speed, with
and without the filter. On the plane, collisions between steps count; real vehicles at real places
are compared with each other at steps. Each row is printed as soon as it is known.
"""

import dataclasses
import sys
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from baselines.cli.bounds import check_whole
from baselines.cli.markup import markdown_head, markdown_row
from hav_env import OffAxle, OnAxle, Rectangles, Task, find_scenario
from hav_env.cli.options import run_command
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.models.text import suggest
from hav_env.scenarios.presets import FIELDS, SCENARIOS, SITES
from hav_env.vehicles import ACTUATORS
from hav_env.world.arrays import ACTUAL, HEADING, WHEN, X, Y

NAMED = (*SCENARIOS, *FIELDS, *SITES)
_HOLD = 30  # steps for which random commands last


@dataclasses.dataclass(frozen=True)
class TrialOptions:
    """Options of the trials."""

    scenarios: tuple[str, ...] = NAMED
    """Names of scenarios."""
    actuators: str = "instant"
    """Name of the actuators of all trucks, instant or limited, or module:Class."""
    havs: int = 10_000
    """Least number of HAVs in each scenario."""
    steps: int = 1_000
    """Number of steps of each episode."""
    seed: int = 2026
    """Seed of the episodes and of the random commands."""
    threads: int | None = None
    """Number of threads; by default HAV_THREADS or all cores. Results do not depend on it."""


def at_random(process: DecisionProcess, rng: np.random.Generator) -> np.ndarray:
    """Return random actions (W, N, 2): fast, slow or standing, with random or full steering."""
    shape = process.num_worlds, process.num_havs
    speed = rng.choice([-1.0, -0.95, 0.0, 1.0, 1.0], shape)
    steering = np.clip(rng.uniform(-2.0, 2.0, shape), -1.0, 1.0)
    return np.stack([speed, steering], axis=-1)


def at_one_another(process: DecisionProcess, rng: np.random.Generator) -> np.ndarray:
    """Return actions (W, N, 2) at full speed towards the nearest truck; a lone HAV, to its goal."""
    state = process.batch.worlds.state
    here, heading = state.x + 1j * state.y, state.heading[:, 0]
    if process.num_havs == 1:
        aim = state.goal[:, X] + 1j * state.goal[:, Y] - here
        aim *= np.exp(1j * (heading - state.goal[:, HEADING]))  # the goal never comes to rest
    else:
        way = here[None] - here[:, None]
        diagonal = np.arange(process.num_havs)
        way[diagonal, diagonal] = np.inf
        nearest = np.abs(way).argmin(axis=1)
        aim = np.take_along_axis(way, nearest[:, None], axis=1)[:, 0]
    bearing = np.angle(aim * np.exp(-1j * heading))
    steering = np.clip(3.0 * bearing, -1.0, 1.0)
    return np.stack([np.ones(steering.shape), steering], axis=-1).swapaxes(0, 1)


COMMANDERS: dict[str, tuple[Callable[..., np.ndarray], int]] = {
    "at random": (at_random, _HOLD),
    "at one another": (at_one_another, 1),
}


class Trial(NamedTuple):
    """One scenario with one kind of commands, with the filter or without it."""

    scenario: str
    commands: str
    filtered: bool
    havs: int
    moves: int  # HAV-steps
    jackknifed: int  # HAVs
    collided: int  # HAVs
    hit: int | None  # HAVs that hit an obstacle; None on the plane
    changed: int | None  # HAV-steps in which the filter changed the command

    @property
    def harmed(self) -> int:
        """Number of events."""
        return self.jackknifed + self.collided + (self.hit or 0)


_HEAD = [
    "scenario",
    "commands",
    "filter",
    "HAVs",
    "HAV-steps",
    "jackknifed",
    "collided",
    "hit an obstacle",
    "changed",
]


def main(words: list[str] | None = None) -> int:
    """Run the trials, report an error in one line, and return the exit code."""
    usage = "python -m baselines.experiments.filter_trials"
    about = "Command HAVs at random and at one another, with the safety filter and without it."
    return run_command(usage, about, TrialOptions(), _print_all, words, "rows above stay valid")


def _print_all(options: TrialOptions) -> str:
    """Print the table in Markdown, each row when it is known; return its summary."""
    harmed = havs = 0
    for number, trial in enumerate(try_all(options)):
        if number == 0:
            print(markdown_head(_HEAD), flush=True)
        print(markdown_row(_cells(trial)), flush=True)
        harmed += trial.harmed if trial.filtered else 0
        havs += trial.havs if trial.filtered else 0
    return f"\n{harmed:,} events of {havs:,} HAVs with the filter"


def _cells(trial: Trial) -> list[str]:
    changed = "" if trial.changed is None else f"{100.0 * trial.changed / trial.moves:.2f} %"
    counts = trial.havs, trial.moves, trial.jackknifed, trial.collided, trial.hit
    return [
        *(trial.scenario, trial.commands, "both" if trial.filtered else "none"),
        *("" if count is None else f"{count:,}" for count in counts),
        changed,
    ]


def try_all(options: TrialOptions) -> Iterator[Trial]:
    """Run all trials; yield each when it ends.

    Raises:
        ValueError: If an option is out of range.
    """
    check_whole("havs", options.havs, 1, 10**7)
    check_whole("steps", options.steps, 1, 10**7)
    ACTUATORS.make(options.actuators)
    for scenario in options.scenarios:
        if scenario not in NAMED:
            raise ValueError(f"there is no scenario {scenario!r}{suggest(scenario, NAMED)}")
    for scenario in options.scenarios:
        for name in COMMANDERS:
            for filtered in (False, True):
                yield _try(options, scenario, name, filtered)


def _try(options: TrialOptions, scenario: str, name: str, filtered: bool) -> Trial:
    at_place = scenario not in SCENARIOS
    task = Task(max_steps=options.steps, continuous_collisions=not at_place)
    actuators = ACTUATORS.make(options.actuators)
    real = OffAxle(bodies=Rectangles(), actuators=actuators)
    num_havs = find_scenario(scenario).num_havs
    worlds = -(-options.havs // num_havs)
    process = DecisionProcess(
        worlds,
        scenario=scenario,
        task=task,
        vehicle=real if at_place else OnAxle(actuators=actuators),
        safety="both" if filtered else None,
        threads=options.threads,
    )
    outcome, everywhere = process.outcome(), np.ones(worlds, np.bool_)
    process.begin(np.full(worlds, options.seed), np.arange(worlds), everywhere, outcome)
    choose, held = COMMANDERS[name]
    rng = np.random.default_rng(options.seed)
    for step in range(options.steps):
        if step % held == 0:
            actions = np.ascontiguousarray(choose(process, rng))
        outcome = process.step(actions, outcome)
    info = dict(zip(process.info, outcome.info, strict=True))
    # no command causes contacts of HAVs at their start poses
    collided = process.batch.worlds.record.first[:, ACTUAL, WHEN] > 0
    havs = worlds * num_havs
    return Trial(
        *(scenario, name, filtered, havs, havs * options.steps),
        jackknifed=int(info["jackknifed"].sum()),
        collided=int(collided.sum()),
        hit=int(info["obstacle_collision"].sum()) if at_place else None,
        changed=int(info["interventions"].sum()) if filtered else None,
    )


if __name__ == "__main__":
    sys.exit(main())
