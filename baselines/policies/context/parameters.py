"""This module has the parameters of context steering, and their requirements on an episode."""

from typing import Annotated, Any, NamedTuple

from baselines.policies.context.memory import MOST_SLOTS
from hav_env.compiled import canonical
from hav_env.models.annotations import Range
from hav_env.models.checks import check_relations, require
from hav_env.models.protocols import Scenario, Vehicle
from hav_env.models.quantities import (
    AngleTolerance,
    Distance,
    Duration,
    Factor,
    Skipped,
    Steps,
    Tolerance,
    Widening,
)
from hav_env.policies.checks import check_parameters, check_rules
from hav_env.policies.filtered import MOST_FILTERED_TRAILERS
from hav_env.safety import SafetyFilter, check_safety
from hav_env.vehicles import OnAxle, actuators_of, is_instant
from hav_env.world.task import Task


class Context(NamedTuple):
    """Context steering: interest and danger over steering slots, with masks by the safety filter.

    A slot is a steering angle at full speed. The HAV drives the slot with the largest interest
    minus danger, among those that the safety filter leaves unchanged. It stands if there is none.
    The idea is that of PREVENT-JACK's abstract (arXiv 2604.21337); the formulas are this project's.
    """

    slots: Annotated[int, Range(3, MOST_SLOTS)] = 13
    """Number of slots, odd, so one is straight on."""
    evade: Factor = 0.5
    """Interest in driving away from the nearest chain ahead; it grows while the HAV is blocked."""
    side: Factor = 0.1
    """Interest in the right-hand side; it grows likewise."""
    recovery: Steps = 1500
    """Steps of blockage after which both interests have grown fully."""
    escape: Factor = 3.0
    """Danger of a slot after which no circle to either side is free of the chains of others."""
    avoid: Factor = 2.0
    """Additional danger, which decreases with the distance that the truck's front can move."""
    pause: Factor = 2.0
    """Excess of danger over interest at which a HAV stands, for at most ``recovery`` steps."""
    look: Distance = 15.0
    """Distance ahead in which a HAV considers others [m]."""
    keep: Distance = 0.8
    """Distance to the chains of others on circles and paths ahead [m]."""
    ahead: Distance = 6.0
    """Length of the path ahead of a moving HAV that counts as part of its chain [m]."""
    widening: Widening = 1.5
    """Radius of those circles, in drivable radii."""
    sharp: Widening = 100.0
    """Curvature of the outermost slots, in multiples of that of the drivable radius, within the
    wheels' limit.
    """
    close_factor: Factor = 3.5
    """Distance in truck lengths that counts as "close to goal"; see ``AvoidJack.close_factor``."""
    spread: Factor = 1.5
    """Distance between the approach points of courses [truck lengths]."""
    wider: Factor = 0.3
    """Share by which the Dubins radii of courses differ."""
    patience: Steps = 1500
    """Longest trial of a course [steps]."""
    every: Skipped = 10
    """Steps between trials of courses while none leads to the goal."""
    tries: Skipped = 3
    """Courses tried at a time."""
    ban: Skipped = 5
    """Steps for which a slot stays masked after the HAV could not have straightened."""
    safety: SafetyFilter = SafetyFilter()
    """Filter that masks slots, and that all commands pass."""
    vehicle: Any = OnAxle()
    """Kinematics of the HAVs."""
    dt: Duration = 0.2
    """Duration of a step [s], ``Task.dt``."""
    sensing_range: Distance = 30.0
    """Range in which the filter relies on sensing others [m], at most ``Task.sensing_range``."""
    distance_tolerance: Tolerance = 0.5
    """Tolerance of goals [m], ``Task.distance_tolerance``."""
    heading_tolerance: AngleTolerance = 0.1
    """Tolerance of goals [rad], ``Task.heading_tolerance``."""


@check_relations.register
def _(policy: Context) -> None:
    require(policy.slots % 2 == 1, "policy", policy, "slots", "odd")
    require(policy.look > 0.0, "policy", policy, "look", "above 0")


@check_parameters.register
def _(policy: Context, scenario: Scenario) -> None:
    if scenario.max_trailers > MOST_FILTERED_TRAILERS:
        raise ValueError(
            f"scenario max_trailers is {scenario.max_trailers}, but must be at most"
            f" {MOST_FILTERED_TRAILERS} under context steering"
        )


@check_rules.register
def _(policy: Context, scenario: Scenario, task: Task, vehicle: Vehicle) -> None:
    same = type(policy.vehicle) is type(vehicle)
    if not same or canonical(policy.vehicle) != canonical(vehicle):
        raise ValueError(
            f"policy vehicle is {policy.vehicle}, but must be the one of the episodes, {vehicle}"
        )
    if not is_instant(vehicle):
        raise ValueError(
            f"vehicle actuators is {actuators_of(vehicle)}, but must be Instant() under context"
            " steering, whose slots are steps at full speed"
        )
    for name in ("dt", "distance_tolerance", "heading_tolerance"):
        own, theirs = getattr(policy, name), getattr(task, name)
        require(own == theirs, "policy", policy, name, f"that of the task, {theirs:g}")
    allowed = policy.sensing_range <= task.sensing_range
    rule = f"at most that of the task, {task.sensing_range:g}"
    require(allowed, "policy", policy, "sensing_range", rule)
    check_safety(policy.safety, task, vehicle)
