"""What the theorems on Reserve assume of lengths, speeds and sensing, checked before it drives."""

import math
from typing import Any, NamedTuple

import numpy as np

LEAST_MARGIN = 0.01  # [m] what is kept of it for a next part is far above rounding
MAX_CIRCLE_STEPS = 100_000  # of two turns of the widest circle: beyond, a decision takes seconds


class Extremes(NamedTuple):
    """The extremes of the HAVs of a scenario."""

    shortest: float  # unit [m]
    longest: float  # unit [m]
    trailers: int
    speed_max: float  # [m/s]
    steering_max: float  # [rad]


def extremes_of(scenario: Any) -> Extremes:
    """Return the extremes of the HAVs that a scenario can bring.

    Raises:
        TypeError: when it does not tell them.
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
        scenario: who drives; policy: a Reserve.

    Raises:
        ValueError: naming the bound.
        TypeError: as ``extremes_of``.
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
    widest = 1.02 * max(tightest, found.longest * math.sqrt(found.trailers - 1 + 1.0 / bend**2))
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

    What circumscribes a HAV goes along with its truck's rear axle: two come nearer to each other by
    no more than both drive.

    Raises:
        ValueError: naming the bound.
        TypeError: as ``extremes_of``.
    """
    least = 2.0 * extremes_of(scenario).speed_max * dt
    if scenario.num_havs > 1 and not sensing_range >= least:
        raise ValueError(
            f"task sensing_range is {sensing_range:g} m, but must be at least {least:g} m, what two"
            " HAVs drive in one step, for Reserve to notice others in time"
        )
