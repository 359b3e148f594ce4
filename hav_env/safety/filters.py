"""This module declares the safety filter: its parameters, names and checks."""

from typing import Any, Literal, NamedTuple

from hav_env.models.annotations import show
from hav_env.models.checks import check_fields
from hav_env.models.quantities import Skipped, Steps
from hav_env.vehicles import Instant, Limited, OffAxle, OnAxle
from hav_env.world.task import Task

SAFETY = ("jackknife", "collision", "both")
"""Names of the filters that environments and commands accept."""

# compiled code sees the index of a word among the allowed ones
ONLY_JACKKNIFES, ONLY_COLLISIONS = 0, 1


class Unfiltered(NamedTuple):
    """No filter: every command is executed unchanged."""


class SafetyFilter(NamedTuple):
    """A predictive safety filter on the commands of all HAVs.

    The filter passes a command if a backup remains after it. Otherwise it scales down the steering,
    or stops the HAV for the step; a truck with limited rates brakes. docs/safety-filter.md has the
    theorems and proofs.
    """

    against: Literal["jackknife", "collision", "both"] = "both"
    """Events to prevent; collisions are those with other HAVs and with obstacles."""
    horizon: Steps = 1_000
    """Longest prediction of the backup that straightens the HAV, or brakes it [steps]."""
    turn: Skipped = 10
    """Period [steps] of the right of way between two HAVs that are too close for both to move."""


def make_safety(safety: Any) -> SafetyFilter | Unfiltered:
    """Return the filter that an argument ``safety`` stands for.

    Args:
        safety: None, one of ``SAFETY``, or a filter.

    Raises:
        TypeError: If it has another type.
        ValueError: If it is another word.
    """
    if safety is None:
        return Unfiltered()
    if isinstance(safety, str):
        if safety not in SAFETY:
            raise ValueError(f"safety is {show(safety)}, but must be {' or '.join(SAFETY)}")
        return SafetyFilter(safety)  # type: ignore[arg-type]
    if not isinstance(safety, SafetyFilter | Unfiltered):
        told = f"safety is {show(safety)}, but must be None, a SafetyFilter or one of "
        raise TypeError(told + ", ".join(SAFETY))
    check_fields("safety", safety)
    return safety


def check_safety(safety: Any, task: Task, vehicle: Any) -> None:
    """Check the assumptions of the filter's theorem.

    The filter itself checks assumptions on the lengths of a HAV in every step.

    Args:
        safety: Filter, already checked by itself.
        task: Rules, already checked.
        vehicle: Vehicle model, already checked.

    Raises:
        ValueError: If an argument is invalid; the message names it, its value and the rule.
    """
    if isinstance(safety, Unfiltered):
        return
    # a subclass may move in another way
    if type(vehicle) not in (OnAxle, OffAxle):
        raise ValueError(
            f"vehicle is {show(vehicle)}, but must be OnAxle or OffAxle where safety is on: the"
            " filter knows no bound for the motion of others"
        )
    if type(vehicle.actuators) not in (Instant, Limited):
        raise ValueError(
            f"vehicle actuators is {show(vehicle.actuators)}, but must be Instant or Limited where"
            " safety is on: the filter knows no way to stop a truck with others"
        )
    if safety.against != "jackknife" and task.order in ("in_turn", 1):
        raise ValueError("task order is 'in_turn', but must be 'at_once' where safety is on")
