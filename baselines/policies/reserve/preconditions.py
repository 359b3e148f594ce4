"""This module checks the assumptions of the theorems on Reserve.

The checks concern the vehicle, and the lengths, the speeds and the sensing of a scenario. They run
before a HAV drives.
"""

import math
from typing import Any

from hav_env import OnAxle
from hav_env.models.protocols import Scenario, Vehicle

LEAST_MARGIN = 0.01  # [m] the smallest share of it that a HAV keeps is far above rounding
MAX_CIRCLE_STEPS = 100_000  # of two turns of the widest circle; with more a decision takes seconds
CIRCLE_FACTOR = 1.02  # radius of the endless circle over the least one: space for discrete steps


def check_predicted(vehicle: Vehicle) -> None:
    """Check that the vehicle is the one whose steps Reserve predicts.

    Args:
        vehicle: The vehicle, whose joints are on the axles, whose bodies are lines and whose
            actuators are instant.

    Raises:
        ValueError: It is another vehicle, or has other parts. The message names both.
    """
    if not _same(vehicle, OnAxle()):
        shown = vehicle if isinstance(vehicle, OnAxle) else type(vehicle).__name__
        raise ValueError(f"vehicle is {shown}, but Reserve has its proof for OnAxle() alone")


def _same(one: Any, other: Any) -> bool:
    """Return whether two models are equal; tuples of two empty classes would compare equal."""
    if type(one) is not type(other):
        return False
    return all(map(_same, one, other)) if isinstance(one, tuple) else one == other


def check_step(scenario: Scenario, policy: Any) -> None:
    """Check that a step is neither too long for the simulator nor too short to predict.

    Args:
        scenario: Scenario, which has the lengths, limits and number of trailers.
        policy: Reserve policy for the scenario.

    Raises:
        ValueError: A step is too long or too short. The message names the bound.
    """
    fleet, trailers = scenario.fleet, scenario.max_trailers
    step = fleet.speed_max * policy.dt
    driven = f"speed_max {fleet.speed_max:g} m/s times dt {policy.dt:g} s is a step of {step:.6g} m"
    if not step <= 2.0 * fleet.min_length:
        raise ValueError(
            f"{driven}, but must be at most {2.0 * fleet.min_length:g} m, twice the shortest unit:"
            " beyond, the simulator's own steps overshoot, and trailers swing for good"
        )
    if not step <= policy.part:
        raise ValueError(f"{driven}, but must be at most policy part, {policy.part:g} m")
    tightest = fleet.max_length / math.tan(fleet.steering_max)
    bound = scenario.articulation_max - policy.articulation_margin
    bend = math.sin(min(bound, 0.5 * math.pi))
    straight = fleet.max_length * math.sqrt(trailers - 1 + 1.0 / bend**2)
    widest = CIRCLE_FACTOR * max(tightest, straight)
    least = 4.0 * math.pi * widest / MAX_CIRCLE_STEPS
    if not step >= least:
        raise ValueError(
            f"{driven}, but must be at least {least:.3g} m: Reserve predicts every step of two"
            f" turns of a circle of radius {widest:.4g} m, which steering_max"
            f" {fleet.steering_max:g} rad, {trailers} trailers and lengths up to"
            f" {fleet.max_length:g} m ask for, and at most {MAX_CIRCLE_STEPS:,} steps"
        )


def check_range(scenario: Scenario, dt: float, sensing_range: float) -> None:
    """Check that HAVs sense each other before they can touch.

    The circle that circumscribes a HAV moves with its truck's rear axle. Two HAVs therefore
    approach each other by no more than both drive.

    Args:
        scenario: The scenario, which has the maximum speed.
        dt: Duration of a step [s].
        sensing_range: Distance up to which HAVs sense each other [m].

    Raises:
        ValueError: The range is too short. The message names the bound.
    """
    least = 2.0 * scenario.fleet.speed_max * dt
    if scenario.num_havs > 1 and not sensing_range >= least:
        raise ValueError(
            f"task sensing_range is {sensing_range:g} m, but must be at least {least:g} m:"
            " two HAVs drive that in one step, and Reserve must notice others in time"
        )
