"""This module defines models for type checkers: policies, scenarios, vehicles, rewards.

A model is a NamedTuple of its parameters. A module registers its class with the generic kernel of
its kind. Type checkers do not see that; ``check_policy``, ``check_scenario`` and the like do.
"""

from typing import Any, Protocol


class Model(Protocol):
    """A NamedTuple of parameters."""

    @property
    def _fields(self) -> tuple[str, ...]: ...

    def _asdict(self) -> dict[str, Any]: ...


class Policy(Model, Protocol):
    """Parameters of what drives HAVs; registered with ``hav_env.act`` or ``hav_env.act_lanes``."""


class Vehicle(Model, Protocol):
    """Parameters of how a HAV moves; registered with ``hav_env.move``."""


class RewardTerms(Model, Protocol):
    """Weights of the terms of a reward; registered with ``hav_env.reward_terms``."""


class FleetLimits(Protocol):
    """The limits of all HAVs that a scenario can bring."""

    @property
    def min_length(self) -> float:
        """Least length of a unit [m]."""

    @property
    def max_length(self) -> float:
        """Largest length of a unit [m]."""

    @property
    def speed_max(self) -> float:
        """[m/s]."""

    @property
    def steering_max(self) -> float:
        """[rad]."""

    @property
    def articulation_max(self) -> float:
        """A HAV is jackknifed beyond it [rad]."""

    @property
    def footprint_truck_share(self) -> float:
        """Share of the truck's length in the footprint radius."""


class Scenario(Model, Protocol):
    """Parameters of who starts where; registered with ``hav_env.populate``."""

    @property
    def num_havs(self) -> int:
        """N."""

    @property
    def num_goals(self) -> int:
        """G, of each HAV."""

    @property
    def max_trailers(self) -> int:
        """The most that a HAV pulls; arrays have room for as many."""

    @property
    def articulation_max(self) -> float:
        """A HAV is jackknifed beyond it [rad]."""

    @property
    def fleet(self) -> FleetLimits:
        """The HAVs: how they are drawn, or what is written down."""
