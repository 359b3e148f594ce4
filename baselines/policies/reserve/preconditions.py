"""The checks of what the theorems on Reserve assume.

They concern the lengths, the speeds and the sensing of a scenario, and run before a HAV drives.
"""

import math
from typing import Any, NamedTuple

import numpy as np

LEAST_MARGIN = 0.01  # [m] the smallest share of it that a HAV keeps is far above rounding
MAX_CIRCLE_STEPS = 100_000  # of two turns of the widest circle; with more a decision takes seconds
CIRCLE_FACTOR = 1.02  # radius of the endless circle over the least one: room for discrete steps


class Extremes(NamedTuple):
    """The extremes of the HAVs of a scenario."""

    shortest: float
    """Length of the shortest unit [m]."""
    longest: float
    """Length of the longest unit [m]."""
    trailers: int
    """Largest number of trailers."""
    speed_max: float
    """Maximum speed [m/s]."""
    steering_max: float
    """Maximum steering angle [rad]."""


def extremes_of(scenario: Any) -> Extremes:
    """Return the extremes of the HAVs that a scenario can bring.

    Raises:
        TypeError: The scenario does not have the attributes from which they follow.
    """
    fleet = getattr(scenario, "fleet", scenario)
    try:
        if hasattr(fleet, "length"):
            lengths = np.asarray(fleet.length, float)
            lengths = lengths[np.isfinite(lengths)]
            shortest, longest = float(lengths.min()), float(lengths.max())
        else:
            shortest, longest = fleet.min_length, fleet.max_length
        return Extremes(
            shortest, longest, scenario.max_trailers, fleet.speed_max, fleet.steering_max
        )
    except AttributeError as error:
        raise TypeError(
            f"{type(scenario).__name__} does not tell the lengths, speed_max and steering_max of"
            f" its HAVs, from which Reserve's guarantee follows: {error}"
        ) from None


def check_step(scenario: Any, policy: Any) -> None:
    """Check that a step is neither too long for the simulator nor too short to be predicted.

    Args:
        scenario: The scenario, which has the lengths, limits and number of trailers.
        policy: The Reserve that is to drive in it.

    Raises:
        ValueError: A step is too long or too short. The message names the bound.
        TypeError: As in ``extremes_of``.
    """
    found = extremes_of(scenario)
    step = found.speed_max * policy.dt
    driven = f"speed_max {found.speed_max:g} m/s times dt {policy.dt:g} s is a step of {step:.6g} m"
    if not step <= 2.0 * found.shortest:
        raise ValueError(
            f"{driven}, but must be at most {2.0 * found.shortest:g} m, twice the shortest unit:"
            " beyond, the simulator's own steps overshoot, and trailers swing for good"
        )
    if not step <= policy.part:
        raise ValueError(f"{driven}, but must be at most policy part, {policy.part:g} m")
    tightest = found.longest / math.tan(found.steering_max)
    bound = scenario.articulation_max - policy.articulation_margin
    bend = math.sin(min(bound, 0.5 * math.pi))
    trailers = found.longest * math.sqrt(found.trailers - 1 + 1.0 / bend**2)
    widest = CIRCLE_FACTOR * max(tightest, trailers)
    least = 4.0 * math.pi * widest / MAX_CIRCLE_STEPS
    if not step >= least:
        raise ValueError(
            f"{driven}, but must be at least {least:.3g} m: Reserve predicts every step of two"
            f" turns of a circle of radius {widest:.4g} m, which steering_max"
            f" {found.steering_max:g} rad, {found.trailers} trailers and lengths up to"
            f" {found.longest:g} m ask for, and at most {MAX_CIRCLE_STEPS:,} steps"
        )


def check_range(scenario: Any, dt: float, sensing_range: float) -> None:
    """Check that HAVs sense each other before they can touch.

    The circle that circumscribes a HAV moves with its truck's rear axle. So two HAVs come nearer to
    each other by no more than both drive.

    Args:
        scenario: The scenario, which has the maximum speed.
        dt: Duration of a step [s].
        sensing_range: Distance up to which HAVs sense each other [m].

    Raises:
        ValueError: The range is too short. The message names the bound.
        TypeError: As in ``extremes_of``.
    """
    least = 2.0 * extremes_of(scenario).speed_max * dt
    if scenario.num_havs > 1 and not sensing_range >= least:
        raise ValueError(
            f"task sensing_range is {sensing_range:g} m, but must be at least {least:g} m, what two"
            " HAVs drive in one step, for Reserve to notice others in time"
        )
