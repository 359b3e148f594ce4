"""This package has the kinematics of trucks and trailers: one file for each model."""

from typing import Any

from hav_env.compiled import generic
from hav_env.models.checks import check_model
from hav_env.models.names import Registry
from hav_env.vehicles.actuators import (
    Instant,
    Limited,
    acting_block,
    actuate,
    actuators_in_field,
    actuators_of,
    check_actuators,
    is_instant,
)
from hav_env.vehicles.on_axle import OnAxle, move_on_axle
from hav_env.world.arrays import World


@generic
def move(vehicle: Any, dt: float, world: World, agent: int) -> None:
    """Move one HAV in every lane of a block of worlds, for ``dt`` [s].

    Reads the truck's speed ``state.speed[agent]`` [m/s] and ``state.steering[agent]`` [rad], which
    are within the HAV's limits: what its actuators made of its command. Writes the pose, and the
    headings with their cosines and sines. Units beyond a HAV's last have infinite length: they do
    not turn.
    """


def check_vehicle(vehicle: Any) -> None:
    """Check a vehicle model before it is used.

    Raises:
        ValueError: naming the field, its value and what is allowed.
        TypeError: when this is no vehicle, or a field has a value of another kind.
    """
    check_model("vehicle", vehicle, move)
    check_actuators(vehicle)


move.register(OnAxle)(move_on_axle)
actuators_of.register(OnAxle)(actuators_in_field)

VEHICLES = Registry(
    "vehicle",
    "hav_env.vehicles",
    move.table.__contains__,
    "register it with move.register",
    {"on_axle": OnAxle, "limited": OnAxle(actuators=Limited())},
)

ACTUATORS = Registry(
    "actuators",
    "hav_env.actuators",
    actuate.table.__contains__,
    "register it with actuate.register",
    {"instant": Instant, "limited": Limited},
)

__all__ = [
    "ACTUATORS",
    "VEHICLES",
    "Instant",
    "Limited",
    "OnAxle",
    "acting_block",
    "actuate",
    "actuators_of",
    "check_vehicle",
    "is_instant",
    "move",
]
