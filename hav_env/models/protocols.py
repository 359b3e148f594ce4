"""This module defines models for type checkers: policies, scenarios, vehicles, rewards.

A model is a NamedTuple of its parameters. A module registers its class with the generic kernel of
its kind. Type checkers do not verify that; ``check_policy``, ``check_scenario`` and the like do.
"""

from typing import Any, Protocol


class Model(Protocol):
    """A NamedTuple of parameters."""

    @property
    def _fields(self) -> tuple[str, ...]: ...

    def _asdict(self) -> dict[str, Any]: ...


class Policy(Model, Protocol):
    """Parameters of a policy; registered with ``hav_env.act`` or ``hav_env.act_lanes``."""


class Vehicle(Model, Protocol):
    """Parameters of the motion of a HAV; registered with ``hav_env.move``."""


class RewardTerms(Model, Protocol):
    """Weights of the terms of a reward; registered with ``hav_env.reward_terms``."""


class FleetLimits(Protocol):
    """The limits of all HAVs of a scenario."""

    @property
    def min_length(self) -> float:
        """Least length of a unit [m]."""

    @property
    def max_length(self) -> float:
        """Largest length of a unit [m]."""

    @property
    def speed_max(self) -> float:
        """Largest speed [m/s]."""

    @property
    def steering_max(self) -> float:
        """Largest steering angle [rad]."""

    @property
    def articulation_max(self) -> float:
        """Articulation above which a HAV is jackknifed [rad]."""

    @property
    def footprint_truck_share(self) -> float:
        """Share of the truck's length in the footprint radius."""


class Scenario(Model, Protocol):
    """Parameters of start and goal poses; registered with ``hav_env.populate``."""

    @property
    def num_havs(self) -> int:
        """Number N of HAVs."""

    @property
    def num_goals(self) -> int:
        """Number G of goals of each HAV."""

    @property
    def max_trailers(self) -> int:
        """Largest number of trailers of a HAV; it sets the size of arrays."""

    @property
    def articulation_max(self) -> float:
        """Articulation above which a HAV is jackknifed [rad]."""

    @property
    def fleet(self) -> FleetLimits:
        """The HAVs: their distribution, or explicit ones."""
