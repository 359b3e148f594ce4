"""This module tests the safety filter: ``python -m baselines.experiments.filter_trials``.

HAVs of every scenario with a name get random commands, or drive at one another at full speed, with
and without the filter. On the plane, collisions between steps count; real vehicles at real places
are compared with each other at steps. All take more than 17 minutes; ``--scenarios`` selects some.
"""

import dataclasses
import sys
from collections.abc import Callable

import numpy as np

from baselines.cli.bounds import check_whole
from baselines.cli.markup import markdown
from hav_env import OffAxle, OnAxle, Rectangles, Task, find_scenario
from hav_env.cli.options import run_command
from hav_env.mdp.decision_process import DecisionProcess
from hav_env.models.text import suggest
from hav_env.scenarios.presets import FIELDS, SCENARIOS, SITES
from hav_env.world.arrays import ACTUAL, HEADING, WHEN, X, Y

NAMED = (*SCENARIOS, *FIELDS, *SITES)
_REAL = OffAxle(bodies=Rectangles())
_HOLD = 30  # steps for which random commands last


@dataclasses.dataclass(frozen=True)
class TrialOptions:
    """Options of the trials."""

    scenarios: tuple[str, ...] = NAMED
    """Names of scenarios."""
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


def main(words: list[str] | None = None) -> int:
    """Run the trials, report an error in one line, and return the exit code."""
    usage = "python -m baselines.experiments.filter_trials"
    about = "Command HAVs at random and at one another, with the safety filter and without it."
    return run_command(usage, about, TrialOptions(), try_all, words, "nothing is stored")


def try_all(options: TrialOptions) -> str:
    """Run all trials; return their table in Markdown.

    Raises:
        ValueError: If an option is out of range.
    """
    check_whole("havs", options.havs, 1, 10**7)
    check_whole("steps", options.steps, 1, 10**7)
    for scenario in options.scenarios:
        if scenario not in NAMED:
            raise ValueError(f"there is no scenario {scenario!r}{suggest(scenario, NAMED)}")
    head = [
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
    rows = [head]
    for scenario in options.scenarios:
        for name in COMMANDERS:
            for safety in (None, "both"):
                rows.append(
                    [scenario, name, safety or "none", *_try(options, scenario, name, safety)]
                )
    return markdown(rows)


def _try(options: TrialOptions, scenario: str, name: str, safety: str | None) -> list[str]:
    """Run one trial; return its cells from the number of HAVs on."""
    at_place = scenario not in SCENARIOS
    task = Task(max_steps=options.steps, continuous_collisions=not at_place)
    num_havs = find_scenario(scenario).num_havs
    worlds = -(-options.havs // num_havs)
    process = DecisionProcess(
        worlds,
        scenario=scenario,
        task=task,
        vehicle=_REAL if at_place else OnAxle(),
        safety=safety,
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
    moves = worlds * num_havs * options.steps
    changed = f"{100.0 * info['interventions'].sum() / moves:.2f} %" if safety else ""
    counts = f"{worlds * num_havs:,}", f"{moves:,}"
    return [
        *counts,
        *(f"{int(found.sum()):,}" for found in (info["jackknifed"], collided)),
        f"{int(info['obstacle_collision'].sum()):,}" if at_place else "",
        changed,
    ]


if __name__ == "__main__":
    sys.exit(main())
